// Conjugate gradients with an incomplete Cholesky factor, from Eigen: needs nothing else, slower
// than multigrid.
#pragma once

#include "cfd_server/linear/pressure_solver.hpp"

namespace fluxpact {

std::unique_ptr<PressureSolver> make_conjugate_gradient(const Stencil& stencil);

}  // namespace fluxpact
