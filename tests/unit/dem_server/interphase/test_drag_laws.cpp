// The drag laws of packed to dilute beds against values computed apart from them, and their limits.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "dem_server/interphase/drag.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr double pi = std::numbers::pi;
const FluidProperties air{1.2, 1.8e-5};

struct Law {
  const char* name = "";
  DragLaw law = DragLaw::none;
  std::function<double(const DragPoint&)> drag;
};

const std::vector<Law>& laws() {
  static const std::vector<Law> all{
      {"di_felice", DragLaw::di_felice, [](auto& p) { return di_felice_drag(p, air); }},
      {"syamlal_obrien", DragLaw::syamlal_obrien,
       [](auto& p) { return syamlal_obrien_drag(p, air, {}); }},
      {"koch_hill", DragLaw::koch_hill, [](auto& p) { return koch_hill_drag(p, air); }},
      {"beetstra", DragLaw::beetstra, [](auto& p) { return beetstra_drag(p, air); }},
      {"tang", DragLaw::tang, [](auto& p) { return tang_drag(p, air); }},
      {"schiller_naumann", DragLaw::schiller_naumann,
       [](auto& p) { return schiller_naumann_drag(p, air); }},
      {"huilin_gidaspow", DragLaw::huilin_gidaspow,
       [](auto& p) { return huilin_gidaspow_drag(p, air); }},
  };
  return all;
}

double slip_at(double reynolds, double voidage, double diameter) {
  return reynolds * air.viscosity / (voidage * air.density * diameter);
}

/// Drag over that of one sphere in creeping flow.
double over_stokes(const Law& law, double voidage, double reynolds) {
  constexpr double d = 1e-3;
  return law.drag({voidage, d, slip_at(reynolds, voidage, d)}) / (3 * pi * air.viscosity * d);
}

struct Row {
  DragPoint point;
  std::vector<double> expected;
};

TEST(DragLaws, have_the_values_of_their_papers) {
  // ζ [kg/s] in the order of laws(). Computed in Python with 40 digits (mpmath) from the formulas
  // as the papers write them: C_D ρ U²/2 π d²/4 ε^−χ over the slip (Di Felice); β V_p/(1 − ε) with
  // β = 3 (1−ε) ε ρ C_D |u−v|/(4 V_r² d) (Syamlal and O'Brien), 18 μ ε² (1−ε) (F₀ + F₃
  // Re_radius)/d² (Koch and Hill), 18 μ ε (1−ε) F/d² (Beetstra, Tang), ψ β_WenYu + (1−ψ) β_Ergun
  // (Lu and Gidaspow); C_D ρ |u−v|/2 π d²/4 (Schiller and Naumann). Re from 0.9 to 600.
  const std::vector<Row> table{
      {{0.42, 1e-3, 0.05},
       {1.8050654444953573e-6, 1.1024385952287444e-6, 2.3839022656972214e-6, 2.3728362866133479e-6,
        2.5553482386152467e-6, 2.2783657038324971e-7, 2.007260917421711e-6}},
      {{0.42, 2e-3, 4},
       {2.010636247034539e-5, 2.5082266073857271e-5, 1.7860419129837549e-5, 1.8422267430269076e-5,
        1.3956769817923117e-5, 4.1421754380463761e-6, 2.1506277464073409e-5}},
      {{0.58, 5e-4, 0.3},
       {4.6866695931764865e-7, 4.8542423641460541e-7, 6.5642196374338282e-7, 6.8463320483299259e-7,
        7.5825670608686483e-7, 1.4671078046108854e-7, 5.9402798904759073e-7}},
      {{0.7, 1e-3, 0.02},
       {5.0408769389568599e-7, 6.4881087464180275e-7, 7.9492121300907863e-7, 8.3738552524255946e-7,
        8.7956567347946913e-7, 2.0065357835053353e-7, 6.2630781273568961e-7}},
      {{0.79, 1e-3, 1},
       {1.0103611039640012e-6, 1.339706094191102e-6, 1.1074040569065641e-6, 1.2786929739963738e-6,
        1.2483416029818199e-6, 6.2532624355016545e-7, 1.4249894610056324e-6}},
      {{0.81, 1e-3, 1},
       {9.7163580544221813e-7, 1.2958269074331347e-6, 1.0708619302613927e-6, 1.2187410513725029e-6,
        1.1941489923512226e-6, 6.2532624355016545e-7, 1.037273855673523e-6}},
      {{0.9, 2e-3, 5},
       {7.4616526373181383e-6, 9.3374585861808585e-6, 1.1311873618277151e-5, 9.5617993546835405e-6,
        6.7954929528115598e-6, 4.7722150536254743e-6, 6.0988580330500876e-6}},
      {{0.97, 1e-4, 0.4},
       {2.5652130774406724e-8, 2.6810691952097976e-8, 2.7757725571554703e-8, 2.799817067273921e-8,
        3.1949701175184442e-8, 2.1956609915460187e-8, 2.3583899731459972e-8}},
  };
  // Powers by way of logarithms of up to 10 times some round-offs.
  constexpr double digits = 1e-14;
  for (const Row& row : table) {
    for (std::size_t i = 0; i < laws().size(); ++i) {
      const double expected = row.expected[i];
      EXPECT_NEAR(laws()[i].drag(row.point), expected, digits * expected)
          << laws()[i].name << " at " << row.point.voidage;
    }
  }
}

TEST(DragLaws, of_one_sphere_alone_are_those_of_one_sphere) {
  for (const double reynolds : {0.0, 0.1, 1.0, 30.0, 900.0, 5000.0}) {
    const double slip = slip_at(reynolds, 1, 1e-3);
    const DragPoint alone{1, 1e-3, slip};
    // Wen and Yu took this curve; Di Felice, and Syamlal and O'Brien that of Dallavalle.
    const double schiller_naumann = schiller_naumann_drag(alone, air);
    EXPECT_NEAR(wen_yu_drag(alone, air), schiller_naumann, 1e-14 * schiller_naumann);
    const double root = 0.63 * std::sqrt(reynolds) + 4.8;
    const double dallavalle = pi / 8 * air.viscosity * 1e-3 * root * root;
    EXPECT_NEAR(di_felice_drag(alone, air), dallavalle, 1e-14 * dallavalle);
    EXPECT_NEAR(syamlal_obrien_drag(alone, air, {}), dallavalle, 1e-13 * dallavalle);
  }
}

TEST(DragLaws, of_one_sphere_without_slip_are_stokes) {
  const DragPoint still{1, 1e-3, 0};
  const double stokes = stokes_drag(still, air);
  EXPECT_EQ(schiller_naumann_drag(still, air), stokes);
  EXPECT_NEAR(koch_hill_drag(still, air), stokes, 1e-15 * stokes);
  EXPECT_NEAR(beetstra_drag(still, air), stokes, 1e-15 * stokes);
  EXPECT_NEAR(tang_drag(still, air), stokes, 1e-15 * stokes);
  // Dallavalle's 4.8² = 23.04 in the place of 24.
  EXPECT_NEAR(di_felice_drag(still, air), 0.96 * stokes, 1e-14 * stokes);
  EXPECT_NEAR(syamlal_obrien_drag(still, air, {}), 0.96 * stokes, 1e-14 * stokes);
}

TEST(DragLaws, of_computed_arrays_meet_one_sphere_as_nearly_as_they_say) {
  // Both papers fitted dense arrays; how the fits end at one sphere is known from here alone.
  const auto ratio = [](double (*law)(const DragPoint&, const FluidProperties&), double reynolds) {
    const DragPoint alone{1, 1e-3, slip_at(reynolds, 1, 1e-3)};
    return law(alone, air) / schiller_naumann_drag(alone, air);
  };
  for (const double reynolds : {0.1, 1.0, 10.0, 100.0, 1000.0}) {
    EXPECT_NEAR(ratio(tang_drag, reynolds), 1, 0.2) << reynolds;
  }
  EXPECT_NEAR(ratio(beetstra_drag, 10), 1, 0.06);
  EXPECT_NEAR(ratio(beetstra_drag, 100), 1.16, 0.005);
  EXPECT_NEAR(ratio(beetstra_drag, 1000), 1.68, 0.005);
}

TEST(DragLaws, of_computed_arrays_in_creeping_flow_are_carman_kozeny) {
  // Pressure drop 180 μ φ² U/(ε³ d²) of a packed bed; n ζ U/ε of model A is ε dp/dz.
  constexpr double d = 1e-3;
  for (const double e : {0.4, 0.5, 0.6}) {
    const double solids = 1 - e;
    const double stokes = 3 * pi * air.viscosity * d;
    const double spheres = solids / (pi / 6 * d * d * d);
    const double carman_kozeny = 180 * air.viscosity * solids * solids / (e * e * e * d * d);
    const auto drop = [&](double drag) { return spheres * drag / (e * e); };
    // Half a unit in the last place of 0.6 decides on which side of φ = 0.4 it lies.
    if (e < 0.6) {
      EXPECT_NEAR(drop(koch_hill_drag({e, d, 0}, air)), carman_kozeny, 1e-14 * carman_kozeny);
    }
    // The arrays add ε² (1 + 1.5 √φ), which carries them to one sphere.
    const double more = e * e * (1 + 1.5 * std::sqrt(solids)) * e * stokes;
    EXPECT_NEAR(drop(beetstra_drag({e, d, 0}, air) - more), carman_kozeny, 1e-13 * carman_kozeny);
    EXPECT_NEAR(drop(tang_drag({e, d, 0}, air) - more), carman_kozeny, 1e-13 * carman_kozeny);
  }
}

TEST(DragLaws, in_creeping_flow_settle_as_richardson_and_zaki_found) {
  // A suspension in creeping flow sinks at ε^n of one sphere's speed, n 4.65 to 4.8 measured: in
  // model A ζ |u−v| = ε V_p Δρ g, so ζ_1/ζ = |u−v|/(ε u_t) with superficial ε|u−v| = u_t ε^n, hence
  // ζ/ζ_1 = ε^(2−n).
  const auto exponent = [](const Law& law, double e) {
    return 2 - std::log(over_stokes(law, e, 0) / over_stokes(law, 1, 0)) / std::log(e);
  };
  // Exactly 2 − (1 − 3.7) and 2 − (1 − 4.14) − ... : χ = 3.7 gives 4.7; V_r = A = ε^4.14 at Re 0
  // gives ζ ~ ε/V_r, 5.14.
  EXPECT_NEAR(exponent(laws()[0], 0.7), 4.7, 1e-12);
  EXPECT_NEAR(exponent(laws()[1], 0.7), 5.14, 1e-12);
}

TEST(DragLaws, are_finite_and_continuous_without_slip) {
  for (const Law& law : laws()) {
    for (const double e : {0.4, 0.6, 0.9, 0.99, 1.0}) {
      const double still = law.drag({e, 1e-3, 0});
      EXPECT_GT(still, 0) << law.name;
      // At slip 1e-12 Re is 7e-11, and Re/V_r of Syamlal and O'Brien 3e-9 at ε = 0.4: 2·0.63/4.8 of
      // its root is 1.4e-5.
      EXPECT_NEAR(law.drag({e, 1e-3, 1e-12}), still, 2e-5 * still) << law.name << e;
    }
  }
}

TEST(DragLaws, grow_with_slip_and_with_solids_over_their_range) {
  for (const Law& law : laws()) {
    const DragRange range = drag_range(law.law);
    for (double e = range.least_voidage; e < range.most_voidage - 0.01; e += 0.01) {
      double last = 0;
      for (double reynolds = 0.01; reynolds < range.most_reynolds; reynolds *= 1.3) {
        const double slip = slip_at(reynolds, e, 1e-3);
        const double force = law.drag({e, 1e-3, slip}) * slip;
        EXPECT_GT(force, last) << law.name << " e " << e << " Re " << reynolds;
        last = force;
        if (law.law == DragLaw::schiller_naumann) continue;
        if (law.law == DragLaw::tang && e > 0.8) continue;  // its fit turns there
        // 0.1 %: the step of Syamlal and O'Brien's law at 0.85.
        EXPECT_GT(1.001 * law.drag({e, 1e-3, slip}), law.drag({e + 0.01, 1e-3, slip}))
            << law.name << " e " << e << " Re " << reynolds;
      }
    }
  }
}

/// Largest step of the drag between neighbouring voidages, relative.
double largest_step(const Law& law, double reynolds, double from, double to) {
  constexpr int steps = 100000;
  double largest = 0;
  double last = over_stokes(law, from, reynolds);
  for (int i = 1; i <= steps; ++i) {
    const double now = over_stokes(law, from + i * (to - from) / steps, reynolds);
    largest = std::max(largest, std::abs(now / last - 1));
    last = now;
  }
  return largest;
}

TEST(DragLaws, step_in_voidage_only_where_they_say_so) {
  // The root of φ is steep at 1, so up to 0.99. The steepest slope otherwise, that of the blend, is
  // 0.42 · 150 · 1.75/π = 35 over voidage steps of 6e-6.
  constexpr double smooth = 3e-4;
  for (const double reynolds : {0.01, 100.0}) {
    for (const Law& law : laws()) {
      const double step = largest_step(law, reynolds, 0.4, 0.99);
      if (law.law == DragLaw::koch_hill) {
        // 10·0.4/0.6³ = 18.52 against 18.33; the part of Re does not step.
        EXPECT_NEAR(step, reynolds < 1 ? 0.0104 : 0.0047, 1e-4) << reynolds;
        EXPECT_LT(largest_step(law, reynolds, 0.4, 0.5999), smooth);
        EXPECT_LT(largest_step(law, reynolds, 0.6001, 0.99), smooth);
      } else if (law.law == DragLaw::syamlal_obrien) {
        EXPECT_LT(step, 1e-3);
      } else {
        EXPECT_LT(step, smooth) << law.name << reynolds;
      }
    }
  }
}

TEST(DragLaws, of_syamlal_and_o_brien_are_tuned_by_two_constants) {
  const DragPoint dense{0.5, 1e-3, 0.5};
  const DragPoint dilute{0.9, 1e-3, 0.5};
  const SyamlalObrienSettings published;
  const SyamlalObrienSettings looser{1.0, 2.65};
  const SyamlalObrienSettings steeper{0.8, 4};
  EXPECT_LT(syamlal_obrien_drag(dense, air, looser), syamlal_obrien_drag(dense, air, published));
  EXPECT_EQ(syamlal_obrien_drag(dilute, air, looser), syamlal_obrien_drag(dilute, air, published));
  EXPECT_EQ(syamlal_obrien_drag(dense, air, steeper), syamlal_obrien_drag(dense, air, published));
  EXPECT_GT(syamlal_obrien_drag(dilute, air, steeper), syamlal_obrien_drag(dilute, air, published));
}

TEST(DragLaws, of_all_spheres_are_those_of_each) {
  const std::vector<DragPoint> points{{0.45, 1e-3, 0.1}, {0.9, 2e-3, 0.5}, {0.99, 1e-4, 0}};
  std::vector<double> all(3);
  for (const Law& law : laws()) {
    const DragSurvey survey =
        drag_coefficients({.law = law.law}, PressureModel::a, air, points, 2, all);
    EXPECT_EQ(survey.first_bad, -1);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(all[i], law.drag(points[i])) << law.name;
    drag_coefficients({.law = law.law}, PressureModel::b, air, points, 2, all);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(all[i], law.drag(points[i]) / points[i].voidage);
  }
}

TEST(DragLaws, count_the_spheres_beyond_their_range) {
  // Koch and Hill: ε from 0.36, Re up to 200, with Re = ε · 66.7 · slip for 1 mm in air.
  const std::vector<DragPoint> points{
      {0.35, 1e-3, 0.1}, {0.5, 1e-3, 0.1}, {0.5, 1e-3, 5.9}, {0.5, 1e-3, 6.1}, {1, 1e-3, 0}};
  std::vector<double> all(points.size());
  for (const int threads : {1, 2}) {
    EXPECT_EQ(
        drag_coefficients({.law = DragLaw::koch_hill}, PressureModel::a, air, points, threads, all)
            .outside,
        2);
    EXPECT_EQ(drag_coefficients({.law = DragLaw::none}, PressureModel::a, air, points, threads, all)
                  .outside,
              0);
  }
}

TEST(DragLaws, say_which_coefficient_cannot_be_one) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<DragPoint> points{{0.5, 1e-3, 1}, {0.5, 1e-3, 2}, {0.5, 1e-3, nan}};
  std::vector<double> all(points.size());
  EXPECT_EQ(drag_coefficients({.law = DragLaw::gidaspow}, PressureModel::a, air, points, 2, all)
                .first_bad,
            2);
  // Far beyond its range Tang's law pushes against the slip.
  const std::vector<DragPoint> fast{{1, 1e-3, 1}, {1, 1e-3, 1e4}, {1, 1e-3, 2e4}};
  EXPECT_EQ(
      drag_coefficients({.law = DragLaw::tang}, PressureModel::a, air, fast, 2, all).first_bad, 1);
}

TEST(DragLaws, of_the_user_are_those_of_each_sphere_for_any_number_of_them) {
  InterphaseSettings interphase;
  interphase.drag = DragLaw::expression;
  interphase.drag_expression.coefficient =
      "3*pi*viscosity*diameter * (1 + 0.15*reynolds^0.687) * voidage^-2.65";
  const DragChoice own = drag_choice(interphase);
  for (const int count : {0, 1, 63, 64, 65, 200}) {  // blocks of 64
    std::vector<DragPoint> points;
    for (int i = 0; i < count; ++i) points.push_back({0.4 + 0.003 * i, 1e-3, 0.05 * i});
    std::vector<double> all(points.size());
    for (const int threads : {1, 2}) {
      const DragSurvey survey = drag_coefficients(own, PressureModel::a, air, points, threads, all);
      EXPECT_EQ(survey.first_bad, -1);
      EXPECT_EQ(survey.outside, 0);
      for (int i = 0; i < count; ++i) {
        const double expected = wen_yu_drag(points[i], air);
        EXPECT_NEAR(all[i], expected, 1e-14 * expected) << i << " of " << count;
      }
    }
  }
}

TEST(DragLaws, of_the_user_say_where_they_turn_negative) {
  InterphaseSettings interphase;
  interphase.drag = DragLaw::expression;
  interphase.drag_expression.coefficient = "viscosity*diameter*(1 - slip/limit)";
  interphase.drag_expression.constants["limit"].value = 100;
  interphase.drag_expression.constants["limit"].unit = "m/s";
  const DragChoice own = drag_choice(interphase);
  std::vector<DragPoint> points(200, {0.5, 1e-3, 99});
  points[130].slip = 101;
  points[70].slip = 102;
  std::vector<double> all(points.size());
  for (const int threads : {1, 2}) {
    const int bad = drag_coefficients(own, PressureModel::b, air, points, threads, all).first_bad;
    ASSERT_EQ(bad, 70);
    try {
      throw_bad_drag(own.law, "particle 7", points[bad], all[bad]);
    } catch (const NumericsError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("drag coefficient of particle 7 is -"), std::string::npos) << text;
      EXPECT_NE(text.find("slip 102 m/s"), std::string::npos) << text;
    }
  }
}

}  // namespace
}  // namespace fluxpact
