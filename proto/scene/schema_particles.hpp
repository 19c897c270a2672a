// The keys of the particles, and of what passes between them and the fluid: a part of the table of
// schema.hpp.
#pragma once

#include "proto/scene/key.hpp"
#include "proto/scene/scene.hpp"

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
void describe(Visit& visit, InsertionSettings& entry) {
  visit({.name = "type",
         .required = true,
         .meaning = "`packing`: a number of spheres at random; `lattice`: a region filled with a "
                    "regular lattice; `file`: read."},
        entry.type);
  const bool packing = entry.type == InsertionType::packing;
  const bool file = entry.type == InsertionType::file;
  visit({.name = "material",
         .text = TextRule::name,
         .required = true,
         .meaning = "One of `particles.materials`."},
        entry.material);
  visit({.name = "diameter",
         .dimension = Dimension::length,
         .range = positive,
         .required = !file,
         .otherwise = "the file's column `diameter`, which wins",
         .meaning = "Of the spheres. Optional with `type: file`, required else."},
        entry.diameter);
  visit({.name = "count",
         .range = {.lower = 1},
         .required = true,
         .applies = packing,
         .only_with = "type: packing",
         .meaning = "Number of spheres."},
        entry.count);
  visit({.name = "within",
         .otherwise = "the whole domain",
         .applies = !file,
         .only_with = "type: packing | lattice",
         .meaning = "Where the spheres start."},
        entry.within);
  visit({.name = "seed",
         .range = not_negative,
         .applies = packing,
         .only_with = "type: packing",
         .meaning = "Of the random numbers: the same seed gives the same packing."},
        entry.seed);
  visit({.name = "spacing",
         .dimension = Dimension::length,
         .range = positive,
         .otherwise = "1.001 diameters",
         .applies = entry.type == InsertionType::lattice,
         .only_with = "type: lattice",
         .meaning = "Distance of neighbours."},
        entry.spacing);
  visit({.name = "velocity",
         .dimension = Dimension::velocity,
         .applies = !file,
         .only_with = "type: packing | lattice",
         .meaning = "Of all spheres at the start."},
        entry.velocity);
  visit({.name = "path",
         .required = true,
         .applies = file,
         .only_with = "type: file",
         .meaning =
             "CSV with a header line x,y,z[,vx,vy,vz][,diameter], in SI units; relative to the "
             "folder of the scene."},
        entry.path);
}

template <class Visit>
void describe(Visit& visit, ParticleNumerics& numerics) {
  visit({.name = "precision",
         .meaning = "Of the native engine. `mixed`: positions in double, velocities, forces and "
                    "springs in float; faster and smaller, at the error that docs/results.md "
                    "shows."},
        numerics.precision);
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
