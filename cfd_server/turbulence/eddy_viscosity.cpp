#include "cfd_server/turbulence/eddy_viscosity.hpp"

#include <cmath>

namespace fluxpact {

double strain_rate(const Matrix3& gradient) {
  const Matrix3 strain = 0.5 * (gradient + gradient.transpose());
  return std::sqrt(2 * strain.squaredNorm());
}

void smagorinsky_viscosity(double density, double constant, std::span<const double> volume,
                           std::span<const Matrix3> gradient, std::span<double> viscosity) {
  for (std::size_t cell = 0; cell < viscosity.size(); ++cell) {
    const double length = constant * std::cbrt(volume[cell]);
    viscosity[cell] = density * length * length * strain_rate(gradient[cell]);
  }
}

}  // namespace fluxpact
