// Conjugate gradients preconditioned by hypre's BoomerAMG (Henson & Yang, Appl. Numer. Math. 41,
// 2002, 155-177), for meshes that are no lattice.
#pragma once

#include "cfd_server/linear/pressure_solver.hpp"

namespace fluxpact {

std::unique_ptr<PressureSolver> make_algebraic_multigrid(const Stencil& stencil);

}  // namespace fluxpact
