// The keys of the particles, and of what passes between them and the fluid: a part of the table of
// schema.hpp.
#pragma once

#include <numbers>

#include "proto/scene/key.hpp"
#include "proto/scene/scene.hpp"
#include "proto/scene/schema_insertion.hpp"
#include "proto/scene/schema_surfaces.hpp"

namespace fluxpact {

// The contact laws stand in another section than what they need: check_contact.cpp demands and
// refuses these keys, `only_with` is for the reference.
inline constexpr Range poisson_range{.lower = -1, .upper = 0.5, .without_lower = true};

template <class Visit>
void describe(Visit& visit, MaterialSettings& material) {
  visit({.name = "density",
         .dimension = Dimension::density,
         .range = positive,
         .required = true,
         .meaning = "Of the solid."},
        material.density);
  visit({.name = "youngs_modulus",
         .dimension = Dimension::pressure,
         .range = positive,
         .otherwise = "**required** with hertz",
         .only_with = "contact.law: hertz",
         .meaning = "Of the solid."},
        material.youngs_modulus);
  visit({.name = "poisson_ratio",
         .range = poisson_range,
         .otherwise = "**required** with hertz",
         .only_with = "contact.law: hertz",
         .meaning = "Of the solid."},
        material.poisson_ratio);
}

template <class Visit>
void describe(Visit& visit, WallMaterialSettings& walls) {
  visit({.name = "youngs_modulus",
         .dimension = Dimension::pressure,
         .range = positive,
         .required = true,
         .meaning = "Of the walls."},
        walls.youngs_modulus);
  visit({.name = "poisson_ratio",
         .range = poisson_range,
         .required = true,
         .meaning = "Of the walls."},
        walls.poisson_ratio);
}

/// What adds to the spring and dashpot of a pair.
template <class Visit>
void describe_rolling_and_cohesion(Visit& visit, PairSettings& pair) {
  visit({.name = "rolling_friction",
         .range = not_negative,
         .otherwise = "**required** with a rolling law",
         .only_with = "contact.rolling: constant_torque | spring_dashpot",
         .meaning = "Largest rolling torque over normal force and effective radius."},
        pair.rolling_friction);
  visit({.name = "rolling_damping",
         .range = not_negative,
         .otherwise = "0.3",
         .only_with = "contact.rolling: spring_dashpot",
         .meaning = "Share of critical damping of the rolling spring."},
        pair.rolling_damping);
  visit({.name = "cohesion_energy_density",
         .dimension = Dimension::energy_density,
         .range = not_negative,
         .otherwise = "**required** with sjkr",
         .only_with = "contact.cohesion: sjkr",
         .meaning = "Attraction over the area of contact."},
        pair.cohesion_energy_density);
  visit(
      {.name = "work_of_adhesion",
       .dimension = Dimension::surface_energy,
       .range = not_negative,
       .otherwise = "**required** with jkr",
       .only_with = "contact.cohesion: jkr",
       .meaning = "To part the two surfaces, per area: twice the surface energy of equal solids."},
      pair.work_of_adhesion);
  visit({.name = "liquid_volume",
         .dimension = Dimension::volume,
         .range = not_negative,
         .otherwise = "**required** with liquid_bridge",
         .only_with = "contact.cohesion: liquid_bridge",
         .meaning = "Of the bridge at each contact; 0: these stay dry."},
        pair.liquid_volume);
  visit({.name = "surface_tension",
         .dimension = Dimension::stiffness,
         .range = not_negative,
         .otherwise = "**required** with liquid_bridge",
         .only_with = "contact.cohesion: liquid_bridge",
         .meaning = "Of the liquid."},
        pair.surface_tension);
  visit({.name = "contact_angle",
         .dimension = Dimension::angle,
         .range = {.lower = 0, .upper = std::numbers::pi / 2},
         .otherwise = "**required** with liquid_bridge",
         .only_with = "contact.cohesion: liquid_bridge",
         .meaning = "Between liquid and solid, measured in the liquid."},
        pair.contact_angle);
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
         .otherwise = "**required** with linear",
         .only_with = "contact.law: linear",
         .meaning = "Spring along the line of centres."},
        pair.normal_stiffness);
  visit({.name = "tangential_stiffness",
         .dimension = Dimension::stiffness,
         .range = not_negative,
         .otherwise = "2/7 of `normal_stiffness`",
         .only_with = "contact.law: linear",
         .meaning = "Spring across the line of centres."},
        pair.tangential_stiffness);
  visit({.name = "restitution",
         .range = {.lower = 0, .upper = 1, .without_lower = true},
         .meaning = "Speed after over speed before a head-on collision; sets the damping."},
        pair.restitution);
  visit({.name = "friction", .range = not_negative, .meaning = "Coulomb's coefficient."},
        pair.friction);
  describe_rolling_and_cohesion(visit, pair);
}

template <class Visit>
void describe(Visit& visit, ContactSettings& contact) {
  visit({.name = "law",
         .meaning = "`linear`: springs and dashpots (Cundall and Strack 1979); `hertz`: elastic "
                    "spheres (Hertz 1882, Mindlin 1949, damping after Tsuji et al. 1992)."},
        contact.law);
  visit({.name = "rolling",
         .meaning = "Torque against rolling (Ai et al. 2011): `constant_torque` is their model A, "
                    "`spring_dashpot` C, which also holds particles at rest."},
        contact.rolling);
  visit({.name = "cohesion",
         .meaning =
             "Attraction: `sjkr` in proportion to the area of contact; `jkr` (with `law: hertz`) "
             "of adhesive elastic spheres (Johnson, Kendall and Roberts 1971); "
             "`liquid_bridge` forms on contact and holds up to its rupture (Willett et al. "
             "2000)."},
        contact.cohesion);
  visit({.name = "walls",
         .otherwise = "not set; required with hertz and pairs with `walls`",
         .only_with = "law: hertz",
         .meaning = "The elasticity of the walls."},
        contact.walls);
  visit({.name = "pairs",
         .meaning = "One entry for each pair of materials and for each material with `walls`; the "
                    "native backend needs all but those between materials of which all stands "
                    "still (fixed particles, surfaces, `walls`)."},
        contact.pairs);
}

template <class Visit>
void describe(Visit& visit, ParticleNumerics& numerics) {
  visit({.name = "precision",
         .meaning = "Of the native engine. `mixed`: positions in double, velocities, forces and "
                    "springs in float; faster and smaller. What that costs is measured after the "
                    "last window and told in the summary and in run.log."},
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
  visit(
      {.name = "walls",
       .meaning = "What particles bounce off; `from_mesh`: the boundary of the mesh, except where "
                  "patches with `type: pressure` let them out."},
      particles.walls);
  visit({.name = "surfaces",
         .meaning = "Walls beside those of the mesh, at rest or moving, by names of your choice."},
        particles.surfaces);
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
