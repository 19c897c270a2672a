// One committed window in numbers, and the one table of its columns: from it derive the header and
// the rows of audit.csv, the datasets of results.h5, and the reference of both.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>

#include "coordinator/audit/mass_ledger.hpp"
#include "coordinator/audit/momentum_ledger.hpp"

namespace fluxpact {

struct AuditRow {
  std::int64_t step = 0;  ///< number of the window, from 1
  double time = 0;        ///< at its end [s]
  MassAudit mass;
  MomentumAudit momentum;
  std::int64_t particle_count = 0;
  double particle_mass = 0;            ///< [kg]
  std::int64_t solver_iterations = 0;  ///< of the pressure solver
  std::int64_t attempts = 1;           ///< that the window took
  double wall_cfd = 0;                 ///< [s] of this machine's time
  double wall_dem = 0;                 ///< [s]
  double wall_exchange = 0;            ///< [s]
};

using RealColumn = double (*)(const AuditRow&);
using WholeColumn = std::int64_t (*)(const AuditRow&);

struct AuditColumn {
  const char* name;
  const char* unit;  ///< "1" for a pure number
  const char* meaning;
  /// False for wall times, which differ between two runs of the same scene: they stand in audit.csv
  /// only, so that results.h5 is the same to the byte.
  bool reproducible;
  std::variant<RealColumn, WholeColumn> value;
};

/// All columns in the order of audit.csv.
std::span<const AuditColumn> audit_columns();

/// "step,time,..." and a line end.
std::string audit_csv_header();

/// docs/audit-reference.md: the columns as a Markdown table of name, unit, meaning.
std::string audit_reference();

}  // namespace fluxpact
