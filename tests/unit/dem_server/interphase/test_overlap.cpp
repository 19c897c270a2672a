#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "dem_server/interphase/overlap.hpp"

namespace fluxpact {
namespace {

constexpr double pi = std::numbers::pi;

/// Facets with their corners, of a box or of a tetrahedron.
struct Solid {
  std::vector<std::vector<Vector3>> loops;
  std::vector<Facet> facets() const {
    std::vector<Facet> all;
    for (const auto& loop : loops) {
      const Vector3 normal = (loop[1] - loop[0]).cross(loop[2] - loop[1]).normalized();
      all.push_back({loop, normal});
    }
    return all;
  }
};

Solid make_tetrahedron(const std::array<Vector3, 4>& p) {
  return {{{p[0], p[2], p[1]}, {p[0], p[1], p[3]}, {p[1], p[2], p[3]}, {p[2], p[0], p[3]}}};
}

Solid make_hexahedron(const Vector3& lower, const Vector3& upper) {
  std::array<Vector3, 8> p;
  for (int i = 0; i < 8; ++i) {
    for (int a = 0; a < 3; ++a) p[i][a] = (i >> a & 1) != 0 ? upper[a] : lower[a];
  }
  return {{{p[0], p[2], p[3], p[1]},
           {p[4], p[5], p[7], p[6]},
           {p[0], p[1], p[5], p[4]},
           {p[2], p[6], p[7], p[3]},
           {p[0], p[4], p[6], p[2]},
           {p[1], p[3], p[7], p[5]}}};
}

/// Box overlap by Gauss-Legendre over z of the exact area of disk ∩ rectangle, itself by
/// Gauss-Legendre over y with the integrand's kinks as interval ends: independent of any solid
/// angle.
class Quadrature {
 public:
  Quadrature() {
    constexpr int n = 64;
    for (int i = 0; i < n; ++i) {  // Newton on the Legendre polynomial
      double x = std::cos(pi * (i + 0.75) / (n + 0.5));
      double slope = 1;
      for (int it = 0; it < 100; ++it) {
        double p0 = 1;
        double p1 = x;
        for (int k = 2; k <= n; ++k)
          p0 = std::exchange(p1, ((2 * k - 1) * x * p1 - (k - 1) * p0) / k);
        slope = n * (x * p1 - p0) / (x * x - 1);
        x -= p1 / slope;
      }
      nodes_.push_back({x, 2 / ((1 - x * x) * slope * slope)});
    }
  }

  template <class F>
  double integrate(std::vector<double> breaks, const F& f) const {
    std::ranges::sort(breaks);
    double sum = 0;
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
      const double a = breaks[i];
      const double b = breaks[i + 1];
      if (!(b > a)) continue;
      // x = middle + half sin(π s/2): smooths the square roots at both ends.
      for (const auto& [s, w] : nodes_) {
        const double x = 0.5 * (a + b) + 0.5 * (b - a) * std::sin(pi / 2 * s);
        sum += w * 0.25 * pi * (b - a) * std::cos(pi / 2 * s) * f(x);
      }
    }
    return sum;
  }

  double box(const Ball& ball, const Vector3& lower, const Vector3& upper) const {
    const Vector3 a = lower - ball.centre;
    const Vector3 b = upper - ball.centre;
    const double r2 = ball.radius * ball.radius;
    const auto clip = [](double lo, double hi, std::vector<double> v) {
      for (double& x : v) x = std::clamp(x, lo, hi);
      v.push_back(lo);
      v.push_back(hi);
      return v;
    };
    const double z0 = std::max(a.z(), -ball.radius);
    const double z1 = std::min(b.z(), ball.radius);
    if (z1 <= z0) return 0;
    std::vector<double> z_breaks;
    for (const double x : {a.x(), b.x(), 0.0}) {
      for (const double y : {a.y(), b.y(), 0.0}) {
        const double root = std::sqrt(std::max(0.0, r2 - x * x - y * y));
        z_breaks.insert(z_breaks.end(), {root, -root});
      }
    }
    return integrate(clip(z0, z1, z_breaks), [&](double z) {
      const double disk2 = r2 - z * z;
      const double disk = std::sqrt(disk2);
      const double y0 = std::max(a.y(), -disk);
      const double y1 = std::min(b.y(), disk);
      if (y1 <= y0) return 0.0;
      std::vector<double> y_breaks;
      for (const double x : {a.x(), b.x()}) {
        const double root = std::sqrt(std::max(0.0, disk2 - x * x));
        y_breaks.insert(y_breaks.end(), {root, -root});
      }
      return integrate(clip(y0, y1, y_breaks), [&](double y) {
        const double half = std::sqrt(std::max(0.0, disk2 - y * y));
        return std::max(0.0, std::min(b.x(), half) - std::max(a.x(), -half));
      });
    });
  }

 private:
  std::vector<std::pair<double, double>> nodes_;
};

// Error of the closed form: each of 24 edges adds a few roundings of a term of the order of R³.
constexpr double rounding = 2e-14;

TEST(Overlap, is_exact_for_a_cap) {
  const Solid box = make_hexahedron({-5, -5, 0}, {5, 5, 5});
  for (const double h : {-0.999, -0.5, -1e-9, 0.0, 1e-12, 0.3, 0.7, 1.0}) {
    // Cap of height c = 1 + h: π c² (3 − c)/3.
    const double c = 1 + h;
    const double expected = pi * c * c * (3 - c) / 3;
    const Ball ball{{0.1, 0.2, h}, 1};
    EXPECT_NEAR(polyhedron_overlap(ball, box.facets()), expected, rounding) << h;
    EXPECT_NEAR(box_overlap(ball, {-5, -5, 0}, {5, 5, 5}), expected, rounding) << h;
  }
}

TEST(Overlap, is_the_ball_inside_and_nothing_outside) {
  const Solid box = make_hexahedron({0, 0, 0}, {3, 3, 3});
  EXPECT_NEAR(polyhedron_overlap({{1.5, 1.4, 1.3}, 1}, box.facets()), 4 * pi / 3, rounding);
  EXPECT_NEAR(polyhedron_overlap({{1, 1, 1}, 1}, box.facets()), 4 * pi / 3, rounding);  // touching
  EXPECT_NEAR(polyhedron_overlap({{5, 5, 5}, 1}, box.facets()), 0, rounding);
  EXPECT_NEAR(polyhedron_overlap({{4, 1.5, 1.5}, 1}, box.facets()), 0, rounding);
  EXPECT_EQ(box_overlap({{4.5, 1.5, 1.5}, 1}, {0, 0, 0}, {3, 3, 3}), 0);
}

TEST(Overlap, is_the_polyhedron_in_a_ball_that_swallows_it) {
  const Solid box = make_hexahedron({0, 0, 0}, {0.2, 0.3, 0.4});
  EXPECT_NEAR(polyhedron_overlap({{0.1, 0.1, 0.5}, 1}, box.facets()), 0.024, rounding);
  const Solid tetrahedron = make_tetrahedron({Vector3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  EXPECT_NEAR(polyhedron_overlap({{0.7, 0.1, 0.2}, 3}, tetrahedron.facets()), 1.0 / 6,
              27 * rounding);
}

TEST(Overlap, is_the_right_share_with_the_centre_on_a_face_an_edge_or_a_corner) {
  const Vector3 lower{0, 0, 0};
  const Vector3 upper{3, 3, 3};
  const Solid box = make_hexahedron(lower, upper);
  const double ball = 4 * pi / 3;
  const std::array<std::pair<Vector3, double>, 3> cases{
      {{{0, 1.5, 1.5}, ball / 2}, {{0, 0, 1.5}, ball / 4}, {{0, 0, 0}, ball / 8}}};
  for (const auto& [centre, expected] : cases) {
    // Displaced by d it changes by less than π R² d for each plane.
    for (const double d : {0.0, 1e-300, 1e-17, 1e-16, 1e-12, -1e-17, -1e-16}) {
      const Ball moved{centre + Vector3::Constant(d), 1};
      EXPECT_NEAR(polyhedron_overlap(moved, box.facets()), expected, rounding + 10 * std::abs(d));
      EXPECT_NEAR(box_overlap(moved, lower, upper), expected, rounding + 10 * std::abs(d));
    }
  }
}

TEST(Overlap, agrees_with_quadrature_for_wedges_and_corners) {
  const Quadrature quadrature;
  const Vector3 lower{0, 0, 0};
  const Vector3 upper{1, 0.8, 1.3};
  const Solid box = make_hexahedron(lower, upper);
  std::mt19937_64 random(20240607);
  std::uniform_real_distribution<double> place(-0.5, 1.6);
  std::uniform_real_distribution<double> size(0.1, 1.2);
  for (int trial = 0; trial < 40; ++trial) {
    const Ball ball{{place(random), place(random), place(random)}, size(random)};
    const double expected = quadrature.box(ball, lower, upper);
    // 64 Gauss points a piece leave 1e-11 where a break of the inner integral is nearly reached.
    EXPECT_NEAR(polyhedron_overlap(ball, box.facets()), expected, 1e-10) << "trial " << trial;
    EXPECT_NEAR(box_overlap(ball, lower, upper), expected, 1e-10) << "trial " << trial;
  }
}

TEST(Overlap, of_the_eight_cells_of_a_cube_adds_up_to_the_ball) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(-0.4, 0.4);
  for (const double radius : {1e-3, 0.05, 0.3, 0.6}) {
    for (int trial = 0; trial < 200; ++trial) {
      const Vector3 centre(place(random), place(random), place(random));
      double sum = 0;
      for (int i = 0; i < 8; ++i) {
        const Vector3 low((i & 1) - 1, (i >> 1 & 1) - 1, (i >> 2) - 1);
        sum += box_overlap({centre, radius}, low, low + Vector3::Ones());
      }
      // Coordinates of size 1 are rounded to 1e-16: that moves a cut by 1e-16/R of the radius.
      const double tolerance = (rounding + 1e-15 / radius) * radius * radius * radius;
      EXPECT_NEAR(sum, ball_volume(radius), tolerance) << "radius " << radius;
    }
  }
}

TEST(Overlap, of_the_cells_under_a_ball_larger_than_them_adds_up_to_the_ball) {
  const Ball ball{{0.13, -0.21, 0.37}, 2.3};  // five cells across
  double sum = 0;
  int swallowed = 0;
  for (int i = -3; i < 3; ++i) {
    for (int j = -3; j < 3; ++j) {
      for (int k = -3; k < 3; ++k) {
        const double part = box_overlap(ball, Vector3(i, j, k), Vector3(i + 1, j + 1, k + 1));
        swallowed += std::abs(part - 1) < 1e-12 ? 1 : 0;
        sum += part;
      }
    }
  }
  EXPECT_GT(swallowed, 10);
  EXPECT_NEAR(sum, ball_volume(2.3), 216 * 1e-15 * ball_volume(2.3));  // one rounding a cell
}

TEST(Overlap, of_tetrahedra_that_fill_a_cube_adds_up_to_that_of_the_cube) {
  // Kuhn's six tetrahedra about the diagonal: oblique faces, edges and corners.
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> place(-0.2, 1.2);
  std::array<int, 3> axes{0, 1, 2};
  std::vector<Solid> parts;
  do {
    std::array<Vector3, 4> p;
    p[0] = Vector3::Zero();
    for (int i = 0; i < 3; ++i) p[i + 1] = p[i] + Vector3::Unit(axes[i]);
    if ((p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) < 0) std::swap(p[1], p[2]);
    parts.push_back(make_tetrahedron(p));
  } while (std::ranges::next_permutation(axes).found);
  ASSERT_EQ(parts.size(), 6);
  for (int trial = 0; trial < 300; ++trial) {
    Ball ball{{place(random), place(random), place(random)}, 0.1 + 0.4 * (trial % 3)};
    if (trial % 5 == 0) ball.centre = Vector3::Constant(ball.centre.x());  // on the shared diagonal
    double sum = 0;
    for (const Solid& part : parts) sum += polyhedron_overlap(ball, part.facets());
    EXPECT_NEAR(sum, box_overlap(ball, {0, 0, 0}, {1, 1, 1}), 6 * rounding) << "trial " << trial;
  }
}

TEST(Overlap, counts_a_polyhedron_that_is_not_convex) {
  // An L of three unit cubes, with its two plane L-shaped ends; the centre stands in the notch.
  Solid ell;
  const std::vector<Vector3> base{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  std::vector<Vector3> top;
  top.reserve(base.size());
  for (const Vector3& p : base) top.push_back(p + Vector3(0, 0, 1));
  ell.loops.push_back(top);
  ell.loops.emplace_back(base.rbegin(), base.rend());
  for (std::size_t i = 0; i < base.size(); ++i) {
    const std::size_t j = (i + 1) % base.size();
    ell.loops.push_back({base[i], base[j], top[j], top[i]});
  }
  std::vector<Facet> facets = ell.facets();
  facets[0].normal = Vector3::UnitZ();  // the first corners of an L need not show its side
  facets[1].normal = -Vector3::UnitZ();
  for (const Vector3& centre : {Vector3(1.2, 1.3, 0.4), Vector3(0.8, 0.9, 0.5), Vector3(1, 1, 1)}) {
    const Ball ball{centre, 0.9};
    double expected = 0;
    for (const Vector3& low : {Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0)}) {
      expected += box_overlap(ball, low, low + Vector3::Ones());
    }
    EXPECT_NEAR(polyhedron_overlap(ball, facets), expected, rounding);
  }
}

}  // namespace
}  // namespace fluxpact
