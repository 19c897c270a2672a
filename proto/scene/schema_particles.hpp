// The keys of the particles, and of what passes between them and the fluid: a part of the table of
// schema.hpp.
#pragma once

#include "proto/scene/key.hpp"
#include "proto/scene/scene.hpp"
#include "proto/scene/schema_insertion.hpp"

namespace fluxpact {

template <class Visit>
void describe(Visit& visit, MaterialSettings& material) {
  visit({.name = "density",
         .dimension = Dimension::density,
         .range = positive,
         .required = true,
         .meaning = "Of the solid."},
        material.density);
}

template <class Visit>
void describe(Visit& visit, PairSettings& pair) {
  visit({.name = "between",
         .text = TextRule::name,
         .required = true,
         .meaning = "Two materials, or a material and `walls`."},
        pair.between);
  visit({.name = "normal_stiffness",
         .dimension = Dimension::stiffness,
         .range = positive,
         .required = true,
         .meaning = "Spring along the line of centres."},
        pair.normal_stiffness);
  visit({.name = "tangential_stiffness",
         .dimension = Dimension::stiffness,
         .range = not_negative,
         .otherwise = "2/7 of `normal_stiffness`",
         .meaning = "Spring across the line of centres."},
        pair.tangential_stiffness);
  visit({.name = "restitution",
         .range = {.lower = 0, .upper = 1, .without_lower = true},
         .meaning = "Speed after over speed before a head-on collision; sets the damping."},
        pair.restitution);
  visit({.name = "friction", .range = not_negative, .meaning = "Coulomb's coefficient."},
        pair.friction);
}

template <class Visit>
void describe(Visit& visit, ContactSettings& contact) {
  visit({.name = "law", .meaning = "`linear`: spring and dashpot (Cundall and Strack 1979)."},
        contact.law);
  visit({.name = "pairs",
         .meaning = "One entry for each pair of materials and for each material with `walls`; the "
                    "native backend needs all."},
        contact.pairs);
}

template <class Visit>
void describe(Visit& visit, ParticleNumerics& numerics) {
  visit({.name = "threads",
         .range = not_negative,
         .meaning = "Threads of the particle solver; 0: all cores."},
        numerics.threads);
}

template <class Visit>
void describe(Visit& visit, ParticleSettings& particles) {
  visit({.name = "backend",
         .meaning = "The program that moves the particles. `native`: soft spheres; `kinematic`: no "
                    "force moves them."},
        particles.backend);
  visit({.name = "time_step",
         .dimension = Dimension::time,
         .range = positive,
         .otherwise = "one window; the native backend with particles needs it",
         .meaning = "Upper bound of the particles' step: the window is cut into equal steps."},
        particles.time_step);
  visit({.name = "materials", .meaning = "The materials of the particles, by name."},
        particles.materials);
  visit({.name = "contact", .meaning = "Forces between touching particles, and walls."},
        particles.contact);
  visit({.name = "walls",
         .meaning = "What particles bounce off; `from_mesh`: the fluid's wall patches."},
        particles.walls);
  visit({.name = "insertion", .meaning = "The particles at time 0; none: an empty domain."},
        particles.insertion);
  visit({.name = "overlaps",
         .meaning = "Spheres at time 0 that overlap by more than a tenth of the smaller diameter, "
                    "or stick out of the domain by that: `refuse`: an error that names them; "
                    "`relax`: all are pushed apart first, until none overlaps by more than 1 %."},
        particles.overlaps);
  visit({.name = "inflow", .meaning = "Particles that come in during the run; none: nobody does."},
        particles.inflow);
  visit({.name = "outflow",
         .text = TextRule::name,
         .otherwise = "every patch of type pressure that fills a side of the domain",
         .meaning = "Patches of type pressure through which particles leave the domain, once "
                    "their centre has passed. Elsewhere, and with an empty list anywhere, a "
                    "particle that gets out is an error."},
        particles.outflow);
  visit({.name = "numerics", .meaning = "How the particles are computed."}, particles.numerics);
}

template <class Visit>
void describe(Visit& visit, PrescribedSettings& prescribed) {
  visit({.name = "voidage",
         .required = true,
         .meaning = "Formula in x, y, z (cell centre, m) and t (s), e.g. `x < 0.1 ? 0.42 : 1`."},
        prescribed.voidage);
  visit({.name = "diameter",
         .dimension = Dimension::length,
         .range = positive,
         .required = true,
         .meaning = "Of the spheres that the drag law sees."},
        prescribed.diameter);
}

template <class Visit>
void describe(Visit& visit, InterphaseSettings& interphase) {
  visit({.name = "model",
         .meaning = "Where the pressure gradient acts (Gidaspow 1994): `a`: on fluid and "
                    "particles, in proportion to their volume; `b`: on the fluid alone, with the "
                    "drag over the voidage; particles feel buoyancy."},
        interphase.model);
  visit({.name = "voidage",
         .meaning = "Map from particles to cells. `exact`: overlap of sphere and cell; `centroid`: "
                    "all volume to one cell, "
                    "jumps; `prescribed`: a formula, no particles."},
        interphase.voidage);
  visit({.name = "drag",
         .meaning = "Gidaspow 1994; Ergun 1952; Wen and Yu 1966; Stokes 1851; or none."},
        interphase.drag);
  visit({.name = "forces", .meaning = "Further forces of the fluid on the particles."},
        interphase.forces);
  visit({.name = "prescribed",
         .otherwise = "not set; required with `voidage: prescribed`",
         .meaning = "A solid phase at rest given by a formula, for verification."},
        interphase.prescribed);
}

}  // namespace fluxpact
