#include "coordinator/audit/mass_ledger.hpp"

#include <algorithm>
#include <cmath>

namespace fluxpact {

namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

// [kg/s] rate of storage plus what leaves through the faces: zero where mass is conserved.
double cell_residual(const Mesh& mesh, const MassWindow& window, int cell) {
  const std::size_t c = at(cell);
  CompensatedSum sum;
  sum.add(window.density * (window.voidage_after[c] - window.voidage_before[c]) *
          mesh.cell_volumes[c] / window.length);
  for (int k = mesh.cell_face_offsets[c]; k < mesh.cell_face_offsets[c + 1]; ++k) {
    const int face = mesh.cell_faces[at(k)];
    // Not else-if: across a period of one cell, a face has the same cell on both sides.
    if (mesh.owner[at(face)] == cell) sum.add(window.face_flux[at(face)]);
    if (face < mesh.internal_faces() && mesh.neighbour[at(face)] == cell) {
      sum.add(-window.face_flux[at(face)]);
    }
  }
  return sum.value();
}

// The largest so far; a NaN stays, where std::max would lose it.
bool exceeds(double value, double largest) { return !std::isnan(largest) && !(value <= largest); }

void audit_cells(const Mesh& mesh, const MassWindow& window, MassAudit& audit) {
  const double scale = window.density / window.length;
  audit.max_cell_residual = -1;
  audit.epsilon_min = window.voidage_after.front();
  audit.epsilon_max = window.voidage_after.front();
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    const double residual =
        std::abs(cell_residual(mesh, window, cell)) / (scale * mesh.cell_volumes[at(cell)]);
    if (exceeds(residual, audit.max_cell_residual)) {
      audit.max_cell_residual = residual;
      audit.max_cell_residual_cell = cell;
    }
    const double voidage = window.voidage_after[at(cell)];
    if (exceeds(voidage, audit.epsilon_max)) audit.epsilon_max = voidage;
    if (exceeds(-voidage, -audit.epsilon_min)) audit.epsilon_min = voidage;
  }
}

void audit_boundary(const Mesh& mesh, const MassWindow& window, MassAudit& audit) {
  CompensatedSum in;
  CompensatedSum out;
  for (int face = mesh.internal_faces(); face < mesh.faces(); ++face) {
    const double flux = window.face_flux[at(face)];
    if (flux < 0) {
      in.add(-flux);
    } else {
      out.add(flux);
    }
  }
  audit.mass_in = in.value();
  audit.mass_out = out.value();
}

std::span<const double> sent(const MassWindow& window) {
  return window.voidage_sent.empty() ? window.voidage_after : window.voidage_sent;
}

struct Volumes {
  double domain = 0;  ///< ΣV [m³]
  double solids = 0;  ///< Σ(1−ε)V [m³]
};

Volumes sum_volumes(const Mesh& mesh, const MassWindow& window, double& storage_rate) {
  CompensatedSum domain;
  CompensatedSum solids;
  CompensatedSum storage;
  for (std::size_t c = 0; c < mesh.cell_volumes.size(); ++c) {
    const double volume = mesh.cell_volumes[c];
    domain.add(volume);
    solids.add((1 - sent(window)[c]) * volume);
    storage.add(window.density * (window.voidage_after[c] - window.voidage_before[c]) * volume /
                window.length);
  }
  storage_rate = storage.value();
  return {domain.value(), solids.value()};
}

}  // namespace

double fluid_mass(const Mesh& mesh, double density, std::span<const double> voidage) {
  CompensatedSum mass;
  for (std::size_t c = 0; c < mesh.cell_volumes.size(); ++c) {
    mass.add(density * voidage[c] * mesh.cell_volumes[c]);
  }
  return mass.value();
}

MassTotal start_mass(const Mesh& mesh, double density, std::span<const double> voidage) {
  return {fluid_mass(mesh, density, voidage), {}};
}

MassAudit audit_mass(const Mesh& mesh, const MassWindow& window, const MassTotal& committed) {
  MassAudit audit;
  audit_cells(mesh, window, audit);
  audit_boundary(mesh, window, audit);
  const Volumes volumes = sum_volumes(mesh, window, audit.storage_rate);

  audit.net_imbalance = audit.mass_in - audit.mass_out - audit.storage_rate;
  const double floor = audit_floor * window.density * volumes.domain / window.length;
  audit.relative_imbalance = audit.net_imbalance / std::max(audit.mass_in, floor);
  audit.voidage_volume_error = std::abs(volumes.solids - window.particle_volume) /
                               std::max(window.particle_volume, audit_floor * volumes.domain);

  audit.fluid_mass = fluid_mass(mesh, window.density, window.voidage_after);
  audit.displaced = audit.fluid_mass - fluid_mass(mesh, window.density, sent(window));
  audit.total = committed;
  audit.total.gained.add((audit.mass_in - audit.mass_out) * window.length);
  audit.cumulative_drift =
      (audit.fluid_mass - audit.total.initial_fluid_mass - audit.total.gained.value()) /
      audit.fluid_mass;
  return audit;
}

}  // namespace fluxpact
