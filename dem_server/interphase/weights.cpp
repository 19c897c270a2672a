#include "dem_server/interphase/weights.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "dem_server/interphase/satellites.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

// Overlaps below this share of R³ are the rounding of a ball that does not touch the cell.
constexpr double touching = 1e-14;

// Where the bell (1 − q²)³ has half its height: q² = 1 − 2^(−1/3).
const double bell_half_height = std::sqrt(1 - 1 / std::cbrt(2.0));

// Of the bell at half its height, in diameters of the particle, if the scene gives no width.
constexpr double default_bell_width = 4;

// First particle of a thread's equal share.
int share_begin(int particles, int thread, int threads) {
  return static_cast<int>(static_cast<std::int64_t>(particles) * thread / threads);
}

}  // namespace

WeightsBuilder::WeightsBuilder(const Mesh& mesh, const VoidageSettings& settings, int threads)
    : shapes_(mesh),
      locator_(mesh, shapes_),
      map_(settings.map),
      half_width_(0.5 * settings.width),
      threads_(threads) {
  if (map_ == VoidageMap::prescribed) {
    throw ConfigError("interphase.voidage: 'prescribed' maps no particles; use another map");
  }
  if (map_ == VoidageMap::diffusion) {
    diffusion_.emplace(mesh, settings.width, threads);
    map_ = settings.from == DiffusedMap::exact ? VoidageMap::exact : VoidageMap::centroid;
  }
  if (map_ == VoidageMap::satellite) points_ = satellite_points(settings.points);
  if (shapes_.lattice()) lattice_.emplace(*shapes_.lattice());
  if (lattice_ && map_ == VoidageMap::kernel) lattice_bell_.emplace(*shapes_.lattice());
  rows_.resize(static_cast<std::size_t>(threads));
}

void WeightsBuilder::build(const ParticleState& particles, std::int64_t step,
                           ParticleCellWeights& weights) {
  weights.diffusion = diffusion_ ? &*diffusion_ : nullptr;
  weights.excess.clear();
  if (map_ == VoidageMap::centroid) {
    build_whole(particles, step, weights);
  } else {
    build_rows(particles, step, weights);
  }
  transpose(weights);
}

/// What is the same in every window, offsets and ones, is written when their number changes.
void WeightsBuilder::build_whole(const ParticleState& particles, std::int64_t step,
                                 ParticleCellWeights& weights) const {
  const int count = particles.size();
  const auto size = static_cast<std::size_t>(count);
  if (!weights.whole || weights.row_cells.size() != size) {
    weights.whole = true;
    weights.row_offsets.resize(size + 1);
    std::iota(weights.row_offsets.begin(), weights.row_offsets.end(), 0);
    weights.row_cells.resize(size);
    weights.row_weights.assign(size, 1.0);
    weights.cell_weights.assign(size, 1.0);
  }
  const double period = locator_.shortest_period();
  int bad = count;
#pragma omp parallel for schedule(static) num_threads(threads_) reduction(min : bad)
  for (int p = 0; p < count; ++p) {
    const int home = cell_of(particles.position[p]);
    weights.row_cells[p] = home;
    if (home < 0 || !(particles.radius[p] < period)) bad = std::min(bad, p);
  }
  if (bad < count) refuse(particles, bad, step);
}

// Each thread fills the rows of one run of particles; joined in the order of the particles, the
// result does not know how many threads there were.
void WeightsBuilder::build_rows(const ParticleState& particles, std::int64_t step,
                                ParticleCellWeights& weights) {
  weights.whole = false;
  const int count = particles.size();
  weights.row_offsets.resize(static_cast<std::size_t>(count) + 1);
  weights.row_offsets[0] = 0;
#pragma omp parallel for schedule(static) num_threads(threads_)
  for (int thread = 0; thread < threads_; ++thread) {
    Row& row = rows_[thread];
    row.cells.clear();
    row.weights.clear();
    row.bad_particle = -1;
    const int last = share_begin(count, thread + 1, threads_);
    for (int p = share_begin(count, thread, threads_); p < last; ++p) {
      if (!append_row({particles.position[p], particles.radius[p]}, row)) {
        row.bad_particle = p;
        break;
      }
      weights.row_offsets[p + 1] = static_cast<std::int64_t>(row.cells.size());
    }
  }
  for (const Row& row : rows_) {
    if (row.bad_particle >= 0) refuse(particles, row.bad_particle, step);
  }
  join_rows(particles, weights);
}

int WeightsBuilder::cell_of(const Vector3& point) const {
  const int cell = lattice_ ? lattice_->cell_of(point) : -1;
  return cell >= 0 ? cell : locator_.cell_of(point);
}

/// Of the map about the centre of a particle [m].
double WeightsBuilder::reach(double radius) const {
  if (map_ != VoidageMap::kernel) return radius;
  return (half_width_ > 0 ? half_width_ : default_bell_width * radius) / bell_half_height;
}

/// False if the particle cannot be mapped.
bool WeightsBuilder::append_row(const Ball& ball, Row& row) const {
  if (map_ == VoidageMap::exact && lattice_ && lattice_->find(ball, row.shares)) {
    const double total = row.shares.total;
    for (int k = 0; k < row.shares.count; ++k) {
      row.cells.push_back(row.shares.cells[k]);
      row.weights.push_back(row.shares.volumes[k] / total);
    }
    return ball.radius < locator_.shortest_period();
  }
  const int home = cell_of(ball.centre);
  if (home < 0 || !(reach(ball.radius) < locator_.shortest_period())) return false;
  switch (map_) {
    case VoidageMap::exact:
      return append_exact(home, ball, row);
    case VoidageMap::satellite:
      return append_points(home, ball, row);
    case VoidageMap::kernel:
      return append_bell(home, ball, row);
    default:
      return false;  // `build_whole` has no rows
  }
}

bool WeightsBuilder::append_exact(int home, const Ball& ball, Row& row) const {
  if (shapes_.holds(home, ball)) {
    row.cells.push_back(home);
    row.weights.push_back(1.0);
    return true;
  }
  row.images.clear();
  locator_.touching(ball, row.images);
  const std::size_t first = row.cells.size();
  const double smallest = touching * ball.radius * ball.radius * ball.radius;
  double sum = 0;
  for (const CellImage& image : row.images) {
    const double volume = shapes_.overlap(image.cell, {image.point, ball.radius});
    if (volume <= smallest) continue;
    row.cells.push_back(image.cell);
    row.weights.push_back(volume);
    sum += volume;
  }
  if (!(sum > 0) || !std::isfinite(sum)) return false;
  for (std::size_t k = first; k < row.weights.size(); ++k) row.weights[k] /= sum;
  return true;
}

/// Points outside the domain do not count; if all are, all is in the cell of the centre.
bool WeightsBuilder::append_points(int home, const Ball& ball, Row& row) const {
  const std::size_t first = row.cells.size();
  double inside = 0;
  if (!shapes_.holds(home, {ball.centre, 1.06 * ball.radius})) {  // points may lie a little outside
    for (const Vector3& point : points_) {
      const int cell = cell_of(ball.centre + ball.radius * point);
      if (cell < 0) continue;
      inside += 1;
      const auto begin = row.cells.begin() + static_cast<std::ptrdiff_t>(first);
      const auto known = std::find(begin, row.cells.end(), cell);
      if (known != row.cells.end()) {
        row.weights[static_cast<std::size_t>(known - row.cells.begin())] += 1;
      } else {
        row.cells.push_back(cell);
        row.weights.push_back(1);
      }
    }
  }
  if (inside == 0) {
    row.cells.push_back(home);
    row.weights.push_back(1.0);
    return true;
  }
  for (std::size_t k = first; k < row.weights.size(); ++k) row.weights[k] /= inside;
  return true;
}

bool WeightsBuilder::append_bell(int home, const Ball& ball, Row& row) const {
  const double radius = reach(ball.radius);
  if (!(ball.radius > 0) || !std::isfinite(radius)) return false;
  if (shapes_.holds(home, {ball.centre, radius})) {
    row.cells.push_back(home);
    row.weights.push_back(1.0);
    return true;
  }
  const std::size_t first = row.cells.size();
  if (!lattice_bell_ ||
      !lattice_bell_->append({ball.centre, radius}, row.bell, row.cells, row.weights)) {
    integrate_bell({ball.centre, radius}, row);
  }
  double sum = 0;
  for (std::size_t k = first; k < row.weights.size(); ++k) sum += row.weights[k];
  if (!(sum > 0) || !std::isfinite(sum)) return false;
  for (std::size_t k = first; k < row.weights.size(); ++k) row.weights[k] /= sum;
  return true;
}

/// On any mesh.
void WeightsBuilder::integrate_bell(const Ball& ball, Row& row) const {
  row.images.clear();
  locator_.touching(ball, row.images);
  const double per_square = 1 / (ball.radius * ball.radius);
  for (const CellImage& image : row.images) {
    double weight = 0;
    const Ball bell{image.point, ball.radius};
    shapes_.each_piece(
        image.cell, bell, 0.5 * ball.radius, [&](const Vector3& point, double volume) {
          const double height = std::max(0.0, 1 - (point - image.point).squaredNorm() * per_square);
          weight += volume * height * height * height;
        });
    if (!(weight > 0)) continue;
    row.cells.push_back(image.cell);
    row.weights.push_back(weight);
  }
}

void WeightsBuilder::join_rows(const ParticleState& particles, ParticleCellWeights& weights) {
  if (threads_ == 1) {  // nothing to join
    std::swap(weights.row_cells, rows_[0].cells);
    std::swap(weights.row_weights, rows_[0].weights);
    return;
  }
  std::size_t entries = 0;
  for (const Row& row : rows_) entries += row.cells.size();
  weights.row_cells.resize(entries);
  weights.row_weights.resize(entries);
  std::int64_t before = 0;
  for (int thread = 0; thread < threads_; ++thread) {
    const Row& row = rows_[thread];
    std::ranges::copy(row.cells, weights.row_cells.begin() + before);
    std::ranges::copy(row.weights, weights.row_weights.begin() + before);
    const int last = share_begin(particles.size(), thread + 1, threads_);
    for (int p = share_begin(particles.size(), thread, threads_); p < last; ++p) {
      weights.row_offsets[p + 1] += before;
    }
    before += static_cast<std::int64_t>(row.cells.size());
  }
}

void WeightsBuilder::transpose(ParticleCellWeights& weights) {
  const auto cells = static_cast<std::size_t>(shapes_.cells());
  weights.cell_offsets.assign(cells + 1, 0);
  weights.cell_particles.resize(weights.row_cells.size());
  for (const int cell : weights.row_cells) ++weights.cell_offsets[cell + 1];
  for (std::size_t cell = 0; cell < cells; ++cell) {
    weights.cell_offsets[cell + 1] += weights.cell_offsets[cell];
  }
  next_.assign(weights.cell_offsets.begin(), weights.cell_offsets.end() - 1);
  if (weights.whole) {
    for (int p = 0; p < weights.particles(); ++p) {
      weights.cell_particles[next_[weights.row_cells[p]]++] = p;
    }
    return;
  }
  weights.cell_weights.resize(weights.row_cells.size());
  for (int p = 0; p < weights.particles(); ++p) {
    for (auto k = weights.row_offsets[p]; k < weights.row_offsets[p + 1]; ++k) {
      const auto place = next_[weights.row_cells[k]]++;
      weights.cell_particles[place] = p;
      weights.cell_weights[place] = weights.row_weights[k];
    }
  }
}

void WeightsBuilder::refuse(const ParticleState& particles, int particle, std::int64_t step) const {
  const Vector3& x = particles.position[particle];
  const double radius = particles.radius[particle];
  if (locator_.cell_of(x) < 0) {
    throw NumericsError(
        "particle {} at ({}, {}, {}) m is outside the mesh at the end of step {}: it passed "
        "through "
        "a wall or an opening; use stiffer contacts or a smaller particles.time_step, or close the "
        "side for particles",
        particles.id[particle], x.x(), x.y(), x.z(), step);
  }
  throw NumericsError(
      "particle {} at ({}, {}, {}) m with radius {} m cannot be mapped to cells in step {}: the "
      "radius must be positive, and {} m, the reach of the map, below the shortest period of the "
      "domain, {} m",
      particles.id[particle], x.x(), x.y(), x.z(), radius, step, reach(radius),
      locator_.shortest_period());
}

}  // namespace fluxpact
