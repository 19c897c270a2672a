// A fluid scene on a box, and the solids that drive it: what the tests of the fluid solver start
// from.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "cfd_server/vans/solver.hpp"
#include "proto/base/compensated_sum.hpp"
#include "proto/mesh/box.hpp"

namespace fluxpact {

/// Sides as patches x_min ... z_max, each with a condition; tests then change what they need.
struct FluidCase {
  Scene scene;
  Mesh mesh;

  explicit FluidCase(std::array<int, 3> cells, const Vector3& size) {
    scene.fluid.density = 1.2;
    scene.fluid.viscosity = 1.8e-5;
    scene.scene.gravity = Vector3::Zero();
    scene.fluid.mesh.box = {Vector3::Zero(), size, cells};
    scene.fluid.numerics.pressure_tolerance = 1e-12;
  }

  void make_mesh() { mesh = make_box(scene.fluid.mesh); }

  void side(const std::string& name, Side where, const BoundarySettings& condition) {
    scene.fluid.mesh.patches.push_back({name, {where, {}}});
    scene.fluid.boundaries[name] = condition;
  }
};

inline BoundarySettings superficial_inlet(const Vector3& velocity) {
  BoundarySettings settings;
  settings.type = BoundaryType::velocity;
  settings.superficial = velocity;
  return settings;
}

inline BoundarySettings pressure_outlet(double value = 0) {
  BoundarySettings settings;
  settings.type = BoundaryType::pressure;
  settings.value = value;
  return settings;
}

inline BoundarySettings wall(Slip slip) {
  BoundarySettings settings;
  settings.type = BoundaryType::wall;
  settings.slip = slip;
  return settings;
}

/// A box along x: superficial inlet at x_min, pressure outlet at x_max, free-slip sides.
inline FluidCase column(int cells, double length, double superficial) {
  FluidCase column({cells, 1, 1}, {length, 0.01, 0.01});
  column.side("inlet", Side::x_min, superficial_inlet({superficial, 0, 0}));
  column.side("outlet", Side::x_max, pressure_outlet());
  column.scene.fluid.boundaries["walls"] = wall(Slip::free);
  column.scene.fluid.initial.superficial = Vector3(superficial, 0, 0);
  column.make_mesh();
  return column;
}

/// The solids of a window, owned.
struct Solids {
  std::vector<double> voidage;
  std::vector<double> drag;
  std::vector<Vector3> source;

  explicit Solids(const Mesh& mesh, double value = 1.0)
      : voidage(mesh.cell_volumes.size(), value),
        drag(mesh.cell_volumes.size(), 0.0),
        source(mesh.cell_volumes.size(), Vector3::Zero()) {}
  SolidsInput view() const { return {voidage, drag, source}; }
};

inline void run_window(VansSolver& solver, const Solids& solids, int step, double length) {
  solver.advance({step, (step - 1) * length, length}, solids.view(), {});
  solver.commit();
}

/// Largest |ρ V Δε/Δt + Σ Φ| over ρ V/Δt, and inflow − outflow − storage over the inflow, as an
/// audit would see them.
struct Balance {
  double largest_residual = 0;
  double relative_imbalance = 0;
  double inflow = 0;
  double outflow = 0;
};

inline Balance balance_of(const Mesh& mesh, double density, const std::vector<double>& old_voidage,
                          const FluidState& state, double window) {
  std::vector<CompensatedSum> residual(mesh.cell_volumes.size());
  CompensatedSum storage;
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    const double stored =
        density * mesh.cell_volumes[cell] * (state.voidage[cell] - old_voidage[cell]) / window;
    residual[cell].add(stored);
    storage.add(stored);
  }
  CompensatedSum in;
  CompensatedSum out;
  for (int f = 0; f < mesh.faces(); ++f) {
    const double flux = window_flux(state)[f];
    residual[mesh.owner[f]].add(flux);
    if (f < mesh.internal_faces()) {
      residual[mesh.neighbour[f]].add(-flux);
    } else {
      (flux < 0 ? in : out).add(std::abs(flux));
    }
  }
  Balance balance{0, 0, in.value(), out.value()};
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    balance.largest_residual =
        std::max(balance.largest_residual,
                 std::abs(residual[cell].value()) / (density * mesh.cell_volumes[cell] / window));
  }
  if (balance.inflow > 0) {
    balance.relative_imbalance =
        (balance.inflow - balance.outflow - storage.value()) / balance.inflow;
  }
  return balance;
}

}  // namespace fluxpact
