#include "coordinator/record/audit_table.hpp"

#include <span>
#include <string>
#include <utility>

namespace fluxpact {

void AuditTable::make_columns(Hdf5File& file, std::span<const AuditColumn> columns) {
  for (const AuditColumn& column : columns) {
    if (!column.reproducible) continue;
    const std::string name = std::string("/audit/") + column.name;
    if (std::holds_alternative<RealColumn>(column.value)) {
      columns_.push_back({file.make_real_column(name, column.unit, capacity),
                          std::get<RealColumn>(column.value), std::vector<double>(capacity)});
    } else {
      columns_.push_back({file.make_whole_column(name, column.unit, capacity),
                          std::get<WholeColumn>(column.value),
                          std::vector<std::int64_t>(capacity)});
    }
  }
}

AuditTable::AuditTable(Hdf5File& file, std::span<const ScalarName> scalars, bool flow) {
  make_columns(file, audit_columns());
  if (flow) make_columns(file, flow_columns());
  for (std::size_t index = 0; index < scalars.size(); ++index) {
    for (const ScalarColumn& column : scalar_columns()) {
      const std::string name = "/audit/" + column_name(scalars[index], column);
      const char* const unit = column_unit(scalars[index], column);
      columns_.push_back({file.make_real_column(name, unit, capacity),
                          OfScalar{index, column.value}, std::vector<double>(capacity)});
    }
  }
}

void AuditTable::append(const AuditRow& row) {
  for (Column& column : columns_) {
    if (auto* reals = std::get_if<std::vector<double>>(&column.kept)) {
      const auto* const of_scalar = std::get_if<OfScalar>(&column.value);
      (*reals)[rows_] = of_scalar != nullptr ? of_scalar->value(row.scalars.at(of_scalar->index))
                                             : std::get<RealColumn>(column.value)(row);
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
