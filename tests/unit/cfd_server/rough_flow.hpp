// A closed flow without a solver: random fluxes and voidages on a box, made to fit by the closure.
#pragma once

#include <random>

#include "cfd_server/discretisation/gradient.hpp"
#include "cfd_server/scalars/scalar_step.hpp"
#include "cfd_server/vans/flux_closure.hpp"
#include "tests/unit/cfd_server/fluid_case.hpp"

namespace fluxpact {

/// Inlet at z_min, pressure outlet at z_max; the voidage of each window is new in every cell.
struct RoughFlow {
  FluidCase fluid;
  Stencil stencil;
  ClosureTree tree;
  std::mt19937 random;
  std::vector<double> old_voidage, voidage, storage, face_flux;
  double window = 1e-3;

  explicit RoughFlow(unsigned seed, std::array<int, 3> cells = {5, 3, 6})
      : fluid(cells, {0.05, 0.03, 0.06}), random(seed) {
    fluid.side("inlet", Side::z_min, superficial_inlet({0, 0, 1}));
    fluid.side("outlet", Side::z_max, pressure_outlet());
    fluid.make_mesh();
    stencil = make_stencil(fluid.mesh);
    const BoundaryConditions conditions = read_boundaries(fluid.scene, fluid.mesh, stencil);
    tree = make_closure_tree(stencil, conditions, find_regions(stencil, conditions));
    old_voidage.assign(static_cast<std::size_t>(stencil.cells), 1.0);
    voidage = old_voidage;
    storage.assign(static_cast<std::size_t>(stencil.cells), 0.0);
    face_flux.assign(static_cast<std::size_t>(stencil.faces), 0.0);
    renew(0);
  }

  double uniform(double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  }

  /// The next window: fluxes of Courant numbers up to about `courant`, unless the closure needs
  /// more.
  void renew(double courant) {
    old_voidage = voidage;
    const double density = fluid.scene.fluid.density;
    const double scale = courant * density * stencil.volume[0] / window;
    for (int cell = 0; cell < stencil.cells; ++cell) {
      voidage[cell] = uniform(0.3, 1);
      storage[cell] = density * stencil.volume[cell] * (voidage[cell] - old_voidage[cell]) / window;
    }
    for (int f = 0; f < stencil.internal_faces; ++f) face_flux[f] = uniform(-scale, scale);
    for (const Patch& patch : fluid.mesh.patches) {
      for (int f = patch.first; f < patch.first + patch.size; ++f)
        face_flux[f] = patch.name == "inlet" ? -uniform(0, scale) : 0.0;
    }
    close_fluxes(tree, stencil, storage, face_flux);
  }

  FluidStep step() const {
    return {fluid.scene.fluid.density, window, old_voidage, voidage, face_flux, true};
  }

  /// Σ ρ ε V c [kg c] with the voidage of the step's start or end.
  double amount(const std::vector<double>& share, const std::vector<double>& value) const {
    CompensatedSum sum;
    for (int cell = 0; cell < stencil.cells; ++cell)
      sum.add(fluid.scene.fluid.density * share[cell] * stencil.volume[cell] * value[cell]);
    return sum.value();
  }
};

/// Every boundary face alike.
inline ScalarBoundary same_everywhere(const Stencil& stencil, ScalarFace kind, double value) {
  const auto faces = static_cast<std::size_t>(stencil.boundary_faces());
  return {std::vector<ScalarFace>(faces, kind), std::vector<double>(faces, value)};
}

/// A scalar with all that it needs, on a mesh.
struct ScalarCase {
  const Stencil& stencil;
  ScalarBoundary boundary;
  Convection convection;
  double tolerance;
  ScalarWork work;
  std::vector<Vector3> gradient;
  std::vector<double> conductance, source, sink, value, boundary_flux;

  ScalarCase(const Stencil& mesh, ScalarBoundary conditions, Convection scheme, double limit)
      : stencil(mesh),
        boundary(std::move(conditions)),
        convection(scheme),
        tolerance(limit),
        work(mesh),
        conductance(static_cast<std::size_t>(mesh.faces), 0.0),
        value(static_cast<std::size_t>(mesh.cells), 0.0),
        boundary_flux(static_cast<std::size_t>(mesh.boundary_faces()), 0.0) {
    std::vector<std::uint8_t> held;
    for (const ScalarFace kind : boundary.kind) held.push_back(kind == ScalarFace::value ? 1 : 0);
    gradient = gradient_coefficients(mesh, held);
  }

  void set_diffusion(double molecular, std::span<const double> voidage) {
    diffusive_conductance(stencil, boundary, voidage, molecular, {}, 1.0, conductance);
  }

  int advance(const FluidStep& step) {
    return advance_scalar(stencil, step, {boundary, conductance, source, sink}, gradient,
                          convection, tolerance, "tracer", work, value, boundary_flux);
  }

  double left() const {
    CompensatedSum sum;
    for (const double flux : boundary_flux) sum.add(flux);
    return sum.value();
  }
};

}  // namespace fluxpact
