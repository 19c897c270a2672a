// /audit/* of results.h5: the columns of the audit as growing datasets, buffered so that a window
// costs a copy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "coordinator/audit/audit_row.hpp"
#include "proto/io/hdf5.hpp"

namespace fluxpact {

class AuditTable {
 public:
  /// Rows that are kept back at most; also the piece in which HDF5 stores a column.
  static constexpr std::size_t capacity = 256;

  /// Makes the datasets of all reproducible columns, those of the scalars and, if asked for, of the
  /// particle flow included.
  explicit AuditTable(Hdf5File& file, std::span<const ScalarName> scalars = {}, bool flow = false);

  /// Keeps a row. Allocates nothing. The table must not be full.
  void append(const AuditRow& row);
  bool full() const { return rows_ == capacity; }
  /// Hands the rows kept back to HDF5. Throws SystemError.
  void write_out();

 private:
  void make_columns(Hdf5File& file, std::span<const AuditColumn> columns);

  /// A column of the scalar `index`.
  struct OfScalar {
    std::size_t index = 0;
    double (*value)(const ScalarAudit&) = nullptr;
  };
  struct Column {
    Hdf5Column dataset;
    std::variant<RealColumn, WholeColumn, OfScalar> value;
    std::variant<std::vector<double>, std::vector<std::int64_t>> kept;
  };
  std::vector<Column> columns_;
  std::size_t rows_ = 0;
};

}  // namespace fluxpact
