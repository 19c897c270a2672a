#include "coordinator/audit/gate.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

namespace fluxpact {

namespace {

struct Cure {
  std::string_view quantity;
  const char* text;
};

// What each quantity accuses, in words.
constexpr auto cures = std::to_array<Cure>({
    {"relative_imbalance",
     "the fluid's boundary fluxes do not balance the change of the voidage: the fluid side "
     "lost or made mass"},
    {"max_cell_residual", "the fluid's face fluxes do not close the continuity of this cell"},
    {"voidage_volume_error",
     "the voidage sent by the particle side does not hold the volume of its particles"},
    {"impulse_error",
     "the impulse that the fluid side says it took is not that of the drag it was sent"},
    {"handover_error",
     "the particle side was not given the impulse that the fluid side handed over"},
    {"particle_mass_error",
     "the mass of the particles is not that at the start plus what the particle side says came in "
     "less what it says left"},
    {"particle_count_error",
     "the number of particles is not that at the start plus those that the particle side says came "
     "in less those that left"},
    {"scalar_imbalance",
     "what the fluid side says of the boundary flows and sources of a scalar does not make the "
     "change of its amount"},
});

const char* cure_of(std::string_view quantity) {
  for (const Cure& cure : cures) {
    if (cure.quantity == quantity) return cure.text;
  }
  return "";
}

double worst_imbalance(const AuditRow& row) {
  double worst = 0;
  for (const ScalarAudit& scalar : row.scalars) {
    if (!(std::abs(scalar.imbalance) <= worst)) worst = std::abs(scalar.imbalance);
    if (std::isnan(worst)) break;
  }
  return worst;
}

std::optional<int> place(int cell) { return cell < 0 ? std::nullopt : std::optional(cell); }

}  // namespace

Verdict judge(const AuditRow& row, double limit) {
  const std::array<Verdict, 8> quantities{{
      {true, "voidage_volume_error", row.mass.voidage_volume_error, limit, {}},
      {true, "max_cell_residual", row.mass.max_cell_residual, limit,
       place(row.mass.max_cell_residual_cell)},
      {true, "relative_imbalance", std::abs(row.mass.relative_imbalance), limit, {}},
      {true, "impulse_error", row.momentum.impulse_error, limit,
       place(row.momentum.impulse_error_cell)},
      {true, "handover_error", row.momentum.handover_error, limit, {}},
      {true, "particle_mass_error", row.particles.mass_error, limit, {}},
      {true, "particle_count_error", row.particles.count_error, limit, {}},
      {true, "scalar_imbalance", worst_imbalance(row), limit, {}},
  }};
  Verdict worst = quantities.front();
  for (const Verdict& quantity : quantities) {
    if (!std::isnan(worst.value) && !(quantity.value <= worst.value)) worst = quantity;
  }
  worst.pass = worst.value <= limit;
  return worst;
}

std::string describe(const Verdict& verdict, const AuditRow& row) {
  const std::string where = verdict.cell ? fmt::format(" in cell {}", *verdict.cell) : "";
  return fmt::format(
      "window {} (to t = {} s): {} is {:.3g}{}, over the limit {:.3g}: {}. Look for the fault on "
      "that "
      "side first; if this size is acceptable, raise coupling.audit.limit",
      row.step, row.time, verdict.quantity, verdict.value, where, verdict.limit,
      cure_of(verdict.quantity));
}

}  // namespace fluxpact
