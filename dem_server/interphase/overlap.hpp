// How much of a ball lies in a polyhedron, in closed form: what the exact voidage map is made of.
//
// By the divergence theorem, a polyhedron is the signed sum of the cones that its oriented faces
// make with the centre of the ball; a cone cut by the ball is a plane cone over the part of the
// face inside the ball, and a piece of the ball itself behind the rest. Both are sums over the
// edges. Exact sphere-polyhedron volumes for this purpose: Strobl, Formella and Poeschel, J.
// Comput. Phys. 311 (2016) 158-172.
#pragma once

#include <span>

#include "proto/base/vector.hpp"

namespace fluxpact {

struct Ball {
  Vector3 centre{0, 0, 0};  ///< [m]
  double radius = 0;        ///< [m]
};

/// A plane polygon, right-handed about its unit normal.
struct Facet {
  std::span<const Vector3> loop;  ///< [m] corners, not repeated; need not be convex
  Vector3 normal{0, 0, 0};        ///< [-]
};

/// 4/3 π R³ [m³].
double ball_volume(double radius);

/// Ball cut by one plane at signed distance h of its centre: the part below the plane,
/// π/3 (R + h)² (2R − h) [m³], for |h| <= R.
double cut_ball_volume(double radius, double height);

/// Ball cut by two planes at right angles, at distances a, b >= 0 of its centre: the part beyond
/// both [m³], 0 if there is none. Rounding error of some 1e-16 R³, as of `beyond_corner`. By the
/// theorem of Gauss and Bonnet for the spherical part of its surface.
double beyond_edge(double radius, double a, double b);

/// The same for three planes at right angles, at distances >= 0.
double beyond_corner(double radius, const Vector3& distances);

/// Volume [m³] that the ball shares with the cone from its centre to the facet; negative if the
/// facet shows its back to the centre. Rounding error of the order of 1e-16 R³, wherever the centre
/// stands: in the facet's plane, on an edge, on a corner.
double signed_cone_overlap(const Ball& ball, const Facet& facet);

/// Volume [m³] of ball ∩ polyhedron, given by all its facets with outward normals. Convexity is not
/// needed. The result has an error of some 1e-16 R³, so it may be negative by as much where they
/// do not touch.
double polyhedron_overlap(const Ball& ball, std::span<const Facet> facets);

/// The same for an axis-aligned box [m]; exactly 0 if a side separates the two.
double box_overlap(const Ball& ball, const Vector3& lower, const Vector3& upper);

}  // namespace fluxpact
