#include "dem_server/interphase/drag.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "dem_server/interphase/overlap.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

constexpr double three_pi = 3 * std::numbers::pi;

/// ρ ε|u−v| d/μ.
double superficial_reynolds(const DragPoint& point, const FluidProperties& fluid) {
  return point.voidage * fluid.density * point.slip * point.diameter / fluid.viscosity;
}

/// Drag of one sphere over that of Stokes, C_D Re/24. The slip cancels against that in C_D, so it
/// is finite without slip. Schiller and Naumann.
double over_stokes(double reynolds) {
  return reynolds < 1000 ? 1 + 0.15 * std::pow(reynolds, 0.687) : 0.44 / 24 * reynolds;
}

/// F of the arrays in creeping flow: van der Hoef, Beetstra and Kuipers, J. Fluid Mech. 528 (2005)
/// 233-254.
double creeping_array(double e, double solids) {
  return 10 * solids / (e * e) + e * e * (1 + 1.5 * std::sqrt(solids));
}

}  // namespace

double ergun_drag(const DragPoint& point, const FluidProperties& fluid) {
  const double e = point.voidage;
  const double d = point.diameter;
  const double viscous = 150 * (1 - e) * fluid.viscosity / (e * d * d);
  const double inertial = 1.75 * fluid.density * point.slip / d;
  return ball_volume(d / 2) * (viscous + inertial);
}

double wen_yu_drag(const DragPoint& point, const FluidProperties& fluid) {
  return three_pi * fluid.viscosity * point.diameter *
         over_stokes(superficial_reynolds(point, fluid)) * std::pow(point.voidage, -2.65);
}

double gidaspow_drag(const DragPoint& point, const FluidProperties& fluid) {
  return point.voidage < 0.8 ? ergun_drag(point, fluid) : wen_yu_drag(point, fluid);
}

double huilin_gidaspow_drag(const DragPoint& point, const FluidProperties& fluid) {
  const double dilute = 0.5 + std::atan(150 * 1.75 * (point.voidage - 0.8)) * std::numbers::inv_pi;
  return dilute * wen_yu_drag(point, fluid) + (1 - dilute) * ergun_drag(point, fluid);
}

double stokes_drag(const DragPoint& point, const FluidProperties& fluid) {
  return three_pi * fluid.viscosity * point.diameter;
}

double schiller_naumann_drag(const DragPoint& point, const FluidProperties& fluid) {
  const double reynolds = fluid.density * point.slip * point.diameter / fluid.viscosity;
  return three_pi * fluid.viscosity * point.diameter * over_stokes(reynolds);
}

// C_D Re = (0.63 √Re + 4.8)²; without slip log10 Re is −∞, and χ = 3.7.
double di_felice_drag(const DragPoint& point, const FluidProperties& fluid) {
  const double reynolds = superficial_reynolds(point, fluid);
  const double root = 0.63 * std::sqrt(reynolds) + 4.8;
  const double off = 1.5 - std::log10(reynolds);
  const double chi = 3.7 - 0.65 * std::exp(-0.5 * off * off);
  return std::numbers::pi / 8 * fluid.viscosity * point.diameter * root * root *
         std::pow(point.voidage, 1 - chi);
}

// C_D Re/V_r = (0.63 √(Re/V_r) + 4.8)².
double syamlal_obrien_drag(const DragPoint& point, const FluidProperties& fluid,
                           const SyamlalObrienSettings& constants) {
  const double e = point.voidage;
  const double reynolds = fluid.density * point.slip * point.diameter / fluid.viscosity;
  const double logarithm = std::log(e);
  const double a = std::exp(4.14 * logarithm);
  const double b = e <= 0.85 ? constants.dense_factor * std::exp(1.28 * logarithm)
                             : std::exp(constants.dilute_exponent * logarithm);
  const double s = 0.06 * reynolds;
  const double ratio = 0.5 * (a - s + std::sqrt((s - a) * (s - a) + 4 * s * b));
  const double root = 0.63 * std::sqrt(reynolds / ratio) + 4.8;
  return std::numbers::pi / 8 * fluid.viscosity * point.diameter * e * root * root / ratio;
}

double koch_hill_drag(const DragPoint& point, const FluidProperties& fluid) {
  const double e = point.voidage;
  const double solids = 1 - e;
  double creeping = 1;  // φ ln φ is 0 for φ = 0, but not as a product of doubles
  if (solids >= 0.4) {
    creeping = 10 * solids / (e * e * e);
  } else if (solids > 0) {
    creeping =
        (1 + 3 * std::sqrt(solids / 2) + 135.0 / 64 * solids * std::log(solids) + 16.14 * solids) /
        (1 + solids * (0.681 + solids * (-8.48 + 8.16 * solids)));
  }
  const double inertial = 0.0673 + 0.212 * solids + 0.0232 / (e * e * e * e * e);
  return three_pi * fluid.viscosity * point.diameter * e * e *
         (creeping + 0.5 * inertial * superficial_reynolds(point, fluid));
}

// Without slip ln Re is −∞: the powers of Re are 0, the denominator of the inertial part is ∞.
double beetstra_drag(const DragPoint& point, const FluidProperties& fluid) {
  const double e = point.voidage;
  const double solids = 1 - e;
  const double reynolds = superficial_reynolds(point, fluid);
  const double logarithm = std::log(reynolds);
  const double above = reynolds * (1 / e + 3 * e * solids) + 8.4 * std::exp(0.657 * logarithm);
  const double below =
      1 + std::exp(3 * std::numbers::ln10 * solids - (0.5 + 2 * solids) * logarithm);
  const double factor = creeping_array(e, solids) + 0.413 / (24 * e * e) * above / below;
  return three_pi * fluid.viscosity * point.diameter * e * factor;
}

double tang_drag(const DragPoint& point, const FluidProperties& fluid) {
  const double e = point.voidage;
  const double solids = 1 - e;
  const double reynolds = superficial_reynolds(point, fluid);
  const double dense = 1 / (e * e * e * e);
  const double factor = creeping_array(e, solids) +
                        (0.11 * solids * (1 + solids) - 0.00456 * dense) * reynolds +
                        (0.169 * e + 0.0644 * dense) * std::pow(reynolds, 0.657);
  return three_pi * fluid.viscosity * point.diameter * e * factor;
}

DragRange drag_range(DragLaw law) {
  constexpr double everything = std::numeric_limits<double>::infinity();
  switch (law) {
    case DragLaw::ergun:
      return {0.35, 0.6, 5e3};
    case DragLaw::wen_yu:
      return {0.8, 1, 2e5};
    case DragLaw::gidaspow:
    case DragLaw::huilin_gidaspow:
      return {0.35, 1, 1e4};
    case DragLaw::stokes:
      return {0.95, 1, 0.5};
    case DragLaw::schiller_naumann:
      return {0.95, 1, 2e5};
    case DragLaw::di_felice:
    case DragLaw::syamlal_obrien:
      return {0.4, 1, 1e4};
    case DragLaw::koch_hill:
      return {0.36, 1, 200};
    case DragLaw::beetstra:
      return {0.4, 0.9, 1000};
    case DragLaw::tang:
      return {0.4, 1, 1000};
    case DragLaw::none:
    case DragLaw::expression:
      break;
  }
  return {0, 1, everything};
}

DragChoice drag_choice(const InterphaseSettings& interphase) {
  DragChoice choice{interphase.drag, interphase.syamlal_obrien, nullptr};
  if (choice.law == DragLaw::expression) {
    choice.formula = std::make_shared<const DragFormula>(interphase.drag_expression);
  }
  return choice;
}

namespace {

/// What all spheres of a run have in common.
struct Swarm {
  const DragChoice& choice;
  PressureModel model;
  const FluidProperties& fluid;
  std::span<const DragPoint> points;
  int threads;
  std::span<double> coefficients;
};

/// One sphere's part of the survey; `coefficient` is that of model A on entry.
class Surveyor {
 public:
  explicit Surveyor(const Swarm& swarm)
      : range_(drag_range(swarm.choice.law)),
        reynolds_(swarm.fluid.density / swarm.fluid.viscosity),
        model_b_(swarm.model == PressureModel::b) {}

  void finish(const DragPoint& point, double& coefficient, bool& outside, bool& bad) const {
    const double e = point.voidage;
    const double reynolds = reynolds_ * e * point.slip * point.diameter;
    outside =
        e < range_.least_voidage || e > range_.most_voidage || reynolds > range_.most_reynolds;
    if (model_b_) coefficient /= e;
    constexpr double largest = std::numeric_limits<double>::max();
    bad = !(coefficient >= 0 && coefficient <= largest);
  }

 private:
  DragRange range_;
  double reynolds_ = 0;  ///< ρ/μ
  bool model_b_ = false;
};

template <class Law>
DragSurvey for_all(const Swarm& swarm, const Law& law) {
  const int count = static_cast<int>(swarm.points.size());
  const Surveyor surveyor(swarm);
  std::int64_t outside = 0;
  int first_bad = count;
#pragma omp parallel for schedule(static) num_threads(swarm.threads) reduction(+ : outside) \
    reduction(min : first_bad)
  for (int i = 0; i < count; ++i) {
    double coefficient = law(swarm.points[i]);
    bool beyond = false;
    bool bad = false;
    surveyor.finish(swarm.points[i], coefficient, beyond, bad);
    swarm.coefficients[i] = coefficient;
    outside += beyond ? 1 : 0;
    if (bad) first_bad = std::min(first_bad, i);
  }
  return {outside, first_bad < count ? first_bad : -1};
}

/// As for_all, for a formula, which is evaluated in blocks.
DragSurvey for_all_blocks(const Swarm& swarm) {
  constexpr int size = UnitFormula::block;
  const int count = static_cast<int>(swarm.points.size());
  const Surveyor surveyor(swarm);
  int first_bad = count;
#pragma omp parallel for schedule(static) num_threads(swarm.threads) reduction(min : first_bad)
  for (int start = 0; start < count; start += size) {
    DragFormula::Block block{};
    DragFormula::Values coefficient{};
    const int rows = std::min(size, count - start);
    for (int i = 0; i < rows; ++i) {
      const DragPoint& point = swarm.points[start + i];
      block.voidage[i] = point.voidage;
      block.diameter[i] = point.diameter;
      block.slip[i] = point.slip;
    }
    swarm.choice.formula->evaluate(block, swarm.fluid.density, swarm.fluid.viscosity, coefficient);
    for (int i = 0; i < rows; ++i) {
      bool beyond = false;
      bool bad = false;
      surveyor.finish(swarm.points[start + i], coefficient[i], beyond, bad);
      swarm.coefficients[start + i] = coefficient[i];
      if (bad) first_bad = std::min(first_bad, start + i);
    }
  }
  return {0, first_bad < count ? first_bad : -1};
}

template <double (*law)(const DragPoint&, const FluidProperties&)>
DragSurvey for_all(const Swarm& swarm) {
  return for_all(swarm, [&](const DragPoint& point) { return law(point, swarm.fluid); });
}

}  // namespace

DragSurvey drag_coefficients(const DragChoice& choice, PressureModel model,
                             const FluidProperties& fluid, std::span<const DragPoint> points,
                             int threads, std::span<double> coefficients) {
  const Swarm swarm{choice, model, fluid, points, threads, coefficients};
  switch (choice.law) {
    case DragLaw::none:
      break;
    case DragLaw::gidaspow:
      return for_all<gidaspow_drag>(swarm);
    case DragLaw::ergun:
      return for_all<ergun_drag>(swarm);
    case DragLaw::wen_yu:
      return for_all<wen_yu_drag>(swarm);
    case DragLaw::stokes:
      return for_all<stokes_drag>(swarm);
    case DragLaw::di_felice:
      return for_all<di_felice_drag>(swarm);
    case DragLaw::koch_hill:
      return for_all<koch_hill_drag>(swarm);
    case DragLaw::beetstra:
      return for_all<beetstra_drag>(swarm);
    case DragLaw::tang:
      return for_all<tang_drag>(swarm);
    case DragLaw::syamlal_obrien:
      return for_all(swarm, [&](const DragPoint& point) {
        return syamlal_obrien_drag(point, fluid, choice.syamlal_obrien);
      });
    case DragLaw::schiller_naumann:
      return for_all<schiller_naumann_drag>(swarm);
    case DragLaw::huilin_gidaspow:
      return for_all<huilin_gidaspow_drag>(swarm);
    case DragLaw::expression:
      return for_all_blocks(swarm);
  }
  std::ranges::fill(coefficients, 0.0);
  return {};
}

void throw_bad_drag(DragLaw law, const std::string& whose, const DragPoint& point,
                    double coefficient) {
  throw NumericsError(
      "drag coefficient of {} is {} kg/s at voidage {}, slip {} m/s, diameter {} m; it must be "
      "finite and not negative: {}",
      whose, coefficient, point.voidage, point.slip, point.diameter,
      law == DragLaw::expression
          ? "change interphase.drag_expression.coefficient so that it is, there too"
          : "the state received from the fluid side is not finite, or too large for the law");
}

}  // namespace fluxpact
