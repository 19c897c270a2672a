// Conjugate gradients preconditioned by hypre's structured multigrid PFMG (Ashby & Falgout, Nucl.
// Sci. Eng. 124, 1996, 145-159): the fastest choice where the cells form a lattice.
#pragma once

#include "cfd_server/linear/pressure_solver.hpp"

namespace fluxpact {

std::unique_ptr<PressureSolver> make_lattice_multigrid(const Lattice& lattice,
                                                       const Stencil& stencil);

}  // namespace fluxpact
