#include "dem_server/interphase/excess.hpp"

#include <algorithm>
#include <cmath>

#include "proto/base/compensated_sum.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

// Of a cell's capacity: room, or an excess, below it is rounding.
constexpr double rounding = 1e-12;

// Far more than an excess needs to find its way.
constexpr int most_rounds = 1000;

template <class Value>
void spread_in_turn(const ExcessMoves& moves, std::span<Value> amounts) {
  std::int64_t k = 0;
  for (std::size_t turn = 0; turn < moves.from.size(); ++turn) {
    const Value whole = amounts[moves.from[turn]];
    for (; k < moves.ends[turn]; ++k) {
      const Value part = moves.parts[k].share * whole;
      amounts[moves.parts[k].to] += part;
      amounts[moves.from[turn]] -= part;
    }
  }
}

template <class Value>
void average_in_turn(const ExcessMoves& moves, std::span<Value> field) {
  for (std::size_t turn = moves.from.size(); turn-- > 0;) {
    const Value own = field[moves.from[turn]];
    Value seen = own;
    for (std::int64_t k = turn > 0 ? moves.ends[turn - 1] : 0; k < moves.ends[turn]; ++k) {
      seen += moves.parts[k].share * (field[moves.parts[k].to] - own);
    }
    field[moves.from[turn]] = seen;
  }
}

}  // namespace

void ExcessMoves::clear() {
  from.clear();
  ends.clear();
  parts.clear();
}

void ExcessMoves::spread(std::span<double> amounts) const { spread_in_turn(*this, amounts); }
void ExcessMoves::spread(std::span<Vector3> amounts) const { spread_in_turn(*this, amounts); }
void ExcessMoves::average(std::span<double> field) const { average_in_turn(*this, field); }
void ExcessMoves::average(std::span<Vector3> field) const { average_in_turn(*this, field); }

ExcessFinder::ExcessFinder(const Mesh& mesh, double smallest_voidage)
    : smallest_voidage_(smallest_voidage),
      volumes_(mesh.cell_volumes),
      centres_(mesh.cell_centres) {
  const auto cells = volumes_.size();
  offsets_.assign(cells + 1, 0);
  for (int cell = 0; cell < mesh.cells(); ++cell) {
    for (int k = mesh.cell_face_offsets[cell]; k < mesh.cell_face_offsets[cell + 1]; ++k) {
      const int face = mesh.cell_faces[k];
      if (face >= mesh.internal_faces()) continue;
      const int other = mesh.owner[face] == cell ? mesh.neighbour[face] : mesh.owner[face];
      if (other != cell) around_.push_back(other);
    }
    // Two cells may share several faces, those across a period among them.
    std::sort(around_.begin() + offsets_[cell], around_.end());
    around_.erase(std::unique(around_.begin() + offsets_[cell], around_.end()), around_.end());
    offsets_[cell + 1] = static_cast<int>(around_.size());
  }
  capacity_.resize(cells);
  std::ranges::transform(volumes_, capacity_.begin(),
                         [&](double volume) { return (1 - smallest_voidage) * volume; });
}

bool ExcessFinder::is_over_full(int cell, double solids) const {
  return solids > capacity_[cell] * (1 + rounding);
}

double ExcessFinder::move(std::int64_t step, std::span<double> solids, ExcessMoves& moves) {
  moves.clear();
  const int cells = static_cast<int>(volumes_.size());
  int worst = -1;
  const auto find_worst = [&] {
    worst = -1;
    for (int cell = 0; cell < cells; ++cell) {
      if (!is_over_full(cell, solids[cell])) continue;
      if (worst < 0 || solids[cell] * capacity_[worst] > solids[worst] * capacity_[cell]) {
        worst = cell;
      }
    }
    return worst >= 0;
  };
  if (!find_worst()) return 0;
  const int fullest = worst;
  before_.assign(solids.begin(), solids.end());
  // Each round fills all cells with room next to an excess, or ends it.
  for (int round = 0; find_worst(); ++round) {
    const std::size_t turns = moves.from.size();
    find_distances(solids);
    for (auto cell = order_.rbegin(); cell != order_.rend(); ++cell) {
      if (is_over_full(*cell, solids[*cell])) pass_on(*cell, solids, moves);
    }
    if (moves.from.size() == turns || round == most_rounds) {
      refuse(fullest, 1 - before_[fullest] / volumes_[fullest], step);
    }
  }
  CompensatedSum moved;
  for (int cell = 0; cell < cells; ++cell) moved.add(std::max(0.0, before_[cell] - solids[cell]));
  return moved.value();
}

// Breadth first from all cells with room.
void ExcessFinder::find_distances(std::span<const double> solids) {
  const auto cells = volumes_.size();
  distance_.assign(cells, -1);
  order_.clear();
  order_.reserve(cells);
  for (std::size_t cell = 0; cell < cells; ++cell) {
    if (solids[cell] < capacity_[cell] * (1 - rounding)) {
      distance_[cell] = 0;
      order_.push_back(static_cast<int>(cell));
    }
  }
  for (std::size_t head = 0; head < order_.size(); ++head) {
    const int cell = order_[head];
    for (int k = offsets_[cell]; k < offsets_[cell + 1]; ++k) {
      if (distance_[around_[k]] >= 0) continue;
      distance_[around_[k]] = distance_[cell] + 1;
      order_.push_back(around_[k]);
    }
  }
}

// To the cells that are nearer to room: to those with room in proportion to it and no more than it,
// to full ones, which pass it on in their turn, in equal parts.
void ExcessFinder::pass_on(int cell, std::span<double> solids, ExcessMoves& moves) {
  const double excess = solids[cell] - capacity_[cell];
  const bool at_room = distance_[cell] == 1;
  const auto accepts = [&](int other) {
    if (distance_[other] != distance_[cell] - 1) return 0.0;
    return at_room ? std::max(0.0, capacity_[other] - solids[other]) : 1.0;
  };
  double all = 0;
  for (int k = offsets_[cell]; k < offsets_[cell + 1]; ++k) all += accepts(around_[k]);
  if (!(all > 0)) return;  // taken by others before its turn: the next round finds another way
  const double passed = (at_room ? std::min(excess, all) : excess) / solids[cell];
  const std::size_t first = moves.parts.size();
  for (int k = offsets_[cell]; k < offsets_[cell + 1]; ++k) {
    const double part = passed * (accepts(around_[k]) / all);
    if (part > 0) moves.parts.push_back({around_[k], part});
  }
  const double whole = solids[cell];
  for (std::size_t k = first; k < moves.parts.size(); ++k) {
    const double part = moves.parts[k].share * whole;
    solids[moves.parts[k].to] += part;
    solids[cell] -= part;
  }
  moves.from.push_back(cell);
  moves.ends.push_back(static_cast<std::int64_t>(moves.parts.size()));
}

void ExcessFinder::refuse(int cell, double voidage, std::int64_t step) const {
  const Vector3& centre = centres_[cell];
  throw NumericsError(
      "cell {} at ({}, {}, {}) m has the voidage {} after step {}, and no cell that could take "
      "what is beyond {}: the particles need more room than the cells around it have; use a larger "
      "domain, fewer particles, or a lower interphase.voidage.smallest",
      cell, centre.x(), centre.y(), centre.z(), voidage, step, smallest_voidage_);
}

}  // namespace fluxpact
