#include "coordinator/audit/audit_row.hpp"

#include <fmt/format.h>

#include <array>

namespace fluxpact {

namespace {

using Row = const AuditRow&;

constexpr auto all_columns = std::to_array<AuditColumn>({
    {"step", "1", "number of the window, from 1", true,
     WholeColumn{[](Row row) { return row.step; }}},
    {"time", "s", "end of the window", true, RealColumn{[](Row row) { return row.time; }}},
    {"mass_in", "kg/s", "fluid that enters through the boundary", true,
     RealColumn{[](Row row) { return row.mass.mass_in; }}},
    {"mass_out", "kg/s", "fluid that leaves through the boundary", true,
     RealColumn{[](Row row) { return row.mass.mass_out; }}},
    {"storage_rate", "kg/s", "rate of change of the fluid in the domain", true,
     RealColumn{[](Row row) { return row.mass.storage_rate; }}},
    {"net_imbalance", "kg/s", "mass_in - mass_out - storage_rate", true,
     RealColumn{[](Row row) { return row.mass.net_imbalance; }}},
    {"relative_imbalance", "1",
     "net_imbalance over mass_in or, if that is more, over 1e-5 of the fluid that the domain could "
     "hold, "
     "per window",
     true, RealColumn{[](Row row) { return row.mass.relative_imbalance; }}},
    {"max_cell_residual", "1",
     "largest error of the mass balance of a cell, over the fluid that the cell could hold, per "
     "window",
     true, RealColumn{[](Row row) { return row.mass.max_cell_residual; }}},
    {"cumulative_drift", "1",
     "fluid mass minus initial mass minus all that crossed the boundary, over the fluid mass", true,
     RealColumn{[](Row row) { return row.mass.cumulative_drift; }}},
    {"fluid_mass", "kg", "fluid in the domain at the window's end", true,
     RealColumn{[](Row row) { return row.mass.fluid_mass; }}},
    {"particle_count", "1", "particles in the domain", true,
     WholeColumn{[](Row row) { return row.particle_count; }}},
    {"particle_mass", "kg", "mass of these", true,
     RealColumn{[](Row row) { return row.particle_mass; }}},
    {"voidage_volume_error", "1",
     "solids volume in the cells minus that of the particles, over the latter or, if that is more, "
     "over 1e-5 "
     "of the domain",
     true, RealColumn{[](Row row) { return row.mass.voidage_volume_error; }}},
    {"epsilon_min", "1", "smallest voidage of a cell", true,
     RealColumn{[](Row row) { return row.mass.epsilon_min; }}},
    {"epsilon_max", "1", "largest voidage of a cell", true,
     RealColumn{[](Row row) { return row.mass.epsilon_max; }}},
    {"momentum_to_fluid_x", "N s", "impulse that the particles gave the fluid in the window", true,
     RealColumn{[](Row row) { return row.momentum.momentum_to_fluid.x(); }}},
    {"momentum_to_fluid_y", "N s", "the same along y", true,
     RealColumn{[](Row row) { return row.momentum.momentum_to_fluid.y(); }}},
    {"momentum_to_fluid_z", "N s", "the same along z", true,
     RealColumn{[](Row row) { return row.momentum.momentum_to_fluid.z(); }}},
    {"momentum_to_particles_x", "N s", "impulse that the fluid gave the particles in the window",
     true, RealColumn{[](Row row) { return row.momentum.momentum_to_particles.x(); }}},
    {"momentum_to_particles_y", "N s", "the same along y", true,
     RealColumn{[](Row row) { return row.momentum.momentum_to_particles.y(); }}},
    {"momentum_to_particles_z", "N s", "the same along z", true,
     RealColumn{[](Row row) { return row.momentum.momentum_to_particles.z(); }}},
    {"ledger_x", "N s", "impulse on its way from the fluid to the particles", true,
     RealColumn{[](Row row) { return row.momentum.ledger.x(); }}},
    {"ledger_y", "N s", "the same along y", true,
     RealColumn{[](Row row) { return row.momentum.ledger.y(); }}},
    {"ledger_z", "N s", "the same along z", true,
     RealColumn{[](Row row) { return row.momentum.ledger.z(); }}},
    {"solver_iterations", "1", "iterations of the pressure solver", true,
     WholeColumn{[](Row row) { return row.solver_iterations; }}},
    {"attempts", "1", "attempts that the window took", true,
     WholeColumn{[](Row row) { return row.attempts; }}},
    {"wall_cfd", "s", "time the fluid side took", false,
     RealColumn{[](Row row) { return row.wall_cfd; }}},
    {"wall_dem", "s", "time the particle side took", false,
     RealColumn{[](Row row) { return row.wall_dem; }}},
    {"wall_exchange", "s", "time the exchange and the audit took", false,
     RealColumn{[](Row row) { return row.wall_exchange; }}},
});

}  // namespace

std::span<const AuditColumn> audit_columns() { return all_columns; }

std::string audit_csv_header() {
  std::string line;
  for (const AuditColumn& column : all_columns) {
    if (!line.empty()) line += ',';
    line += column.name;
  }
  return line + '\n';
}

std::string audit_reference() {
  std::string table =
      "# The audit\n\nColumns of `audit.csv`, one row for each committed window, recomputed by the "
      "coordinator from what the\n"
      "participants sent. Made by `coordinator reference audit`.\n\n"
      "| column | unit | meaning |\n| --- | --- | --- |\n";
  for (const AuditColumn& column : all_columns) {
    table += fmt::format("| `{}` | {} | {} |\n", column.name, column.unit, column.meaning);
  }
  return table;
}

}  // namespace fluxpact
