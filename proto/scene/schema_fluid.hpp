// The keys of the fluid, its mesh and boundaries: a part of the table of schema.hpp.
#pragma once

#include "proto/scene/key.hpp"
#include "proto/scene/scene.hpp"
#include "proto/scene/schema_scalars.hpp"

namespace fluxpact {

template <class Visit>
void describe(Visit& visit, Region& region) {
  const auto axis = [&](std::string_view name, std::string_view meaning, auto& member) {
    visit({.name = name,
           .dimension = Dimension::length,
           .otherwise = "unbounded",
           .meaning = meaning},
          member);
  };
  axis("x", "Range in x.", region.x);
  axis("y", "Range in y.", region.y);
  axis("z", "Range in z.", region.z);
}

template <class Visit>
void describe(Visit& visit, GradingSettings& part) {
  visit({.name = "length",
         .range = positive,
         .meaning = "Share of the axis; shares are relative to their sum."},
        part.length);
  visit({.name = "cells",
         .range = positive,
         .meaning = "Share of the axis' cells, rounded to whole cells."},
        part.cells);
  visit({.name = "ratio",
         .range = positive,
         .meaning = "Width of the last cell of the part over that of its first; each cell is a "
                    "constant factor wider than the one before."},
        part.ratio);
}

template <class Visit>
void describe(Visit& visit, BoxGrading& grading) {
  visit({.name = "x",
         .meaning = "Parts of the x axis from its lower end; fine at both ends: "
                    "`[{ratio: 10}, {ratio: 0.1}]`."},
        grading.x);
  visit({.name = "y", .meaning = "Parts of the y axis."}, grading.y);
  visit({.name = "z", .meaning = "Parts of the z axis."}, grading.z);
}

template <class Visit>
void describe(Visit& visit, BoxSettings& box) {
  visit({.name = "lower", .dimension = Dimension::length, .meaning = "Corner of the box."},
        box.lower);
  visit({.name = "upper",
         .dimension = Dimension::length,
         .required = true,
         .meaning = "Opposite corner, beyond `lower`."},
        box.upper);
  visit({.name = "cells",
         .range = {.lower = 1},
         .required = true,
         .meaning = "Number of cells in x, y and z."},
        box.cells);
  visit({.name = "grading",
         .otherwise = "equal cells",
         .meaning = "Widths of the cells along each axis, as blockMesh grades its edges."},
        box.grading);
}

template <class Visit>
void describe(Visit& visit, JoinSettings& pair) {
  visit({.name = "patches",
         .required = true,
         .meaning = "Two patches of the file that differ by a translation only."},
        pair.patches);
}

template <class Visit>
void describe(Visit& visit, MeshFileSettings& file) {
  visit({.name = "path",
         .required = true,
         .meaning = "Where the mesh is; relative to the folder of the scene."},
        file.path);
  visit({.name = "scale",
         .range = positive,
         .meaning = "Metres in one unit of the file; 1e-3 for a file in millimetres."},
        file.scale);
  visit({.name = "periodic", .meaning = "Pairs of patches that are joined."}, file.periodic);
}

template <class Visit>
void describe(Visit& visit, PatchSettings& patch) {
  visit({.name = "side", .required = true, .meaning = "Side of the box."}, patch.side);
  visit({.name = "within",
         .otherwise = "the whole side",
         .meaning = "Only the faces whose centre lies in this range."},
        patch.within);
}

template <class Visit>
void describe(Visit& visit, MeshSettings& mesh) {
  constexpr std::string_view from_box = "box";
  visit({.name = "polymesh",
         .otherwise = "exactly one of `polymesh`, `gmsh` and `box`",
         .meaning = "A folder `polyMesh` of OpenFOAM in ascii: points, faces, owner, neighbour, "
                    "boundary. `cyclic` patches are joined; all others need a condition."},
        mesh.polymesh);
  visit({.name = "gmsh",
         .otherwise = "exactly one of `polymesh`, `gmsh` and `box`",
         .applies = !mesh.polymesh,
         .only_with = "neither polymesh nor box",
         .meaning = "A file of Gmsh in the format 4.1 ascii, first order. Physical surfaces are "
                    "the patches; faces without one are the patch `walls`."},
        mesh.gmsh);
  visit({.name = "box",
         .required = true,
         .otherwise = "exactly one of `polymesh`, `gmsh` and `box`",
         .applies = mesh.is_box(),
         .only_with = "neither polymesh nor gmsh",
         .meaning = "A box of hexahedra."},
        mesh.box);
  visit({.name = "periodic",
         .applies = mesh.is_box(),
         .only_with = from_box,
         .meaning = "Axes whose two sides are joined."},
        mesh.periodic);
  visit({.name = "patches",
         .applies = mesh.is_box(),
         .only_with = from_box,
         .meaning = "Named parts of the boundary. A face belongs to the first patch that holds its "
                    "centre; what is left is "
                    "the patch `walls`."},
        mesh.patches);
}

template <class Visit>
void describe(Visit& visit, ProfileSettings& profile) {
  visit({.name = "along", .meaning = "What the first column of `points` is."}, profile.along);
  visit({.name = "points",
         .required = true,
         .meaning = "Pairs [place in m or time in s, factor], the first ascending; linear in "
                    "between, constant beyond the ends."},
        profile.points);
}

template <class Visit>
void describe(Visit& visit, BoundarySettings& boundary) {
  visit({.name = "type", .required = true, .meaning = "What is known on the patch."},
        boundary.type);
  constexpr std::string_view exactly_one = "exactly one of `superficial` and `interstitial`";
  const bool velocity = boundary.type == BoundaryType::velocity;
  visit({.name = "superficial",
         .dimension = Dimension::velocity,
         .otherwise = exactly_one,
         .applies = velocity,
         .only_with = "type: velocity",
         .meaning = "Volume flux per area of the patch."},
        boundary.superficial);
  visit({.name = "interstitial",
         .dimension = Dimension::velocity,
         .otherwise = exactly_one,
         .applies = velocity,
         .only_with = "type: velocity",
         .meaning = "Velocity between the particles: times the voidage of the adjacent cell it is "
                    "the volume flux."},
        boundary.interstitial);
  visit({.name = "rate",
         .dimension = Dimension::mass_flow,
         .required = true,
         .applies = boundary.type == BoundaryType::mass_flow,
         .only_with = "type: mass_flow",
         .meaning = "Mass flow into the domain over the whole patch; negative: out of it. A "
                    "formula may use t; a `profile` along x, y or z gives it a shape."},
        boundary.rate);
  visit({.name = "value",
         .dimension = Dimension::pressure,
         .applies = boundary.type == BoundaryType::pressure,
         .only_with = "type: pressure",
         .meaning = "Pressure less the hydrostatic one, p - rho g.x."},
        boundary.value);
  const bool wall = boundary.type == BoundaryType::wall;
  visit({.name = "profile",
         .applies = !wall,
         .only_with = "type: velocity | mass_flow | pressure",
         .meaning = "Tables that multiply the value."},
        boundary.profile);
  visit({.name = "slip",
         .applies = wall,
         .only_with = "type: wall",
         .meaning = "`none`: the fluid sticks to the wall; `free`: no friction; `partial`: it "
                    "slips by `slip_length` times its shear rate at the wall."},
        boundary.slip);
  visit({.name = "slip_length",
         .dimension = Dimension::length,
         .range = positive,
         .required = true,
         .applies = wall && boundary.slip == Slip::partial,
         .only_with = "slip: partial",
         .meaning = "Depth in the wall at which the velocity profile would reach the wall's."},
        boundary.slip_length);
  visit({.name = "velocity",
         .dimension = Dimension::velocity,
         .applies = wall && boundary.slip != Slip::free,
         .only_with = "type: wall, slip: none | partial",
         .meaning = "Of a wall that moves along itself; its part normal to the wall is left out."},
        boundary.velocity);
  visit({.name = "ramp",
         .dimension = Dimension::time,
         .range = not_negative,
         .applies = !wall || boundary.slip != Slip::free,
         .only_with = "type: velocity | mass_flow | pressure, or slip: none | partial",
         .meaning = "The value grows linearly from 0 during this time; 0: at once."},
        boundary.ramp);
}

template <class Visit>
void describe(Visit& visit, InitialSettings& initial) {
  visit({.name = "superficial",
         .dimension = Dimension::velocity,
         .meaning = "Superficial velocity at time 0 in every cell, and as the mean over each "
                    "face."},
        initial.superficial);
}

template <class Visit>
void describe(Visit& visit, LegacySettings& legacy) {
  visit({.name = "tolerance",
         .range = {.lower = 0, .upper = 1, .without_lower = true, .without_upper = true},
         .meaning = "Largest change of a face flux between two iterations over the largest flux."},
        legacy.tolerance);
  visit({.name = "iterations", .range = {.lower = 1}, .meaning = "Most iterations in a window."},
        legacy.iterations);
  visit(
      {.name = "velocity",
       .meaning = "Of a cell, in the mass source: `faces`, the mean of the interstitial velocities "
                  "of its faces; `cells`, its own, the mean of their superficial velocities over "
                  "its voidage. Which of them is open in Wu et al. (2009): docs/wu2011."},
      legacy.velocity);
}

template <class Visit>
void describe(Visit& visit, FluidNumerics& numerics) {
  visit({.name = "convection",
         .meaning =
             "How momentum is carried through faces; `limited`: second order with a TVD limiter."},
        numerics.convection);
  visit({.name = "time",
         .meaning = "`euler`: first order, the choice for moving beds; `bdf2`: second order, "
                    "which falls back to Euler where a voidage front crosses half a cell in one "
                    "step."},
        numerics.time);
  visit({.name = "courant_limit",
         .range = positive,
         .meaning = "A window in which fluid would cross more cells than this is solved in equal "
                    "inner steps; fields of such a window are means over it."},
        numerics.courant_limit);
  visit({.name = "outer_iterations",
         .range = {.lower = 1, .upper = 100},
         .meaning =
             "Predictions of momentum in a step, each with the newest flux and followed by all "
             "pressure corrections (PIMPLE); 1: the flux of the last step convects (PISO)."},
        numerics.outer_iterations);
  visit({.name = "correctors",
         .range = {.lower = 1, .upper = 100},
         .meaning = "Pressure corrections in a step. Two keep the order of the pressure, three on "
                    "tetrahedra and prisms."},
        numerics.correctors);
  visit(
      {.name = "non_orthogonal_correctors",
       .range = {.lower = 0, .upper = 100},
       .meaning = "Repetitions of each pressure correction on a mesh that is not orthogonal, with "
                  "the part of the pressure gradient along the faces renewed."},
      numerics.non_orthogonal_correctors);
  visit({.name = "pressure_tolerance",
         .range = {.lower = 0, .upper = 1, .without_lower = true, .without_upper = true},
         .meaning = "Relative residual of the pressure equation. Mass is conserved at any value; "
                    "velocity is not exact."},
        numerics.pressure_tolerance);
  visit({.name = "solver",
         .meaning = "Linear solver of the pressure equation; `automatic` chooses by the mesh."},
        numerics.solver);
  visit({.name = "threads",
         .range = not_negative,
         .meaning = "Threads of the fluid solver, fewer on small meshes; 0: all cores. The result "
                    "has the same bits for any number."},
        numerics.threads);
  visit({.name = "legacy", .meaning = "The mass source with `continuity: legacy`."},
        numerics.legacy);
}

template <class Visit>
void describe(Visit& visit, FluidSettings& fluid) {
  visit({.name = "backend", .meaning = "The program that solves the fluid."}, fluid.backend);
  visit({.name = "density",
         .dimension = Dimension::density,
         .range = positive,
         .required = true,
         .meaning = "Of the fluid."},
        fluid.density);
  visit({.name = "viscosity",
         .dimension = Dimension::viscosity,
         .range = positive,
         .required = true,
         .meaning = "Dynamic viscosity."},
        fluid.viscosity);
  visit({.name = "mesh", .required = true, .meaning = "The cells, shared by all participants."},
        fluid.mesh);
  visit({.name = "boundaries",
         .meaning = "One condition for each patch of the mesh, `walls` included."},
        fluid.boundaries);
  visit({.name = "initial", .meaning = "The fluid at time 0."}, fluid.initial);
  visit({.name = "scalars",
         .meaning = "Species and temperature that the fluid carries; none costs nothing."},
        fluid.scalars);
  visit({.name = "turbulence", .meaning = "What the mesh does not resolve; `none` costs nothing."},
        fluid.turbulence);
  visit({.name = "numerics", .meaning = "How the fluid is solved."}, fluid.numerics);
}

}  // namespace fluxpact
