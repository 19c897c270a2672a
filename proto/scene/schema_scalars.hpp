// The keys of scalars and turbulence of the fluid: a part of the table of schema.hpp.
#pragma once

#include "proto/scene/key.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

template <class Visit>
void describe(Visit& visit, ScalarBoundarySettings& boundary) {
  visit({.name = "value",
         .otherwise = "zero gradient",
         .meaning = "What enters with the fluid has this value, and "
                    "inlets and walls hold it. At a pressure patch it is that of what flows back."},
        boundary.value);
  visit({.name = "flux",
         .otherwise = "zero gradient",
         .meaning = "What enters through a wall, kg/(m2.s) of a species, W/m2 of heat."},
        boundary.flux);
}

template <class Visit>
void describe(Visit& visit, ScalarSettings& scalar) {
  visit({.name = "kind",
         .meaning = "`species`: an amount per mass of fluid. `temperature`: heat, in K."},
        scalar.kind);
  const bool species = scalar.kind == ScalarKind::species;
  visit({.name = "diffusivity",
         .dimension = Dimension::diffusivity,
         .range = not_negative,
         .required = true,
         .applies = species,
         .only_with = "kind: species",
         .meaning = "Molecular."},
        scalar.diffusivity);
  visit({.name = "conductivity",
         .dimension = Dimension::conductivity,
         .range = not_negative,
         .required = true,
         .applies = !species,
         .only_with = "kind: temperature",
         .meaning = "Molecular."},
        scalar.conductivity);
  visit({.name = "heat_capacity",
         .dimension = Dimension::heat_capacity,
         .range = positive,
         .required = true,
         .applies = !species,
         .only_with = "kind: temperature",
         .meaning = "Of the fluid, at constant pressure."},
        scalar.heat_capacity);
  visit({.name = "initial", .meaning = "The field at time 0."}, scalar.initial);
  visit({.name = "source",
         .otherwise = "none",
         .meaning = "What appears per volume of fluid, kg/(m3.s) of a species, W/m3 of heat."},
        scalar.source);
  visit({.name = "boundaries",
         .meaning = "What the patches do to it; zero gradient where none is given: what enters "
                    "there has the value of the cell."},
        scalar.boundaries);
  visit({.name = "convection",
         .meaning = "How it is carried through faces; each of them makes no new extrema."},
        scalar.convection);
  visit({.name = "tolerance",
         .range = {.lower = 0, .upper = 1, .without_lower = true, .without_upper = true},
         .meaning = "Relative residual of its equation. Its amount is conserved at any value."},
        scalar.tolerance);
}

template <class Visit>
void describe(Visit& visit, TurbulentInletSettings& inlet) {
  visit({.name = "intensity",
         .range = positive,
         .meaning = "Root mean square of a component of the fluctuation over the mean velocity."},
        inlet.intensity);
  visit({.name = "length_scale",
         .dimension = Dimension::length,
         .range = positive,
         .required = true,
         .meaning = "Size of the eddies, e.g. 0.07 of a pipe's diameter."},
        inlet.length_scale);
}

template <class Visit>
void describe(Visit& visit, TurbulenceSettings& turbulence) {
  visit({.name = "model", .meaning = "Where the eddy viscosity comes from."}, turbulence.model);
  const bool smagorinsky = turbulence.model == TurbulenceModel::smagorinsky;
  const bool k_epsilon = turbulence.model == TurbulenceModel::k_epsilon;
  visit({.name = "smagorinsky_constant",
         .range = positive,
         .applies = smagorinsky,
         .only_with = "model: smagorinsky",
         .meaning = "Filter length over the cube root of the cell's volume; 0.17 in isotropic "
                    "turbulence, 0.1 in shear flow."},
        turbulence.smagorinsky_constant);
  visit({.name = "kinetic_energy",
         .range = positive,
         .required = true,
         .applies = k_epsilon,
         .only_with = "model: k_epsilon",
         .meaning = "k at time 0, m2/s2."},
        turbulence.kinetic_energy);
  visit({.name = "dissipation",
         .range = positive,
         .required = true,
         .applies = k_epsilon,
         .only_with = "model: k_epsilon",
         .meaning = "Dissipation of k at time 0, m2/s3."},
        turbulence.dissipation);
  visit({.name = "schmidt_number",
         .range = positive,
         .applies = smagorinsky || k_epsilon,
         .only_with = "a model",
         .meaning = "Eddy viscosity over eddy diffusivity of all scalars (heat: Prandtl number)."},
        turbulence.schmidt_number);
  visit({.name = "inlets",
         .applies = k_epsilon,
         .only_with = "model: k_epsilon",
         .meaning = "Turbulence of what enters, for each patch of type velocity or mass_flow."},
        turbulence.inlets);
}

}  // namespace fluxpact
