#include "cfd_server/scalars/fluid_scalars.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "cfd_server/discretisation/gradient.hpp"
#include "cfd_server/vans/profile.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

/// A formula for the faces of a patch, counted from the first boundary face.
struct PatchFormula {
  int first = 0;
  int last = 0;
  FormulaValue formula;
};

ScalarFace rule(const ScalarBoundarySettings& entry, BoundaryType type) {
  if (entry.flux) return ScalarFace::influx;
  if (!entry.value) return ScalarFace::zero_gradient;
  return type == BoundaryType::pressure ? ScalarFace::backflow : ScalarFace::value;
}

double finite(double value, const std::string& name, const char* what, const Vector3& at,
              double time) {
  if (std::isfinite(value)) return value;
  throw NumericsError(
      "fluid: the formula of fluid.scalars.{}.{} is {} at ({:.6g}, {:.6g}, {:.6g}), t = {} s; it "
      "must be finite",
      name, what, value, at.x(), at.y(), at.z(), time);
}

}  // namespace

struct FluidScalars::Scalar {
  Scalar(const std::string& its_name, const ScalarSettings& its_settings, const Scene& scene,
         const Mesh& mesh, const Stencil& stencil);

  void set_boundary(const Stencil& stencil, double time);

  std::string name;
  ScalarSettings settings;
  double factor = 1;     ///< amount over M c: 1, or the heat capacity
  double molecular = 0;  ///< [kg/(m s)]
  std::vector<PatchFormula> formulas;
  std::optional<FormulaValue> source;
  ScalarBoundary boundary;
  std::vector<Vector3> gradient;  ///< coefficients, one a side
  ScalarField committed, candidate;
};

FluidScalars::Scalar::Scalar(const std::string& its_name, const ScalarSettings& its_settings,
                             const Scene& scene, const Mesh& mesh, const Stencil& s)
    : name(its_name), settings(its_settings) {
  const bool heat = settings.kind == ScalarKind::temperature;
  factor = heat ? settings.heat_capacity : 1.0;
  molecular = heat ? settings.conductivity / settings.heat_capacity
                   : scene.fluid.density * settings.diffusivity;
  if (settings.source) source.emplace(*settings.source);
  const auto faces = static_cast<std::size_t>(s.boundary_faces());
  boundary.kind.assign(faces, ScalarFace::zero_gradient);
  boundary.value.assign(faces, 0.0);
  for (const auto& [patch_name, entry] : settings.boundaries) {
    const Patch* const patch = mesh.find_patch(patch_name);
    if (patch == nullptr) {
      throw ConfigError("fluid.scalars.{}.boundaries.{}: the mesh has no such patch", name,
                        patch_name);
    }
    const auto fluid = scene.fluid.boundaries.find(patch_name);
    const BoundaryType type =
        fluid == scene.fluid.boundaries.end() ? BoundaryType::wall : fluid->second.type;
    const ScalarFace kind = rule(entry, type);
    if (kind == ScalarFace::zero_gradient) continue;
    const int first = patch->first - s.internal_faces;
    for (int b = first; b < first + patch->size; ++b) boundary.kind[b] = kind;
    formulas.push_back({first, first + patch->size,
                        FormulaValue(kind == ScalarFace::influx ? *entry.flux : *entry.value)});
  }
  std::vector<std::uint8_t> held(faces, 0);
  std::ranges::transform(boundary.kind, held.begin(), [](ScalarFace kind) {
    return static_cast<std::uint8_t>(kind == ScalarFace::value ? 1 : 0);
  });
  gradient = gradient_coefficients(s, held);
  for (ScalarField* field : {&committed, &candidate}) {
    field->value.assign(static_cast<std::size_t>(s.cells), 0.0);
    field->boundary_flux.assign(faces, 0.0);
  }
}

void FluidScalars::Scalar::set_boundary(const Stencil& s, double time) {
  for (const PatchFormula& patch : formulas) {
    for (int b = patch.first; b < patch.last; ++b) {
      const int f = s.internal_faces + b;
      const Vector3 at = s.centre[s.owner[f]] + s.from_owner[f];
      const double value = finite(patch.formula(at, time), name, "boundaries", at, time);
      const bool given_per_area = boundary.kind[b] == ScalarFace::influx;
      boundary.value[b] = given_per_area ? value * s.area_size(f) / factor : value;
    }
  }
}

FluidScalars::FluidScalars(const Scene& scene, const Mesh& mesh, const Stencil& stencil)
    : stencil_(stencil), work_(stencil), schmidt_number_(scene.fluid.turbulence.schmidt_number) {
  for (const auto& [name, settings] : scene.fluid.scalars) {
    scalars_.emplace_back(name, settings, scene, mesh, stencil);
    if (scalars_.back().source) source_.assign(static_cast<std::size_t>(stencil.cells), 0.0);
  }
  conductance_.assign(static_cast<std::size_t>(stencil.faces), 0.0);
  boundary_flux_.assign(static_cast<std::size_t>(stencil.boundary_faces()), 0.0);
}

FluidScalars::~FluidScalars() = default;

void FluidScalars::start() {
  for (Scalar& scalar : scalars_) {
    const FormulaValue initial(scalar.settings.initial);
    for (int cell = 0; cell < stencil_.cells; ++cell) {
      const Vector3& at = stencil_.centre[cell];
      scalar.committed.value[cell] = finite(initial(at, 0), scalar.name, "initial", at, 0);
    }
    std::ranges::fill(scalar.committed.boundary_flux, 0.0);
    scalar.committed.source = 0;
  }
}

void FluidScalars::open_window() {
  for (Scalar& scalar : scalars_) {
    std::ranges::copy(scalar.committed.value, scalar.candidate.value.begin());
    std::ranges::fill(scalar.candidate.boundary_flux, 0.0);
    scalar.candidate.source = 0;
  }
}

void FluidScalars::advance(const FluidStep& step, double time,
                           std::span<const double> eddy_viscosity) {
  for (Scalar& scalar : scalars_) {
    scalar.set_boundary(stencil_, time);
    diffusive_conductance(stencil_, scalar.boundary, step.voidage, scalar.molecular, eddy_viscosity,
                          schmidt_number_, conductance_);
    ScalarInput input{scalar.boundary, conductance_, {}, {}};
    if (scalar.source) {
      for (int cell = 0; cell < stencil_.cells; ++cell) {
        const Vector3& at = stencil_.centre[cell];
        const double rate = finite((*scalar.source)(at, time), scalar.name, "source", at, time);
        const double amount = rate * step.voidage[cell] * stencil_.volume[cell];
        source_[cell] = amount / scalar.factor;
        scalar.candidate.source += amount * step.length;
      }
      input.source = source_;
    }
    advance_scalar(stencil_, step, input, scalar.gradient, scalar.settings.convection,
                   scalar.settings.tolerance, scalar.name.c_str(), work_, scalar.candidate.value,
                   boundary_flux_);
    for (std::size_t b = 0; b < boundary_flux_.size(); ++b)
      scalar.candidate.boundary_flux[b] += scalar.factor * step.length * boundary_flux_[b];
  }
}

void FluidScalars::close_window(double length) {
  for (Scalar& scalar : scalars_) {
    for (double& flux : scalar.candidate.boundary_flux) flux /= length;
    scalar.candidate.source /= length;
  }
}

void FluidScalars::commit() {
  for (Scalar& scalar : scalars_) std::swap(scalar.committed, scalar.candidate);
}

int FluidScalars::count() const { return static_cast<int>(scalars_.size()); }
const std::string& FluidScalars::name(int index) const { return scalars_[index].name; }
const ScalarField& FluidScalars::committed(int index) const { return scalars_[index].committed; }
const ScalarField& FluidScalars::candidate(int index) const { return scalars_[index].candidate; }

}  // namespace fluxpact
