#include "dem_server/participant/precision_error.hpp"

#include <algorithm>
#include <cmath>

#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/engine_state.hpp"
#include "dem_server/backends/native/native_engine.hpp"
#include "dem_server/backends/size_levels.hpp"
#include "proto/base/compensated_sum.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact {
namespace {

/// Root mean square and maximum of what is added.
class Spread {
 public:
  void add(double value) {
    squares_.add(value * value);
    largest_ = std::max(largest_, std::abs(value));
    ++count_;
  }
  double rms() const {
    return count_ > 0 ? std::sqrt(squares_.value() / static_cast<double>(count_)) : 0;
  }
  double largest() const { return largest_; }

 private:
  CompensatedSum squares_;
  double largest_ = 0;
  std::int64_t count_ = 0;
};

double over(double value, double scale) { return value > 0 ? value / scale : 0; }

/// From a to b, to the nearest image.
Vector3 apart(const Domain& domain, const Vector3& a, const Vector3& b) {
  Vector3 way = b - a;
  for (int axis = 0; axis < 3; ++axis) {
    if (!domain.periodic(axis)) continue;
    way[axis] -= domain.length(axis) * std::round(way[axis] / domain.length(axis));
  }
  return way;
}

/// Differences of the overlaps of spheres that touch in the exact state.
void compare_overlaps(const Domain& domain, const ParticleState& exact,
                      std::span<const Vector3> difference, PrecisionError& error) {
  const int count = exact.size();
  if (count == 0) return;
  SizeLevels levels;
  levels.sort(domain, 0, {exact.position.front().data(), 3, count}, {exact.radius.data(), 1});
  const std::array<Vector3, 27> shifts = shift_vectors(domain);
  Spread spread;
  CompensatedSum overlaps;
  std::int64_t touching = 0;
  for (int row = 0; row < count; ++row) {
    const Vector3& x = exact.position[row];
    levels.visit_near(x.data(), exact.radius[row], [&](int first, int last, int shift, double) {
      for (int place = first; place < last; ++place) {
        const int other = levels.order()[place];
        if (other == row) continue;
        const Vector3 way = x - exact.position[other] - shifts[shift];
        const double overlap = exact.radius[row] + exact.radius[other] - way.norm();
        if (overlap <= 0) continue;
        spread.add(way.norm() - (way + difference[row] - difference[other]).norm());
        overlaps.add(overlap);
        ++touching;
      }
    });
  }
  if (touching == 0) return;
  const double mean = overlaps.value() / static_cast<double>(touching);
  error.overlap_rms = over(spread.rms(), mean);
  error.overlap_max = over(spread.largest(), mean);
}

}  // namespace

PrecisionError precision_error(const Scene& scene, const Mesh& mesh, double window,
                               const ParticleState& before, const ParticleState& exact,
                               const ParticleState& mixed) {
  const Domain domain = particle_domain(scene, mesh);
  std::vector<Vector3> difference(exact.id.size());
  Spread gain, velocity, position;
  for (int row = 0; row < exact.size(); ++row) {
    difference[row] = apart(domain, exact.position[row], mixed.position[row]);
    if (exact.is_fixed(row)) continue;
    gain.add((exact.velocity[row] - before.velocity[row]).norm());
    velocity.add((mixed.velocity[row] - exact.velocity[row]).norm());
    position.add(difference[row].norm() / exact.radius[row]);
  }
  const double scale = std::max(gain.rms(), scene.scene.gravity.norm() * window);
  PrecisionError error;
  error.velocity_rms = over(velocity.rms(), scale);
  error.velocity_max = over(velocity.largest(), scale);
  error.position_rms = position.rms();
  error.position_max = position.largest();
  compare_overlaps(domain, exact, difference, error);
  return error;
}

PrecisionError measure_precision(const Scene& scene, const Mesh& mesh, ParticleEngine& engine,
                                 double window, int sub_steps, std::span<const Vector3> force,
                                 const Progress& progress) {
  EngineState state;
  engine.store(state);
  state.add_number("real_bytes", sizeof(double));  // which hold all that floats do
  const ParticleState before = engine.particles();
  Scene full = scene;
  full.particles.numerics.precision = Precision::full;
  const std::unique_ptr<ParticleEngine> twin = make_native_engine(full, mesh, before);
  twin->restore(state.fields());
  twin->advance(window, sub_steps, force, progress);
  try {
    engine.advance(window, sub_steps, force, progress);
    const PrecisionError error =
        precision_error(scene, mesh, window, before, twin->particles(), engine.particles());
    engine.rollback();
    return error;
  } catch (...) {
    engine.rollback();
    throw;
  }
}

void publish_precision(const PrecisionError& error, Fields& out) {
  out.add_number(field::precision_velocity_rms, error.velocity_rms);
  out.add_number(field::precision_velocity_max, error.velocity_max);
  out.add_number(field::precision_overlap_rms, error.overlap_rms);
  out.add_number(field::precision_overlap_max, error.overlap_max);
  out.add_number(field::precision_position_rms, error.position_rms);
  out.add_number(field::precision_position_max, error.position_max);
}

}  // namespace fluxpact
