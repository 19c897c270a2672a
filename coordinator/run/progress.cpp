#include "coordinator/run/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace fluxpact {

ProgressBar::ProgressBar(std::int64_t windows, bool quiet)
    : windows_(windows),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) == 1),
      begin_(std::chrono::steady_clock::now()),
      last_(begin_) {}

void ProgressBar::show(std::int64_t step, const AuditRow& row) {
  using Seconds = std::chrono::duration<double>;
  if (quiet_) return;
  const auto now = std::chrono::steady_clock::now();
  const double interval = terminal_ ? 0.1 : 10.0;
  if (step < windows_ && Seconds(now - last_).count() < interval) return;
  last_ = now;
  const double share = static_cast<double>(step) / static_cast<double>(windows_);
  const double left = Seconds(now - begin_).count() * (1 - share) / share;
  if (terminal_) {
    constexpr int width = 30;
    const int full = static_cast<int>(share * width);
    fmt::print(stderr,
               "\r[{:#<{}}{:-<{}}] {:5.1f} %  t = {:.4f} s  imbalance {:+.1e}  {:.0f} s left  ", "",
               full, "", width - full, 100 * share, row.time, row.mass.relative_imbalance, left);
    open_line_ = true;
  } else {
    fmt::print(stderr, "{:5.1f} %  t = {:.4f} s  imbalance {:+.1e}  {:.0f} s left\n", 100 * share,
               row.time, row.mass.relative_imbalance, left);
  }
  std::fflush(stderr);
}

void ProgressBar::finish() {
  if (open_line_) fmt::print(stderr, "\n");
  open_line_ = false;
}

}  // namespace fluxpact
