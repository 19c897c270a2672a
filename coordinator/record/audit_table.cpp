#include "coordinator/record/audit_table.hpp"

#include <span>
#include <string>
#include <utility>

namespace fluxpact {

AuditTable::AuditTable(Hdf5File& file) {
  for (const AuditColumn& column : audit_columns()) {
    if (!column.reproducible) continue;
    const std::string name = std::string("/audit/") + column.name;
    if (std::holds_alternative<RealColumn>(column.value)) {
      columns_.push_back({file.make_real_column(name, column.unit, capacity), column.value,
                          std::vector<double>(capacity)});
    } else {
      columns_.push_back({file.make_whole_column(name, column.unit, capacity), column.value,
                          std::vector<std::int64_t>(capacity)});
    }
  }
}

void AuditTable::append(const AuditRow& row) {
  for (Column& column : columns_) {
    if (auto* reals = std::get_if<std::vector<double>>(&column.kept)) {
      (*reals)[rows_] = std::get<RealColumn>(column.value)(row);
    } else {
      std::get<std::vector<std::int64_t>>(column.kept)[rows_] =
          std::get<WholeColumn>(column.value)(row);
    }
  }
  ++rows_;
}

void AuditTable::write_out() {
  for (Column& column : columns_) {
    std::visit([&](const auto& kept) { column.dataset.append(std::span(kept).first(rows_)); },
               column.kept);
  }
  rows_ = 0;
}

}  // namespace fluxpact
