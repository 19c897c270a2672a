// Eddy viscosities from the mean velocity's gradient, cell by cell.
#pragma once

#include <span>

#include "proto/base/vector.hpp"

namespace fluxpact {

/// |S| = √(2 S:S) [1/s] of a velocity gradient ∂u_i/∂x_j; the shear rate of a simple shear.
double strain_rate(const Matrix3& gradient);

/// μ_t = ρ (C_s Δ)² |S| [Pa s], Δ the cube root of the cell's volume (J. Smagorinsky, Mon. Weather
/// Rev. 91, 1963, 99-164; Δ after J.W. Deardorff, J. Fluid Mech. 41, 1970, 453-480). One entry a
/// cell; volume [m³].
void smagorinsky_viscosity(double density, double constant, std::span<const double> volume,
                           std::span<const Matrix3> gradient, std::span<double> viscosity);

}  // namespace fluxpact
