// What a run came to, in words that a person understands.
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "coordinator/coupling/run_step.hpp"

namespace fluxpact {

class Summary {
 public:
  void start(const Mesh& mesh, const Scene& scene, const CommittedState& state);

  /// One committed window; `record_seconds`: wall time of its record.
  void add(const AuditRow& row, const CommittedState& state, double record_seconds);
  void count_violation() { ++violations_; }

  /// What the particle side tells of the whole run.
  void add_figures(const std::map<std::string, double>& figures) { figures_ = figures; }

  /// The closing text. `wall_seconds`: of the whole run.
  std::string text(const Scene& scene, double wall_seconds) const;

 private:
  double pressure_drop(const CommittedState& state) const;

  const Mesh* mesh_ = nullptr;
  double window_ = 0;           ///< [s]
  double weight_per_area_ = 0;  ///< [Pa] of the particles, less buoyancy
  std::int64_t windows_ = 0;
  std::int64_t second_half_ = 0;  ///< first window of it
  std::int64_t violations_ = 0;
  CompensatedSum mass_in_, mass_out_,
      pressure_drop_;  ///< [kg], [kg], [Pa · windows of the second half]
  std::int64_t pressure_windows_ = 0;
  std::int64_t solver_iterations_ = 0;
  double largest_imbalance_ = 0, largest_residual_ = 0, largest_handover_ = 0,
         largest_correction_ = 0, largest_particle_error_ = 0;
  double largest_excess_ = 0;  ///< [m³]
  std::int64_t excess_windows_ = 0;
  double cfd_ = 0, dem_ = 0, both_ = 0, exchange_ = 0, record_ = 0;  ///< [s]
  struct ScalarExtent {
    double lowest = INFINITY, highest = -INFINITY, largest_imbalance = 0;
  };
  std::vector<ScalarExtent> scalars_;  ///< over the run
  std::map<std::string, double> figures_;
  double beyond_drag_ = 0;       ///< share of the particles, summed over windows
  double most_beyond_drag_ = 0;  ///< largest share in any window
  AuditRow last_;
};

}  // namespace fluxpact
