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
     WholeColumn{[](Row row) { return row.particles.window.count; }}},
    {"particle_mass", "kg", "mass of these", true,
     RealColumn{[](Row row) { return row.particles.window.mass; }}},
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
    {"wall_cfd", "s",
     "time the fluid side took; in coupling.scheme parallel much of it is that of wall_dem, too",
     false, RealColumn{[](Row row) { return row.wall_cfd; }}},
    {"wall_dem", "s", "time the particle side took", false,
     RealColumn{[](Row row) { return row.wall_dem; }}},
    {"wall_exchange", "s", "time the exchange and the audit took", false,
     RealColumn{[](Row row) { return row.wall_exchange; }}},
    {"excess_moved", "m3",
     "solids volume that cells below interphase.voidage.smallest have passed to other cells, which "
     "hold it at the window's end",
     true, RealColumn{[](Row row) { return row.particles.window.excess_moved; }}},
});

constexpr auto all_flow_columns = std::to_array<AuditColumn>({
    {"particles_in", "1", "particles that came in at the window's end", true,
     WholeColumn{[](Row row) { return row.particles.window.entered; }}},
    {"particles_out", "1", "particles that left at the window's end", true,
     WholeColumn{[](Row row) { return row.particles.window.left; }}},
    {"particles_waiting", "1", "particles due so far that found no room to come in", true,
     WholeColumn{[](Row row) { return row.particles.window.waiting; }}},
    {"particle_mass_in", "kg", "mass of those that came in", true,
     RealColumn{[](Row row) { return row.particles.window.mass_entered; }}},
    {"particle_mass_out", "kg", "mass of those that left", true,
     RealColumn{[](Row row) { return row.particles.window.mass_left; }}},
    {"particle_mass_error", "1",
     "particle mass at the start plus all that came in less all that left less particle_mass, over "
     "the first two",
     true, RealColumn{[](Row row) { return row.particles.mass_error; }}},
    {"particle_momentum_in_x", "N s", "momentum that those brought in", true,
     RealColumn{[](Row row) { return row.particles.window.momentum_entered.x(); }}},
    {"particle_momentum_in_y", "N s", "the same along y", true,
     RealColumn{[](Row row) { return row.particles.window.momentum_entered.y(); }}},
    {"particle_momentum_in_z", "N s", "the same along z", true,
     RealColumn{[](Row row) { return row.particles.window.momentum_entered.z(); }}},
    {"particle_momentum_out_x", "N s", "momentum that those took out", true,
     RealColumn{[](Row row) { return row.particles.window.momentum_left.x(); }}},
    {"particle_momentum_out_y", "N s", "the same along y", true,
     RealColumn{[](Row row) { return row.particles.window.momentum_left.y(); }}},
    {"particle_momentum_out_z", "N s", "the same along z", true,
     RealColumn{[](Row row) { return row.particles.window.momentum_left.z(); }}},
});

constexpr auto all_scalar_columns = std::to_array<ScalarColumn>({
    {"amount", "kg", "J", "what the fluid holds at the window's end; of heat above 0 K",
     [](const ScalarAudit& scalar) { return scalar.amount; }},
    {"in", "kg/s", "W", "what enters through the boundary",
     [](const ScalarAudit& scalar) { return scalar.in; }},
    {"out", "kg/s", "W", "what leaves through the boundary",
     [](const ScalarAudit& scalar) { return scalar.out; }},
    {"source", "kg/s", "W", "what its sources add",
     [](const ScalarAudit& scalar) { return scalar.source; }},
    {"imbalance", "1", "1",
     "in - out + source less the rate of change of the amount, over the amount, per window",
     [](const ScalarAudit& scalar) { return scalar.imbalance; }},
    {"min", "1", "K", "smallest value in a cell",
     [](const ScalarAudit& scalar) { return scalar.lowest; }},
    {"max", "1", "K", "largest value in a cell",
     [](const ScalarAudit& scalar) { return scalar.highest; }},
});

}  // namespace

std::vector<ScalarName> scalar_names(const Scene& scene) {
  std::vector<ScalarName> names;
  for (const auto& [name, scalar] : scene.fluid.scalars) names.push_back({name, scalar.kind});
  return names;
}

std::span<const ScalarColumn> scalar_columns() { return all_scalar_columns; }

std::string column_name(const ScalarName& scalar, const ScalarColumn& column) {
  return fmt::format("scalar_{}_{}", scalar.name, column.name);
}

const char* column_unit(const ScalarName& scalar, const ScalarColumn& column) {
  return scalar.kind == ScalarKind::temperature ? column.heat_unit : column.unit;
}

std::span<const AuditColumn> audit_columns() { return all_columns; }

std::span<const AuditColumn> flow_columns() { return all_flow_columns; }

std::string audit_csv_header(std::span<const ScalarName> scalars, bool flow) {
  std::string line;
  for (const AuditColumn& column : all_columns) {
    if (!line.empty()) line += ',';
    line += column.name;
  }
  if (flow) {
    for (const AuditColumn& column : all_flow_columns) line += std::string(",") + column.name;
  }
  for (const ScalarName& scalar : scalars) {
    for (const ScalarColumn& column : all_scalar_columns) line += ',' + column_name(scalar, column);
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
  table +=
      "\nIf particles can come in (`particles.inflow`) or leave (`particles.outflow`), at the "
      "end:\n\n"
      "| column | unit | meaning |\n| --- | --- | --- |\n";
  for (const AuditColumn& column : all_flow_columns) {
    table += fmt::format("| `{}` | {} | {} |\n", column.name, column.unit, column.meaning);
  }
  table +=
      "\nEach scalar of the scene (`fluid.scalars`) adds at the end, with its name for NAME:\n\n"
      "| column | unit of a species | of a temperature | meaning |\n| --- | --- | --- | --- |\n";
  for (const ScalarColumn& column : all_scalar_columns) {
    table += fmt::format("| `scalar_NAME_{}` | {} | {} | {} |\n", column.name, column.unit,
                         column.heat_unit, column.meaning);
  }
  return table;
}

}  // namespace fluxpact
