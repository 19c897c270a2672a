// Cost of the drag laws, ns a particle: a swarm from packed to dilute, Re from 0.1 to 1000.
//
//   drag_bench [particles] [threads]      one line a law; the best of nine passes
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <random>

#include "dem_server/interphase/drag.hpp"
#include "proto/scene/names.hpp"

namespace {

using namespace fluxpact;

double best_nanoseconds(const DragChoice& choice, const FluidProperties& fluid,
                        std::span<const DragPoint> points, int threads,
                        std::span<double> coefficients) {
  double best = INFINITY;
  for (int pass = 0; pass < 9; ++pass) {
    const auto began = std::chrono::steady_clock::now();
    drag_coefficients(choice, PressureModel::a, fluid, points, threads, coefficients);
    const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - began;
    best = std::min(best, spent.count() / static_cast<double>(points.size()));
  }
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t count = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 186805;
  const int threads = argc > 2 ? std::atoi(argv[2]) : 1;
  const FluidProperties air{1.225, 1.8e-5};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> voidage(0.4, 1.0);
  std::uniform_real_distribution<double> decades(-1, 3);
  std::vector<DragPoint> points(count);
  for (DragPoint& point : points) {
    point = {voidage(random), 2e-3, 0};
    point.slip = std::pow(10, decades(random)) * air.viscosity /
                 (point.voidage * air.density * point.diameter);
  }
  std::vector<double> coefficients(count);
  InterphaseSettings interphase;
  interphase.drag_expression.coefficient =
      "3*pi*viscosity*diameter * voidage^-2.65 * (reynolds < 1000 ? 1 + 0.15*reynolds^0.687 : "
      "0.44/24*reynolds)";
  fmt::print("{} particles, {} threads\n", count, threads);
  for (const auto& [law, name] : enum_names<DragLaw>) {
    interphase.drag = law;
    fmt::print("{:<18} {:6.1f} ns a particle\n", name,
               best_nanoseconds(drag_choice(interphase), air, points, threads, coefficients));
  }
}
