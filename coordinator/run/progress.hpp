// A progress bar on a terminal, plain lines otherwise.
#pragma once

#include <chrono>
#include <cstdint>

#include "coordinator/audit/audit_row.hpp"

namespace fluxpact {

class ProgressBar {
 public:
  ProgressBar(std::int64_t windows, bool quiet);
  void show(std::int64_t step, const AuditRow& row);
  void finish();

 private:
  std::int64_t windows_;
  bool quiet_;
  bool terminal_;
  bool open_line_ = false;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace fluxpact
