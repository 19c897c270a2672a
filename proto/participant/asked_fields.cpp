#include "proto/participant/asked_fields.hpp"

#include "proto/participant/field_names.hpp"

namespace fluxpact {

AskedFields asked_of_fluid(const Scene& scene) {
  AskedFields asked;
  if (has_force(scene, InterphaseForce::viscous)) asked.vectors.emplace_back(field::viscous_force);
  if (has_force(scene, InterphaseForce::added_mass)) {
    asked.vectors.emplace_back(field::convective_acceleration);
  }
  if (has_force(scene, InterphaseForce::saffman_lift) ||
      has_force(scene, InterphaseForce::magnus_lift)) {
    asked.vectors.emplace_back(field::vorticity);
  }
  if (has_force(scene, InterphaseForce::turbulent_dispersion)) {
    asked.scalars.emplace_back(field::turbulent_energy);
    asked.scalars.emplace_back(field::turbulent_dissipation);
  }
  return asked;
}

AskedFields asked_of_particles(const Scene& scene) {
  AskedFields asked;
  if (scene.interphase.model == PressureModel::a &&
      has_force(scene, InterphaseForce::pressure_gradient) &&
      has_force(scene, InterphaseForce::added_mass)) {
    asked.scalars.emplace_back(field::pressure_return);
  }
  return asked;
}

std::vector<std::string> all_asked_of_fluid() {
  return {field::viscous_force, field::convective_acceleration, field::vorticity,
          field::turbulent_energy, field::turbulent_dissipation};
}

std::vector<std::string> all_asked_of_particles() { return {field::pressure_return}; }

}  // namespace fluxpact
