// Conjugate gradients preconditioned by hypre's BoomerAMG (Henson & Yang, Appl. Numer. Math. 41,
// 2002, 155-177), for meshes that are no lattice.
//
// A set-up costs as much as some ten iterations, and between two windows the matrix hardly changes:
// so multigrid is kept, with the matrix it was made for, while the gradients follow the new matrix.
// The rule: a committed window's set-up is kept until the iterations beyond the fewest that a
// window needed with it add up to the price of a new one; the window after that builds anew. All
// that decides changes on commit only, so a repeated window gives the same bits. `forget` makes the
// next window build anew: after a snapshot, so that a run that goes on from there and one that is
// restored from it agree bit by bit.
#pragma once

#include "cfd_server/linear/pressure_solver.hpp"

namespace fluxpact {

std::unique_ptr<PressureSolver> make_algebraic_multigrid(const Stencil& stencil);

}  // namespace fluxpact
