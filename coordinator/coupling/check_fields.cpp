#include "coordinator/coupling/check_fields.hpp"

#include <cmath>

#include "proto/base/errors.hpp"
#include "proto/participant/asked_fields.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact {
namespace {

void require_finite(const Fields& fields, std::string_view sender, std::int64_t step) {
  for (const FieldView& view : fields.views()) {
    double sum = 0;  // one branch an array: a sum with a value that is not finite is not finite
    for (const double value : view.values) sum += value - value;
    if (sum == 0) continue;
    for (std::size_t i = 0; i < view.values.size(); ++i) {
      if (!std::isfinite(view.values[i])) {
        throw NumericsError("{}, step {}: '{}' is {} in row {}", sender, step, view.name,
                            view.values[i], i / static_cast<std::size_t>(view.components));
      }
    }
  }
  for (const auto& [name, value] : fields.numbers()) {
    if (!std::isfinite(value))
      throw NumericsError("{}, step {}: '{}' is {}", sender, step, name, value);
  }
}

void require_asked(const Fields& fields, const AskedFields& asked, const Mesh& mesh) {
  for (const std::string& name : asked.scalars) fields.scalars(name, mesh.cells());
  for (const std::string& name : asked.vectors) fields.vectors(name, mesh.cells());
}

}  // namespace

void check_offer_fields(const Message& result, const Scene& scene, const Mesh& mesh,
                        std::int64_t step) {
  const Fields fields = fields_of(result);
  fields.scalars(field::drag_coefficient, mesh.cells());
  fields.vectors(field::drag_source, mesh.cells());
  require_asked(fields, asked_of_particles(scene), mesh);
  fields.number(field::wall_seconds);
  require_finite(fields, "dem_server", step);
}

void check_particle_fields(const Message& result, const Scene& scene, const Mesh& mesh,
                           std::int64_t step) {
  const Fields fields = fields_of(result);
  const auto voidage = fields.scalars(field::voidage, mesh.cells());
  fields.vectors(field::impulse_given, mesh.cells());
  fields.vectors(field::particle_velocity, mesh.cells());
  for (const auto* name : {field::particle_volume, field::particle_count, field::particle_mass,
                           field::excess_moved, field::wall_seconds})
    fields.number(name);
  if (particles_flow(scene)) {
    fields.vectors(field::particle_momentum_entered, 1);
    fields.vectors(field::particle_momentum_left, 1);
    for (const auto* name :
         {field::particles_entered, field::particles_left, field::particles_waiting,
          field::particle_mass_entered, field::particle_mass_left})
      fields.number(name);
  }
  require_finite(fields, "dem_server", step);
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    if (!(voidage[cell] > 0 && voidage[cell] <= 1)) {
      const Vector3& centre = mesh.cell_centres[cell];
      throw NumericsError(
          "dem_server, step {}: voidage {} in cell {} at ({}, {}, {}); it must lie in (0, 1]", step,
          voidage[cell], cell, centre.x(), centre.y(), centre.z());
    }
  }
}

void check_fluid_fields(const Message& result, const Scene& scene, const Mesh& mesh,
                        std::int64_t step) {
  const Fields fields = fields_of(result);
  fields.scalars(field::face_flux, mesh.faces());
  fields.vectors(field::velocity, mesh.cells());
  fields.scalars(field::pressure, mesh.cells());
  fields.vectors(field::pressure_gradient, mesh.cells());
  require_asked(fields, asked_of_fluid(scene), mesh);
  if (step > 0) {
    fields.vectors(field::impulse_taken, mesh.cells());
    for (const auto* name :
         {field::solver_iterations, field::closure_correction, field::wall_seconds})
      fields.number(name);
  }
  for (const auto& [name, scalar] : scene.fluid.scalars) {
    fields.scalars(field::scalar(name), mesh.cells());
    fields.scalars(field::scalar_flux(name), mesh.faces() - mesh.internal_faces());
    fields.number(field::scalar_source(name));
  }
  require_finite(fields, "cfd_server", step);
}

}  // namespace fluxpact
