#include "dem_server/interphase/drag.hpp"

#include <cmath>
#include <numbers>

#include "dem_server/interphase/overlap.hpp"

namespace fluxpact {
namespace {

template <double (*law)(const DragPoint&, const FluidProperties&)>
void for_all(const FluidProperties& fluid, std::span<const DragPoint> points, int threads,
             std::span<double> coefficients) {
  const int count = static_cast<int>(points.size());
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int i = 0; i < count; ++i) coefficients[i] = law(points[i], fluid);
}

double no_drag(const DragPoint& /*point*/, const FluidProperties& /*fluid*/) { return 0; }

}  // namespace

double ergun_drag(const DragPoint& point, const FluidProperties& fluid) {
  const double e = point.voidage;
  const double d = point.diameter;
  const double viscous = 150 * (1 - e) * fluid.viscosity / (e * d * d);
  const double inertial = 1.75 * fluid.density * point.slip / d;
  return ball_volume(d / 2) * (viscous + inertial);
}

// Below Re = 1000 the slip cancels against that in C_D, so ζ is finite without slip.
double wen_yu_drag(const DragPoint& point, const FluidProperties& fluid) {
  const double e = point.voidage;
  const double d = point.diameter;
  const double reynolds = e * fluid.density * point.slip * d / fluid.viscosity;
  const double single =
      reynolds < 1000 ? 18 * fluid.viscosity / (d * d) * (1 + 0.15 * std::pow(reynolds, 0.687))
                      : 0.75 * 0.44 * e * fluid.density * point.slip / d;
  return ball_volume(d / 2) * single * std::pow(e, -2.65);
}

double gidaspow_drag(const DragPoint& point, const FluidProperties& fluid) {
  return point.voidage < 0.8 ? ergun_drag(point, fluid) : wen_yu_drag(point, fluid);
}

double stokes_drag(const DragPoint& point, const FluidProperties& fluid) {
  return 3 * std::numbers::pi * fluid.viscosity * point.diameter;
}

void drag_coefficients(DragLaw law, PressureModel model, const FluidProperties& fluid,
                       std::span<const DragPoint> points, int threads,
                       std::span<double> coefficients) {
  switch (law) {
    case DragLaw::none:
      for_all<no_drag>(fluid, points, threads, coefficients);
      break;
    case DragLaw::gidaspow:
      for_all<gidaspow_drag>(fluid, points, threads, coefficients);
      break;
    case DragLaw::ergun:
      for_all<ergun_drag>(fluid, points, threads, coefficients);
      break;
    case DragLaw::wen_yu:
      for_all<wen_yu_drag>(fluid, points, threads, coefficients);
      break;
    case DragLaw::stokes:
      for_all<stokes_drag>(fluid, points, threads, coefficients);
      break;
  }
  if (model == PressureModel::a) return;
  for (std::size_t i = 0; i < points.size(); ++i) coefficients[i] /= points[i].voidage;
}

}  // namespace fluxpact
