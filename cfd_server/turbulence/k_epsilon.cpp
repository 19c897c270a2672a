#include "cfd_server/turbulence/k_epsilon.hpp"

#include <algorithm>
#include <cmath>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr double tolerance = 1e-9;  // largest relative change of a cell in the last sweep
constexpr int most_sweeps = 5000;

}  // namespace

KEpsilon::KEpsilon(const Scene& scene, const Mesh& mesh, const Stencil& s)
    : stencil_(s),
      layer_(viscous_layer(constants_)),
      start_energy_(scene.fluid.turbulence.kinetic_energy),
      start_dissipation_(scene.fluid.turbulence.dissipation),
      work_(s) {
  const auto cells = static_cast<std::size_t>(s.cells);
  const auto faces = static_cast<std::size_t>(s.boundary_faces());
  for (ScalarBoundary* boundary : {&energy_boundary_, &dissipation_boundary_})
    *boundary = {std::vector<ScalarFace>(faces, ScalarFace::zero_gradient),
                 std::vector<double>(faces, 0.0)};
  std::vector<int> wall_faces(cells, 0);
  for (const Patch& patch : mesh.patches) {
    const auto condition = scene.fluid.boundaries.find(patch.name);
    const BoundarySettings fluid =
        condition == scene.fluid.boundaries.end() ? BoundarySettings{} : condition->second;
    const auto inlet = scene.fluid.turbulence.inlets.find(patch.name);
    for (int f = patch.first; f < patch.first + patch.size; ++f) {
      const int b = f - s.internal_faces;
      if (inlet != scene.fluid.turbulence.inlets.end()) {
        inlets_.push_back({b, inlet->second.intensity, inlet->second.length_scale});
        energy_boundary_.kind[b] = ScalarFace::backflow;
        dissipation_boundary_.kind[b] = ScalarFace::backflow;
      } else if (fluid.type == BoundaryType::wall && fluid.slip == Slip::none) {
        const double distance = s.from_owner[f].dot(s.area[f]) / s.area_size(f);
        walls_.push_back({b, s.owner[f], distance, 1.0});
        ++wall_faces[s.owner[f]];
      }
    }
  }
  for (const auto& [name, inlet] : scene.fluid.turbulence.inlets) {
    if (mesh.find_patch(name) == nullptr)
      throw ConfigError("fluid.turbulence.inlets.{}: the mesh has no such patch", name);
  }
  for (WallFace& wall : walls_) wall.share = 1.0 / wall_faces[wall.cell];
  for (auto* values : {&production_, &at_wall_, &source_, &sink_}) values->assign(cells, 0.0);
  walled_.assign(cells, 0);
  for (const WallFace& wall : walls_) walled_[wall.cell] = 1;
  conductance_.assign(static_cast<std::size_t>(s.faces), 0.0);
}

TurbulentLevel KEpsilon::start() const {
  const auto cells = static_cast<std::size_t>(stencil_.cells);
  return {std::vector<double>(cells, start_energy_),
          std::vector<double>(cells, start_dissipation_)};
}

void KEpsilon::find_viscosity(const TurbulentLevel& level, double density,
                              std::span<double> eddy) const {
  for (std::size_t cell = 0; cell < eddy.size(); ++cell) {
    eddy[cell] = density * constants_.c_mu * level.energy[cell] * level.energy[cell] /
                 level.dissipation[cell];
  }
}

double KEpsilon::wall_viscosity(const TurbulentLevel& level, const WallFace& wall, double density,
                                double viscosity) const {
  return at_wall(constants_, layer_, density, viscosity, wall.distance, level.energy[wall.cell], 0)
      .viscosity;
}

/// k = 3/2 (I |u|)², ε = C_μ^(3/4) k^(3/2)/l.
void KEpsilon::set_inlets(std::span<const Vector3> velocity) {
  for (const Inlet& inlet : inlets_) {
    const double fluctuation = inlet.intensity * velocity[inlet.face].norm();
    const double energy = 1.5 * fluctuation * fluctuation;
    energy_boundary_.value[inlet.face] = energy;
    dissipation_boundary_.value[inlet.face] =
        std::pow(constants_.c_mu, 0.75) * std::pow(energy, 1.5) / inlet.length_scale;
  }
}

void KEpsilon::set_production(const TurbulentFlow& flow, std::span<const double> eddy,
                              const TurbulentLevel& level) {
  for (int cell = 0; cell < stencil_.cells; ++cell) {
    const bool walled = walled_[cell] != 0;
    production_[cell] = walled ? 0.0 : eddy[cell] * flow.strain[cell] * flow.strain[cell];
    at_wall_[cell] = 0;
  }
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    const WallFace& wall = walls_[i];
    const WallState state = at_wall(constants_, layer_, flow.density, flow.viscosity, wall.distance,
                                    level.energy[wall.cell], flow.wall_speed[i]);
    production_[wall.cell] += wall.share * state.production;
    at_wall_[wall.cell] += wall.share * state.dissipation;
  }
}

/// Gauss-Seidel, forth and back: every term is positive, so every sweep is.
void KEpsilon::solve(const FluidStep& step, const ScalarBoundary& boundary, const char* name,
                     std::span<double> value) {
  const Stencil& s = stencil_;
  ScalarWork& w = work_;
  assemble_transport(s, step, {boundary, conductance_, source_, sink_}, w);
  const double rate = step.density / step.length;
  for (int cell = 0; cell < s.cells; ++cell)
    w.residual[cell] = rate * s.volume[cell] * step.old_voidage[cell] * value[cell] + source_[cell];
  for (int b = 0; b < s.boundary_faces(); ++b)
    w.residual[s.owner[s.internal_faces + b]] +=
        w.into_owner[s.internal_faces + b] * boundary.value[b];
  const bool holds_wall = &boundary == &dissipation_boundary_;
  double change = 0;
  const auto relax = [&](int cell) {
    double sum = w.residual[cell];
    for (int side = s.side_offsets[cell]; side < s.side_offsets[cell + 1]; ++side) {
      const int other = s.side_other[side];
      if (other >= 0) sum += w.weight[side] * value[other];
    }
    const double next = holds_wall && walled_[cell] != 0 ? at_wall_[cell] : sum / w.diagonal[cell];
    change = std::max(change, std::abs(next - value[cell]) / next);
    value[cell] = next;
  };
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    change = 0;
    if (sweep % 2 == 0) {
      for (int cell = 0; cell < s.cells; ++cell) relax(cell);
    } else {
      for (int cell = s.cells; cell > 0; --cell) relax(cell - 1);
    }
    if (change <= tolerance) return;
    if (!std::isfinite(change)) break;
  }
  throw NumericsError(
      "fluid: the equation of {} still changes by {:.1e} of its value after {} sweeps; shorten "
      "coupling.window",
      name, change, most_sweeps);
}

void KEpsilon::advance(const FluidStep& step, const TurbulentFlow& flow,
                       std::span<const double> eddy, TurbulentLevel& level) {
  const Stencil& s = stencil_;
  const KEpsilonConstants& c = constants_;
  set_inlets(flow.inlet_velocity);
  set_production(flow, eddy, level);
  for (int cell = 0; cell < s.cells; ++cell) {
    const double fluid = step.voidage[cell] * s.volume[cell];
    const double frequency = level.dissipation[cell] / level.energy[cell];
    source_[cell] = fluid * c.c_1 * production_[cell] * frequency;
    sink_[cell] = fluid * c.c_2 * flow.density * frequency;
  }
  diffusive_conductance(s, dissipation_boundary_, step.voidage, flow.viscosity, eddy,
                        c.sigma_epsilon, conductance_);
  solve(step, dissipation_boundary_, "the dissipation of turbulence", level.dissipation);
  for (int cell = 0; cell < s.cells; ++cell) {
    const double fluid = step.voidage[cell] * s.volume[cell];
    source_[cell] = fluid * production_[cell];
    sink_[cell] = fluid * flow.density * level.dissipation[cell] / level.energy[cell];
  }
  diffusive_conductance(s, energy_boundary_, step.voidage, flow.viscosity, eddy, c.sigma_k,
                        conductance_);
  solve(step, energy_boundary_, "the energy of turbulence", level.energy);
}

}  // namespace fluxpact
