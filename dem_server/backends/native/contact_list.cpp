#include "dem_server/backends/native/contact_list.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fluxpact {
namespace {

/// Everything that the making of one list reads.
template <class Real, bool turning>
struct Sources {
  const ContactScope& scope;
  std::span<const Body<Real, turning>> spheres;
  const std::vector<int>& material_of_row;
  const SizeLevels& levels;
  const Resorting& resorting;
  const ContactList<Real>* before;
  const FormerSprings<Real>& springs;
  std::array<Vector3, 27> shifts;
  double extent;          // [m] of the spheres and of the longest shift together
  SpringNumbers numbers;  // of each pair
  int spring_rows;        // of each contact with a wall

  int law(const ContactList<Real>& list, int i, int other_material) const {
    return scope.laws.index(material_of_row[list.row[i]], other_material);
  }
};

/// Places in floats, and distances reckoned from them, are off by less than this share of the
/// extent: some ten roundings of 6e-8 each (two offsets, the shift, differences, squares, sums).
constexpr double float_margin = 1e-6;

/// How far a particle may go [m], while the list is made.
template <class Real>
double slack_of(const ContactList<Real>& list, int place) {
  return static_cast<double>(list.listed_at[place].offset[3]);
}

/// How a pair stood in the list before.
struct FormerPair {
  int i, j, shift;
};

/// The springs of a pair in the old list, or none.
template <class Real>
struct Held {
  const Real* numbers = nullptr;
  bool mirrored = false;  // the partner held it
};

template <class Place>
int find_pair(const PairList<Place>& pairs, int mine, int other, int shift) {
  const auto at = std::lower_bound(pairs.mine.begin(), pairs.mine.end(), mine);
  for (auto n = at - pairs.mine.begin(); n < pairs.size() && pairs.mine[n] == mine; ++n) {
    const bool same_image = pairs.shift.empty() || pairs.shift[n] == shift;
    if (pairs.other[n] == other && same_image) return static_cast<int>(n);
  }
  return -1;
}

template <class Real>
Held<Real> find_springs(const ContactList<Real>& list, const FormerSprings<Real>& all,
                        const FormerPair& pair) {
  const int holder = list.blocks.holding(pair.i);
  const int first = list.blocks.first(holder);
  const ContactBlock<Real>& block = list.block[holder];
  const BlockSprings<Real>& springs_of = all[holder];
  const auto held = [](const PairSprings<Real>& springs, int contact, bool mirrored) {
    return contact < 0 ? Held<Real>{} : Held<Real>{springs.find(contact), mirrored};
  };
  if (pair.shift != Shift::none) {
    return held(springs_of.image, find_pair(block.image, pair.i - first, pair.j, pair.shift),
                false);
  }
  if (list.blocks.holding(pair.j) != holder) {
    return held(springs_of.outer, find_pair(block.outer, pair.i - first, pair.j, pair.shift),
                false);
  }
  const int low = std::min(pair.i, pair.j) - first;
  const int high = std::max(pair.i, pair.j) - first;
  return held(springs_of.inner, find_pair(block.inner, low, high, pair.shift), pair.i > pair.j);
}

/// The springs that a pair had in the list before.
template <class Real, bool turning>
Held<Real> former_springs(const Sources<Real, turning>& from, int i, int j, int shift) {
  // Wrapping moved each particle by whole periods; the vector between the two stayed the same.
  std::array<int, 3> periods = Shift::periods(shift);
  for (int axis = 0; !from.resorting.periods.empty() && axis < 3; ++axis) {
    periods[axis] += from.resorting.periods[i][axis] - from.resorting.periods[j][axis];
    if (periods[axis] < -1 || periods[axis] > 1) return {};  // no neighbours before
  }
  const int old_i = from.resorting.previous[i];
  const int old_j = from.resorting.previous[j];
  if (old_i < 0 || old_j < 0) return {};
  return find_springs(*from.before, from.springs,
                      {old_i, old_j, Shift::code(periods[0], periods[1], periods[2])});
}

/// Springs of the pairs of a new list; `first` and `base` turn its places into those of all
/// particles.
template <class Real, bool turning, class Place>
void carry_springs(const Sources<Real, turning>& from, const FoundPairs& pairs, int first, int base,
                   typename ListMaking<Real>::Found& found, const PairList<Place>& list,
                   ClosePairs<Real>& close) {
  PairSprings<Real>& springs = found.springs;
  springs.reset(list.size(), from.numbers, 0);
  for (const std::int32_t contact : pairs.touching) {
    if (from.before == nullptr || from.numbers.count == 0) break;
    const Pair& pair = pairs.listed[contact];
    const Held<Real> held = former_springs(from, first + pair.mine, base + pair.other, pair.shift);
    if (held.numbers != nullptr) springs.append(contact, held.numbers, 1, held.mirrored);
  }
  close.bring_back(list, springs, found.places);
}

/// A sphere in floats, as those are that it may be near to: its offset, moved by an image, and how
/// far it reaches with the largest radius of the others, but not their slack [m].
struct Seeker {
  float x, y, z, reach;
};

/// Of the places [begin, end) those that may be in reach, to `near`; how many. Most are not, and
/// which are cannot be foretold: so there is no branch.
int sift(const Seeker& seeker, const ListedAt* others, int begin, int end, int* near) {
  int count = 0;
  for (int j = begin; j < end; ++j) {
    const float* other = others[j].offset;
    const float x = seeker.x - other[0];
    const float y = seeker.y - other[1];
    const float z = seeker.z - other[2];
    const float sum = seeker.reach + other[3];
    near[count] = j;
    count += x * x + y * y + z * z < sum * sum ? 1 : 0;
  }
  return count;
}

template <class Real, bool turning>
void find_pairs(const Sources<Real, turning>& from, int index, const ContactList<Real>& list,
                typename ListMaking<Real>::Found& found, ContactBlock<Real>& block) {
  const int first = list.blocks.first(index);
  const int last = list.blocks.last(index);
  const bool laws = !from.scope.one_law;
  found.inner.clear();
  found.outer.clear();
  found.image.clear();
  for (int i = first; i < last; ++i) {
    const Body<Real, turning>& a = from.spheres[i];
    const double touch = a.radius + from.scope.beyond_contact;
    const double reach = touch + slack_of(list, i);
    const bool fixed = a.inverse_mass == 0;
    const float* offset = list.listed_at[i].offset;
    Seeker seeker{};
    const auto add = [&](int begin, int end, int shift, FoundPairs& pairs, int base) {
      if (begin >= end) return;
      const Vector3& image = from.shifts[shift];
      if (static_cast<int>(found.near.size()) < end - begin) found.near.resize(end - begin);
      const int count = sift(seeker, list.listed_at.data(), begin, end, found.near.data());
      for (int k = 0; k < count; ++k) {
        const int j = found.near[k];
        const Body<Real, turning>& b = from.spheres[j];
        const double x = a.position[0] - b.position[0] - image[0];
        const double y = a.position[1] - b.position[1] - image[1];
        const double z = a.position[2] - b.position[2] - image[2];
        const double sum = reach + b.radius + slack_of(list, j);
        const double square = x * x + y * y + z * z;
        if (square >= sum * sum || j == i) continue;
        if (fixed && b.inverse_mass == 0) continue;  // neither would move
        const int law = laws ? from.law(list, i, from.material_of_row[list.row[j]]) : 0;
        // (The millionth is for the rounding of positions.)
        if (square < 1.000001 * (touch + b.radius) * (touch + b.radius)) {
          pairs.touching.push_back(static_cast<std::int32_t>(pairs.listed.size()));
        }
        pairs.listed.push_back({j - base, static_cast<std::uint16_t>(i - first),
                                static_cast<std::uint8_t>(shift), static_cast<std::uint8_t>(law)});
      }
    };
    const auto visit = [&](int begin, int end, int shift, double largest_radius) {
      // Pairs of the own block are held by the one that comes first.
      if (shift == Shift::none && begin >= first && end <= i + 1) return;
      const Vector3& image = from.shifts[shift];
      const double all = reach + largest_radius;
      seeker = {offset[0] - static_cast<float>(image[0]), offset[1] - static_cast<float>(image[1]),
                offset[2] - static_cast<float>(image[2]),
                static_cast<float>(all + float_margin * (all + from.extent))};
      if (shift != Shift::none) {
        add(begin, end, shift, found.image, 0);
        return;
      }
      add(begin, std::min(end, first), shift, found.outer, 0);
      add(std::max(begin, i + 1), std::min(end, last), shift, found.inner, first);
      add(std::max(begin, last), end, shift, found.outer, 0);
    };
    from.levels.visit_near(a.position, reach + list.reach, visit);
  }
  block.inner.assign(found.inner.listed, {.law = laws});
  block.outer.assign(found.outer.listed, {.law = laws});
  block.image.assign(found.image.listed, {.shift = true, .law = laws});
  carry_springs(from, found.inner, first, first, found, block.inner, block.inner_close);
  carry_springs(from, found.outer, first, 0, found, block.outer, block.outer_close);
  carry_springs(from, found.image, first, 0, found, block.image, block.image_close);
  block.budget.forget();
  find_partners(list.blocks, block);
}

template <class Real, bool turning>
void carry_plane_spring(const Sources<Real, turning>& from, int place, int side, int contact,
                        Springs<Real>& springs) {
  const ContactList<Real>& before = *from.before;
  const int old = from.resorting.previous[place];
  if (old < 0) return;
  const ContactBlock<Real>& block = before.block[before.blocks.holding(old)];
  const int mine = old - before.blocks.first(before.blocks.holding(old));
  auto held = std::lower_bound(block.planes.begin(), block.planes.end(), mine,
                               [](const NearPlane& p, int holder) { return p.mine < holder; });
  for (; held != block.planes.end() && held->mine == mine; ++held) {
    if (held->side != side) continue;
    const int at = static_cast<int>(held - block.planes.begin());
    springs.carry(block.plane_springs, at, contact);
  }
}

template <class Real, bool turning>
void find_planes(const Sources<Real, turning>& from, int index, const ContactList<Real>& list,
                 ContactBlock<Real>& block) {
  block.planes.clear();
  const Domain& domain = from.scope.domain;
  const int first = list.blocks.first(index);
  for (int i = first; i < list.blocks.last(index); ++i) {
    const Body<Real, turning>& body = from.spheres[i];
    if (body.inverse_mass == 0) continue;
    for (int side = 0; side < 6; ++side) {
      if (domain.sides[side] != SideKind::wall) continue;
      const double inward = side % 2 == 0 ? 1.0 : -1.0;
      const double distance = inward * (body.position[side / 2] - domain.plane(side));
      if (!(distance < body.radius + slack_of(list, i) + from.scope.beyond_contact)) continue;
      const int law = from.law(list, i, from.scope.laws.walls());
      block.planes.push_back({static_cast<std::uint16_t>(i - first),
                              static_cast<std::uint8_t>(side), static_cast<std::uint8_t>(law)});
    }
  }
  block.plane_springs.reset(static_cast<int>(block.planes.size()), from.spring_rows);
  if (from.before == nullptr || from.spring_rows == 0) return;
  for (int contact = 0; contact < block.plane_springs.contacts; ++contact) {
    const NearPlane& near = block.planes[contact];
    carry_plane_spring(from, first + near.mine, near.side, contact, block.plane_springs);
  }
}

/// Touches and springs that a particle had, in the new list.
template <class Real, bool turning>
void carry_touches(const Sources<Real, turning>& from, int old, int mine,
                   SurfaceContacts<Real>& contacts) {
  const ContactList<Real>& before = *from.before;
  const int holder = before.blocks.holding(old);
  const SurfaceContacts<Real>& held = before.block[holder].surfaces;
  const TouchRange range = touches_of(held.touches, old - before.blocks.first(holder));
  for (int k = range.first; k < range.last; ++k) {
    contacts.touches.push_back(held.touches[k]);
    contacts.touches.back().mine = static_cast<std::uint16_t>(mine);
  }
}

/// The elements that a particle had near it in the list before.
template <class Real, bool turning>
std::span<const int> former_elements(const Sources<Real, turning>& from, int place) {
  if (from.before == nullptr || from.resorting.previous[place] < 0) return {};
  const int old = from.resorting.previous[place];
  const int holder = from.before->blocks.holding(old);
  const SurfaceContacts<Real>& held = from.before->block[holder].surfaces;
  const int mine = old - from.before->blocks.first(holder);
  const auto at = std::lower_bound(held.near.begin(), held.near.end(), mine);
  if (at == held.near.end() || *at != mine) return {};
  const auto k = at - held.near.begin();
  return std::span(held.elements)
      .subspan(held.first_element[k], held.first_element[k + 1] - held.first_element[k]);
}

template <class Real, bool turning>
void find_surfaces(const Sources<Real, turning>& from, int index, const ContactList<Real>& list,
                   SurfaceContacts<Real>& contacts) {
  contacts.near.clear();
  contacts.material.clear();
  contacts.first_element.assign(1, 0);
  contacts.elements.clear();
  contacts.touches.clear();
  contacts.lost = -1;
  if (from.scope.walls.empty()) return;
  const int first = list.blocks.first(index);
  for (int i = first; i < list.blocks.last(index); ++i) {
    const Body<Real, turning>& body = from.spheres[i];
    if (body.inverse_mass == 0) continue;  // fixed: no wall moves it
    const std::size_t had = contacts.elements.size();
    // A wall that moves has as much as the slowest particle.
    const double reach =
        body.radius + from.scope.beyond_contact + slack_of(list, i) + from.scope.slack.least;
    const bool held = from.scope.walls.nearby(Eigen::Map<const Vector3>(body.position), reach,
                                              former_elements(from, i), contacts.elements);
    if (!held) contacts.lost = i - first;
    if (contacts.elements.size() == had) continue;
    contacts.near.push_back(static_cast<std::uint16_t>(i - first));
    contacts.material.push_back(static_cast<std::uint8_t>(from.material_of_row[list.row[i]]));
    contacts.first_element.push_back(static_cast<int>(contacts.elements.size()));
    if (from.before != nullptr && from.resorting.previous[i] >= 0) {
      carry_touches(from, from.resorting.previous[i], i - first, contacts);
    }
  }
  contacts.springs.reset(static_cast<int>(contacts.touches.size()), from.spring_rows);
  if (from.spring_rows == 0) return;
  int contact = 0;
  for (const std::uint16_t mine : contacts.near) {
    const int old = from.before != nullptr ? from.resorting.previous[first + mine] : -1;
    if (old < 0) continue;
    const int holder = from.before->blocks.holding(old);
    const SurfaceContacts<Real>& held = from.before->block[holder].surfaces;
    const TouchRange range = touches_of(held.touches, old - from.before->blocks.first(holder));
    for (int k = range.first; k < range.last; ++k) {
      contacts.springs.carry(held.springs, k, contact++);
    }
  }
}

/// How far each particle may go; the farthest [m].
template <class Real, bool turning>
double grant_slack(const ContactScope& scope, std::span<const Body<Real, turning>> spheres,
                   HugeVector<ListedAt>& listed_at) {
  const Slack& range = scope.slack;
  const int count = static_cast<int>(spheres.size());
  listed_at.resize(count);
  float farthest = static_cast<float>(range.least);
#pragma omp parallel for num_threads(scope.threads) schedule(static) reduction(max : farthest)
  for (int i = 0; i < count; ++i) {
    double square = 0;
    for (const Real v : spheres[i].velocity) {
      square += static_cast<double>(v) * static_cast<double>(v);
    }
    float& slack = listed_at[i].offset[3];
    slack =
        static_cast<float>(std::clamp(range.flight * std::sqrt(square), range.least, range.most));
    farthest = std::max(farthest, slack);
  }
  return static_cast<double>(farthest);
}

/// Where the particles are now; the diagonal of the box that holds them [m].
template <class Real, bool turning>
double mark_places(const ContactScope& scope, std::span<const Body<Real, turning>> spheres,
                   ContactList<Real>& list) {
  Vector3 lower = Vector3::Zero();
  Vector3 upper = Vector3::Zero();
  const int count = static_cast<int>(spheres.size());
  for (int i = 0; i < count; ++i) {
    const Eigen::Map<const Vector3> at(spheres[i].position);
    lower = i == 0 ? Vector3(at) : Vector3(lower.cwiseMin(at));
    upper = i == 0 ? Vector3(at) : Vector3(upper.cwiseMax(at));
  }
  list.origin = 0.5 * (lower + upper);
#pragma omp parallel for num_threads(scope.threads) schedule(static)
  for (int i = 0; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      list.listed_at[i].offset[axis] =
          static_cast<float>(spheres[i].position[axis] - list.origin[axis]);
    }
  }
  return (upper - lower).norm();
}

/// What the slack of each particle leaves of its radius and reach: the last step of the list.
template <class Real, bool turning>
void mark_slack(const Sources<Real, turning>& from, double diagonal, ContactList<Real>& list) {
  const int count = static_cast<int>(from.spheres.size());
  // Half an ulp of a float in each axis, relative to the farthest offset.
  const double rounding = 0.5 * diagonal * 6e-8;
#pragma omp parallel for num_threads(from.scope.threads) schedule(static)
  for (int i = 0; i < count; ++i) {
    const double own = std::max(slack_of(list, i) - rounding, 0.0);
    const double rest = std::sqrt(list.reach * list.reach - own * own);
    const auto nearest = static_cast<float>(from.spheres[i].radius + rest);
    list.listed_at[i].offset[3] = std::nextafter(nearest, std::numeric_limits<float>::infinity());
  }
}

}  // namespace

template <class Real>
void find_partners(const Blocks& blocks, ContactBlock<Real>& block) {
  block.partners.clear();
  for (const auto* pairs : {&block.outer, &block.image}) {
    for (const int other : pairs->other) {
      const int partner = blocks.holding(other);
      if (std::ranges::find(block.partners, partner) != block.partners.end()) continue;
      block.partners.push_back(partner);
    }
  }
}

template <class Real>
void FormerSprings<Real>::plan(const ContactList<Real>& before, const Blocks& blocks,
                               std::span<const int> previous) {
  springs_.resize(before.blocks.count());
  taken_.assign(springs_.size(), 0);
  readers_.assign(springs_.size(), 0);
  sources_.resize(blocks.count());
  for (int b = 0; b < blocks.count(); ++b) {
    std::vector<int>& sources = sources_[b];
    sources.clear();
    for (int i = blocks.first(b); i < blocks.last(b); ++i) {
      if (previous[i] < 0) continue;
      const int former = before.blocks.holding(previous[i]);
      if (std::ranges::find(sources, former) != sources.end()) continue;
      sources.push_back(former);
      ++readers_[former];
    }
  }
}

template <class Real>
void FormerSprings<Real>::take(int former, ContactList<Real>& before) {
  if (taken_[former] != 0) return;
  taken_[former] = 1;
  BlockSprings<Real>& springs = springs_[former];
  if (!free_.empty()) {
    springs = std::move(free_.back());
    free_.pop_back();
  }
  springs.take(before.block[former]);
  springs.inner.number();
  springs.outer.number();
  springs.image.number();
}

template <class Real>
void FormerSprings<Real>::fetch(int b, ContactList<Real>& before, ContactList<Real>& list) {
#pragma omp critical(former_springs)
  {
    for (const int former : sources_[b]) take(former, before);
    if (b < before.blocks.count()) {
      if (readers_[b] > 0) take(b, before);
      swap_close_pairs(before.block[b], list.block[b]);
    }
  }
}

template <class Real>
void FormerSprings<Real>::release(int b) {
#pragma omp critical(former_springs)
  for (const int former : sources_[b]) {
    if (--readers_[former] == 0) free_.push_back(std::move(springs_[former]));
  }
}

template <class Real, bool turning>
void make_contact_list(const ContactScope& scope, std::span<const Body<Real, turning>> spheres,
                       const std::vector<int>& material, const SizeLevels& levels,
                       const Resorting& resorting, ContactList<Real>* before,
                       ListMaking<Real>& making, ContactList<Real>& list) {
  list.block.resize(list.blocks.count());
  making.found.resize(scope.threads);
  list.reach = grant_slack(scope, spheres, list.listed_at);
  const double diagonal = mark_places(scope, spheres, list);
  const std::array<Vector3, 27> shifts = shift_vectors(scope.domain);
  const Sources<Real, turning> from{scope,
                                    spheres,
                                    material,
                                    levels,
                                    resorting,
                                    before,
                                    making.springs,
                                    shifts,
                                    diagonal + shifts.back().norm(),
                                    spring_numbers(scope.laws.model()),
                                    spring_rows(scope.laws.model())};
  if (before != nullptr) making.springs.plan(*before, list.blocks, resorting.previous);
#pragma omp parallel for num_threads(scope.threads) schedule(dynamic, 1)
  for (int b = 0; b < list.blocks.count(); ++b) {
    if (before != nullptr) making.springs.fetch(b, *before, list);
    find_pairs(from, b, list, making.found[omp_get_thread_num()], list.block[b]);
    if (before != nullptr) making.springs.release(b);
    find_planes(from, b, list, list.block[b]);
    find_surfaces(from, b, list, list.block[b].surfaces);
  }
  mark_slack(from, diagonal, list);
}

#define FLUXPACT_INSTANTIATE(Real, turning)                                               \
  template void make_contact_list<Real, turning>(                                         \
      const ContactScope&, std::span<const Body<Real, turning>>, const std::vector<int>&, \
      const SizeLevels&, const Resorting&, ContactList<Real>*, ListMaking<Real>&,         \
      ContactList<Real>&);
FLUXPACT_INSTANTIATE(double, false)
FLUXPACT_INSTANTIATE(double, true)
FLUXPACT_INSTANTIATE(float, false)
FLUXPACT_INSTANTIATE(float, true)
#undef FLUXPACT_INSTANTIATE
template void find_partners<double>(const Blocks&, ContactBlock<double>&);
template void find_partners<float>(const Blocks&, ContactBlock<float>&);

}  // namespace fluxpact
