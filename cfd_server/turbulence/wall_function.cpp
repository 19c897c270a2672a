#include "cfd_server/turbulence/wall_function.hpp"

#include <cmath>

namespace fluxpact {

double viscous_layer(const KEpsilonConstants& c) {
  double layer = 11;
  // The map contracts by 1/(κ y*) = 0.2 a pass: 30 passes reach the last digit.
  for (int pass = 0; pass < 30; ++pass) layer = std::log(c.roughness * layer) / c.kappa;
  return layer;
}

WallState at_wall(const KEpsilonConstants& c, double layer, double density, double viscosity,
                  double distance, double energy, double speed) {
  const double friction = std::pow(c.c_mu, 0.25) * std::sqrt(energy);
  const double height = density * friction * distance / viscosity;
  if (height <= layer)
    return {viscosity, 0.0, 2 * viscosity / density * energy / (distance * distance)};
  WallState wall;
  wall.viscosity = viscosity * height * c.kappa / std::log(c.roughness * height);
  const double stress = wall.viscosity * speed / distance;
  wall.production = stress * stress / (density * friction * c.kappa * distance);
  wall.dissipation = friction * friction * friction / (c.kappa * distance);
  return wall;
}

}  // namespace fluxpact
