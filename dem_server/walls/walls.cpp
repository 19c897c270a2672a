#include "dem_server/walls/walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dem_server/walls/sheet.hpp"
#include "dem_server/walls/touch_sieve.hpp"

namespace fluxpact {
namespace {

/// The side of a sheet on which a particle is held, in the two lowest bits of an element number.
/// none: at a rim.
enum class Held { none = 0, front = 1, back = 2 };

int coded(int element, Held side) { return 4 * element + static_cast<int>(side); }
int element_of(int code) { return code >> 2; }
Held side_of(int code) { return static_cast<Held>(code & 3); }
double sign_of(Held side) { return side == Held::back ? -1.0 : 1.0; }

/// The nearest of the facets with these element numbers, the first facet having the number `shift`.
NearestFacet nearest_facet(const Facets& facets, std::span<const int> codes, int shift,
                           const Vector3& x) {
  NearestFacet nearest;
  for (const int code : codes) consider(facets.facets[element_of(code) - shift], x, nearest);
  return nearest;
}

Held side_of_sign(double sign) {
  if (sign == 0) return Held::none;
  return sign > 0 ? Held::front : Held::back;
}

}  // namespace

// ---- where it is --------------------------------------------------------------------------------

void Walls::place(double time) {
  time_ = time;
  if (!moving_) return;
  for (WallSurface& surface : surfaces_) surface.pose = pose_at(surface.motion, time);
}

double Walls::travelled(double since, double reach) const {
  double farthest = 0;
  for (const WallSurface& surface : surfaces_) {
    const bool turns = surface.motion.type == MotionType::rotation && surface.arm > 0;
    const double arm = turns ? std::min(arm_in_domain(surface), surface.arm + reach) : 0;
    farthest = std::max(farthest, displacement(surface.motion, since, time_, arm));
  }
  return farthest;
}

/// Distance [m] of the farthest place in the domain from the axis of a rotation.
double Walls::arm_in_domain(const WallSurface& surface) const {
  const Vector3 axis = surface.motion.direction.normalized();
  double arm = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vector3 at;
    for (int a = 0; a < 3; ++a) at[a] = (corner >> a & 1) == 0 ? lower_[a] : upper_[a];
    arm = std::max(arm, (at - surface.motion.point).cross(axis).norm());
  }
  return arm;
}

double Walls::fastest(int surface) const {
  const MotionSettings& motion = surfaces_[surface].motion;
  // A wall that turns in itself has an arm of 0, and yet its skin moves.
  const double arm = motion.type == MotionType::rotation ? arm_in_domain(surfaces_[surface]) : 0;
  return largest_speed(motion, arm);
}

int Walls::surface_of(int element) const {
  const int number = element_of(element);
  const int shift = primitives();
  if (number < shift) return surface_of_primitive_[number];
  return facets_.shells[facets_.facets[number - shift].shell].surface;
}

// ---- what is near -------------------------------------------------------------------------------

namespace {

/// What the list before says of a sheet, and whether the centre has passed through it since.
Held held_before(std::span<const int> before, int first_code, int last_code) {
  for (const int code : before) {
    if (code >= first_code && code < last_code && side_of(code) != Held::none) return side_of(code);
  }
  return Held::none;
}

/// Sort the facets found of one surface by sheet, few as they are, and note the sides.
class SheetSides {
 public:
  SheetSides(const Facets& facets, int shift, std::span<const int> before, const Vector3& x)
      : facets_(facets), shift_(shift), before_(before), x_(x) {}

  void note(std::span<int> codes) const {
    std::sort(codes.begin(), codes.end(), [this](int a, int b) {
      const int shell_a = shell_of(a);
      const int shell_b = shell_of(b);
      return shell_a < shell_b || (shell_a == shell_b && a < b);
    });
    for (std::size_t first = 0; first < codes.size();) {
      std::size_t last = first;
      while (last < codes.size() && shell_of(codes[last]) == shell_of(codes[first])) ++last;
      note_sheet(codes.subspan(first, last - first));
      first = last;
    }
  }

  /// True if a sheet of the list before is not in `codes`, and the centre is behind what was near.
  bool lost(std::span<const int> codes, int first_element, int last_element) const {
    for (const int code : before_) {
      const int element = element_of(code);
      if (element < first_element || element >= last_element || side_of(code) == Held::none) {
        continue;
      }
      const int shell = shell_of(code);
      const auto same = [&](int other) { return shell_of(other) == shell; };
      if (std::any_of(codes.begin(), codes.end(), same)) continue;
      NearestFacet nearest;
      for (const int old : before_) {
        const int number = element_of(old);
        if (number < first_element || number >= last_element || shell_of(old) != shell) continue;
        consider(facets_.facets[number - shift_], x_, nearest);
      }
      if (!at_rim(facets_, nearest) && sign_of(side_of(code)) * height(facets_, nearest, x_) < 0) {
        return true;
      }
    }
    return false;
  }

 private:
  int shell_of(int code) const { return facets_.facets[element_of(code) - shift_].shell; }

  void note_sheet(std::span<int> codes) const {
    const NearestFacet nearest = nearest_facet(facets_, codes, shift_, x_);
    Held side = Held::none;
    if (!at_rim(facets_, nearest)) {
      side = side_of_sign(height(facets_, nearest, x_));
      for (const int code : before_) {
        const int number = element_of(code) - shift_;
        if (number < 0 || number >= static_cast<int>(facets_.facets.size())) continue;
        if (facets_.facets[number].shell != nearest.facet->shell) continue;
        if (side_of(code) != Held::none) side = side_of(code);
        break;
      }
    }
    for (int& code : codes) code = coded(element_of(code), side);
  }

  const Facets& facets_;
  int shift_;
  std::span<const int> before_;
  const Vector3& x_;
};

/// The side of a tube. False if the centre has passed through it and beyond the reach.
bool note_tube(const WallSurface& surface, const Vector3& x, double reach,
               std::span<const int> before, std::vector<int>& elements) {
  const int first = coded(surface.first_element, Held::none);
  const TubePoint nearest = nearest_on(surface.tube, x);
  const double distance = (x - nearest.point).norm();
  const Held old = held_before(before, first, first + 4);
  if (distance > reach) {
    return nearest.part != TubePart::shell || old == Held::none ||
           sign_of(old) * nearest.outside > 0;
  }
  Held side = Held::none;
  if (nearest.part == TubePart::shell) {
    side = old == Held::none ? side_of_sign(nearest.outside) : old;
  }
  elements.push_back(coded(surface.first_element, side));
  return true;
}

}  // namespace

bool Walls::nearby(const Vector3& position, double reach, std::span<const int> before,
                   std::vector<int>& elements) const {
  const int shift = primitives();
  bool held = true;
  for (const WallSurface& surface : surfaces_) {
    const Vector3 x = surface.pose.to_body(position);
    if (surface.type == SurfaceType::plane) {
      if (surface.normal.dot(x - surface.point) <= reach) {
        elements.push_back(coded(surface.first_element, Held::front));
      }
    } else if (surface.type != SurfaceType::stl) {
      held = note_tube(surface, x, reach, before, elements) && held;
    } else {
      const std::size_t start = elements.size();
      double square = reach * reach;
      surface.tree.visit(x, square, [&](int index) {
        const int element = surface.first_element + index;
        const FacetPoint nearest = nearest_on(facets_.facets[element - shift], x);
        if ((x - nearest.point).squaredNorm() > square) return;
        elements.push_back(coded(element, Held::none));
      });
      const std::span<int> found(elements.data() + start, elements.size() - start);
      const SheetSides sides(facets_, shift, before, x);
      sides.note(found);
      held = held &&
             !sides.lost(found, surface.first_element, surface.first_element + surface.elements);
    }
  }
  return held;
}

// ---- what touches -------------------------------------------------------------------------------

namespace {

/// Unit vector from a point of a wall to a centre; `otherwise` if the two are in one place.
Vector3 direction_between(const Vector3& from, const Vector3& to, double distance, double radius,
                          const Vector3& otherwise) {
  if (distance > 1e-12 * radius) return (to - from) / distance;
  return otherwise.normalized();
}

void touch_tube(const WallSurface& surface, int code, const Vector3& x, double radius,
                TouchSieve& sieve) {
  const TubePoint nearest = nearest_on(surface.tube, x);
  const Held side = side_of(code);
  if (nearest.part == TubePart::shell && side != Held::none) {
    const double distance = sign_of(side) * nearest.outside;
    if (distance >= radius) return;
    sieve.add({sign_of(side) * nearest.outward, distance, nullptr, surface.feature, true, 0});
    return;
  }
  const double distance = (x - nearest.point).norm();
  if (distance >= radius) return;
  const Vector3 normal = direction_between(nearest.point, x, distance, radius, nearest.outward);
  sieve.add(
      {normal, distance, nullptr, surface.feature + static_cast<int>(nearest.part), false, 0});
}

/// True if no other facet of the sheet is nearer to x than this joint.
bool is_nearest(const Facets& facets, const FacetJoint& joint, const Vector3& from_joint,
                double radius) {
  // Rounding must not let a facet leave the touch to its neighbour, and that one to the facet: two
  // touches of one direction are one in the end.
  const double tolerance = 1e-9 * radius;
  for (int k = joint.first; k < joint.first + joint.count; ++k) {
    if (from_joint.dot(facets.away[k]) > tolerance) return false;
  }
  return true;
}

void touch_facet(const Facets& facets, const WallFacet& facet, Held side, const Vector3& x,
                 double radius, TouchSieve& sieve) {
  const FacetPoint nearest = nearest_on(facet, x);
  if (nearest.part == FacetPart::face) {
    const double above = facet.normal.dot(x - facet.corner);
    const double sign = side == Held::none ? (above < 0 ? -1.0 : 1.0) : sign_of(side);
    const double distance = sign * above;
    // Behind this facet but before the sheet, whose nearest point is elsewhere: no touch.
    if (distance < 0 || distance >= radius) return;
    sieve.add({sign * facet.normal, distance, nullptr, facet.feature, true, 0});
    return;
  }
  const FacetJoint& joint = joint_of(facets, facet, nearest);
  const Vector3 from_joint = x - nearest.point;
  const double distance = from_joint.norm();
  if (distance >= radius || !is_nearest(facets, joint, from_joint, radius)) return;
  const bool flat = joint.feature == facet.feature;
  sieve.add({direction_between(nearest.point, x, distance, radius, sign_of(side) * facet.normal),
             distance, &joint, joint.feature, flat, 0});
}

void touch_sheet(const Facets& facets, std::span<const int> codes, int shift, const Vector3& x,
                 double radius, TouchSieve& sieve) {
  const NearestFacet nearest = nearest_facet(facets, codes, shift, x);
  const Held side = side_of(codes.front());
  const bool behind = side != Held::none && !at_rim(facets, nearest) &&
                      sign_of(side) * height(facets, nearest, x) < 0;
  if (behind) {
    const Vector3 front = sign_of(side) * sheet_normal(facets, nearest);
    const double depth = std::sqrt(nearest.square);
    const Vector3 normal = direction_between(x, nearest.point.point, depth, radius, front);
    const FacetJoint* joint = joint_at(facets, nearest);
    sieve.add({normal, -depth, joint, joint == nullptr ? nearest.facet->feature : joint->feature,
               joint == nullptr, 0});
    return;
  }
  if (nearest.square >= radius * radius) return;
  for (const int code : codes) {
    touch_facet(facets, facets.facets[element_of(code) - shift], side, x, radius, sieve);
  }
}

}  // namespace

int Walls::touches(const Vector3& position, double radius, std::span<const int> elements,
                   std::span<WallTouch> out) const {
  const int shift = primitives();
  TouchSieve sieve(facets_);
  for (std::size_t first = 0; first < elements.size();) {
    const int index = surface_of(elements[first]);
    const WallSurface& surface = surfaces_[index];
    const Vector3 x = surface.pose.to_body(position);
    std::size_t last = first + 1;
    sieve.begin(index);
    if (surface.type == SurfaceType::plane) {
      const double distance = surface.normal.dot(x - surface.point);
      if (distance < radius)
        sieve.add({surface.normal, distance, nullptr, surface.feature, true, 0});
    } else if (surface.type != SurfaceType::stl) {
      touch_tube(surface, elements[first], x, radius, sieve);
    } else {
      const int shell = facets_.facets[element_of(elements[first]) - shift].shell;
      while (last < elements.size() && element_of(elements[last]) >= shift &&
             facets_.facets[element_of(elements[last]) - shift].shell == shell) {
        ++last;
      }
      touch_sheet(facets_, elements.subspan(first, last - first), shift, x, radius, sieve);
    }
    sieve.end(surface.pose);
    first = last;
  }
  const int count = sieve.write(out);
  for (int k = 0; k < count; ++k) {
    WallTouch& touch = out[static_cast<std::size_t>(k)];
    const Vector3 place = position - touch.distance * touch.normal;
    touch.velocity = surfaces_[touch.surface].pose.velocity_at(place);
  }
  return count;
}

}  // namespace fluxpact
