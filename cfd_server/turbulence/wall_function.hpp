// The log law of the wall for the k-epsilon model: what a wall does to the cell beside it.
//
// B.E. Launder, D.B. Spalding, Comput. Methods Appl. Mech. Eng. 3 (1974) 269-289. With
// u* = C_μ^(1/4) √k and y* = ρ u* y/μ, above the viscous layer:
//     τ_w = ρ u* κ U/ln(E y*),   G = τ_w u*_w/(κ y) with u*_w = τ_w/(ρ u*),   ε = u*³/(κ y)
// In equilibrium, τ_w = ρ u*², production and dissipation are equal.
#pragma once

namespace fluxpact {

/// Of the standard model.
struct KEpsilonConstants {
  double c_mu = 0.09;
  double c_1 = 1.44;
  double c_2 = 1.92;
  double sigma_k = 1.0;
  double sigma_epsilon = 1.3;
  double kappa = 0.41;
  double roughness = 9.8;  ///< E of a smooth wall
};

/// One wall face, seen from its cell.
struct WallState {
  double viscosity = 0;    ///< [Pa s] that gives τ_w with the difference quotient U/y
  double production = 0;   ///< G of the cell [W/m³]
  double dissipation = 0;  ///< ε of the cell [m²/s³]
};

/// Where the viscous layer's U = y* u* meets the log law [-].
double viscous_layer(const KEpsilonConstants& constants);

/// distance: of the cell's centre from the wall [m]; speed: tangential, relative to the wall [m/s];
/// layer: viscous_layer. Inside the viscous layer: the molecular viscosity, no production, and
/// ε = 2 ν k/y².
WallState at_wall(const KEpsilonConstants& constants, double layer, double density,
                  double viscosity, double distance, double energy, double speed);

}  // namespace fluxpact
