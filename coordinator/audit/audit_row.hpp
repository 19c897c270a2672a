// One committed window in numbers, and the one table of its columns: from it derive the header and
// the rows of audit.csv, the datasets of results.h5, and the reference of both.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "coordinator/audit/mass_ledger.hpp"
#include "coordinator/audit/momentum_ledger.hpp"
#include "coordinator/audit/particle_ledger.hpp"
#include "coordinator/audit/scalar_ledger.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

struct AuditRow {
  std::int64_t step = 0;  ///< number of the window, from 1
  double time = 0;        ///< at its end [s]
  MassAudit mass;
  MomentumAudit momentum;
  ParticleAudit particles;
  std::int64_t solver_iterations = 0;  ///< of the pressure solver
  std::int64_t attempts = 1;           ///< that the window took
  double wall_cfd = 0;                 ///< [s] of this machine's time
  double wall_dem = 0;                 ///< [s]
  double wall_exchange = 0;            ///< [s]
  double wall_both = 0;                ///< [s] of wall_cfd and wall_dem that were at the same time
  std::vector<ScalarAudit> scalars;    ///< in the order of fluid.scalars
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

/// The columns of every run, in the order of audit.csv.
std::span<const AuditColumn> audit_columns();

/// The columns that follow these if particles can come in or leave (particles_flow).
std::span<const AuditColumn> flow_columns();

/// A scalar of the scene, as its columns are named.
struct ScalarName {
  std::string name;
  ScalarKind kind = ScalarKind::species;
};

/// Those of fluid.scalars, in order.
std::vector<ScalarName> scalar_names(const Scene& scene);

/// A column that each scalar of the scene adds: scalar_NAME_<name>.
struct ScalarColumn {
  const char* name;
  const char* unit;       ///< of a species
  const char* heat_unit;  ///< of a temperature
  const char* meaning;
  double (*value)(const ScalarAudit&);
};

std::span<const ScalarColumn> scalar_columns();

/// "scalar_NAME_amount", and its unit.
std::string column_name(const ScalarName& scalar, const ScalarColumn& column);
const char* column_unit(const ScalarName& scalar, const ScalarColumn& column);

/// "step,time,..." and a line end; then the columns of the particle flow, if asked for; those of
/// the scalars come last.
std::string audit_csv_header(std::span<const ScalarName> scalars = {}, bool flow = false);

/// docs/audit-reference.md: the columns as a Markdown table of name, unit, meaning.
std::string audit_reference();

}  // namespace fluxpact
