#include "dem_server/backends/native/surface_contacts.hpp"

#include <algorithm>
#include <array>

namespace fluxpact {
namespace {

SurfaceTouch laid_out(const WallTouch& touch, int mine, int law) {
  SurfaceTouch row{};
  for (int axis = 0; axis < 3; ++axis) {
    row.normal[axis] = touch.normal[axis];
    row.velocity[axis] = touch.velocity[axis];
  }
  row.normal[3] = touch.distance;
  row.surface = touch.surface;
  row.feature = touch.feature;
  row.mine = static_cast<std::uint16_t>(mine);
  row.law = static_cast<std::uint8_t>(law);
  return row;
}

/// The touch that this one was a sub-step ago: on the same feature, else the one of the same
/// surface whose normal is near; -1 if there was none.
int former_touch(std::span<const SurfaceTouch> former, const SurfaceTouch& touch) {
  const TouchRange range = touches_of(former, touch.mine);
  int nearest = -1;
  double cosine = least_angle_cosine;
  for (int k = range.first; k < range.last; ++k) {
    const SurfaceTouch& old = former[k];
    if (old.surface != touch.surface) continue;
    if (old.feature == touch.feature) return k;
    const double between = old.normal[0] * touch.normal[0] + old.normal[1] * touch.normal[1] +
                           old.normal[2] * touch.normal[2];
    if (between <= cosine) continue;
    cosine = between;
    nearest = k;
  }
  return nearest;
}

}  // namespace

TouchRange touches_of(std::span<const SurfaceTouch> touches, int mine) {
  const auto below = [](const SurfaceTouch& touch, int place) { return touch.mine < place; };
  const auto first = std::lower_bound(touches.begin(), touches.end(), mine, below);
  auto last = first;
  while (last != touches.end() && last->mine == mine) ++last;
  return {static_cast<int>(first - touches.begin()), static_cast<int>(last - touches.begin())};
}

template <class Real, bool turning>
void find_touches(const Walls& walls, const ContactLaws& laws, std::span<const int> materials,
                  std::span<const Body<Real, turning>> spheres, double beyond_contact,
                  int rows_each, SurfaceContacts<Real>& contacts) {
  std::swap(contacts.touches, contacts.former);
  std::swap(contacts.springs, contacts.former_springs);
  contacts.touches.clear();
  std::array<WallTouch, most_wall_touches> found;
  for (std::size_t k = 0; k < contacts.near.size(); ++k) {
    const int mine = contacts.near[k];
    const Body<Real, turning>& body = spheres[mine];
    const auto elements = std::span<const int>(contacts.elements)
                              .subspan(contacts.first_element[k],
                                       contacts.first_element[k + 1] - contacts.first_element[k]);
    const int count = walls.touches(Eigen::Map<const Vector3>(body.position),
                                    body.radius + beyond_contact, elements, found);
    for (int t = 0; t < std::max(count, 0); ++t) {
      const int law = laws.index(contacts.material[k], materials[found.at(t).surface]);
      contacts.touches.push_back(laid_out(found.at(t), mine, law));
    }
    if (count < 0) contacts.lost = mine;
  }
  contacts.springs.reset(static_cast<int>(contacts.touches.size()), rows_each);
  for (int touch = 0; rows_each > 0 && touch < contacts.springs.contacts; ++touch) {
    const int old = former_touch(contacts.former, contacts.touches[touch]);
    if (old < 0) continue;
    contacts.springs.carry(contacts.former_springs, old, touch);
  }
}

#define FLUXPACT_INSTANTIATE(Real, turning)                   \
  template void find_touches<Real, turning>(                  \
      const Walls&, const ContactLaws&, std::span<const int>, \
      std::span<const Body<Real, turning>>, double, int, SurfaceContacts<Real>&);
FLUXPACT_INSTANTIATE(double, false)
FLUXPACT_INSTANTIATE(double, true)
FLUXPACT_INSTANTIATE(float, false)
FLUXPACT_INSTANTIATE(float, true)
#undef FLUXPACT_INSTANTIATE

}  // namespace fluxpact
