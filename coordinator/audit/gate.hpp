// The gate at the end of a window: may it be committed?
#pragma once

#include <optional>
#include <string>

#include "coordinator/audit/audit_row.hpp"

namespace fluxpact {

/// The quantity that is furthest over the limit, or that which comes closest to it.
struct Verdict {
  bool pass = true;
  const char* quantity = "";  ///< its name
  double value = 0;           ///< its size [-]
  double limit = 0;           ///< [-]
  std::optional<int> cell;    ///< where, for a quantity that has a place
};

/// Holds |relative_imbalance|, max_cell_residual, voidage_volume_error, both relative momentum
/// errors, the imbalance of each scalar, and the errors of the particles' mass and number against
/// `limit` (scene: coupling.audit.limit). A value that is not a number never passes.
Verdict judge(const AuditRow& row, double limit);

/// One sentence for the user: what was seen where, and what to do. For a verdict that did not pass.
std::string describe(const Verdict& verdict, const AuditRow& row);

}  // namespace fluxpact
