// The keys of the particles, and of what passes between them and the fluid: a part of the table of
// schema.hpp.
#pragma once

#include <algorithm>
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
         .meaning = "Spring along the line of centres. `hard_sphere` can do without, but an "
                    "insertion of type `settled` cannot."},
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
  visit({.name = "tangential_restitution",
         .range = {.lower = -1, .upper = 1},
         .otherwise = "what the linear springs and dashpots would give",
         .only_with = "particles.backend: hard_sphere",
         .meaning = "Minus the tangential speed of the surfaces after over before a collision in "
                    "which they stick: 1 turns it round, -1 leaves it."},
        pair.tangential_restitution);
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
         .meaning = "One entry for each pair of materials and for each material with `walls`; all "
                    "are needed but those between materials of which all stands "
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
         .meaning = "The engine that moves the particles. `native`: our soft spheres; "
                    "`hard_sphere`: our collisions as events; `lammps`, `liggghts`, `yade`: these "
                    "programs, if they were there when ours were built; `kinematic`: no force "
                    "moves them; `custom`: the server that `program` names."},
        particles.backend);
  visit({.name = "program",
         .otherwise = "**required** with custom",
         .only_with = "backend: custom",
         .meaning = "Path of the particle server (an absolute one, or from the scene's folder); "
                    "docs/new-backend.md tells how one is made."},
        particles.program);
  visit({.name = "ranks",
         .range = {.lower = 1, .upper = 4096},
         .only_with = "backend: lammps, liggghts",
         .meaning = "Processes that share the particles through MPI."},
        particles.ranks);
  visit({.name = "time_step",
         .dimension = Dimension::time,
         .range = positive,
         .otherwise = "one window; engines that know contacts need it",
         .meaning = "Upper bound of the particles' step: the window is cut into equal steps. With "
                    "`hard_sphere`, which steps from event to event, the time that a contact "
                    "stands for: spheres that collide more often than that are in a lasting "
                    "contact, and lose no energy there (docs/theory.md)."},
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
void describe(Visit& visit, VoidageSettings& voidage) {
  visit({.name = "map",
         .meaning = "`exact`: overlap of sphere and cell; `centroid`: all volume to one cell, "
                    "jumps; `satellite`: equal parts at fixed points of the sphere, small jumps; "
                    "`kernel`: a smooth bell around the sphere, which sees through inner walls; "
                    "`diffusion`: spread from cell to cell, around them; `prescribed`: a formula, "
                    "no particles."},
        voidage.map);
  const bool kernel = voidage.map == VoidageMap::kernel;
  const bool diffusion = voidage.map == VoidageMap::diffusion;
  visit({.name = "points",
         .range = {.lower = 1, .upper = 1000},
         .applies = voidage.map == VoidageMap::satellite,
         .only_with = "map: satellite",
         .meaning = "Points in each sphere."},
        voidage.points);
  visit({.name = "width",
         .dimension = Dimension::length,
         .range = positive,
         .required = diffusion,
         .otherwise = "4 diameters of each sphere; required with `map: diffusion`",
         .applies = kernel || diffusion,
         .only_with = "map: kernel | diffusion",
         .meaning = "Full width of the bell at half its height."},
        voidage.width);
  visit({.name = "from",
         .applies = diffusion,
         .only_with = "map: diffusion",
         .meaning = "What is spread: the shares of `exact` or of `centroid`."},
        voidage.from);
  visit({.name = "smallest",
         .range = {.lower = 0, .upper = 0.9, .without_lower = true},
         .applies = voidage.map != VoidageMap::prescribed,
         .only_with = "map: all but prescribed",
         .meaning = "Smallest voidage of a cell. What a fuller cell cannot hold, and its part of "
                    "all forces, passes to the cells around it; the audit says how much. Equal "
                    "spheres fill a volume to 0.26 at most, the fluid solver is stable from 0.2."},
        voidage.smallest);
}

template <class Visit>
void describe(Visit& visit, SyamlalObrienSettings& law) {
  visit({.name = "dense_factor",
         .range = positive,
         .meaning = "c of B = c ε^1.28 up to ε = 0.85; tune it to a measured velocity of minimum "
                    "fluidisation."},
        law.dense_factor);
  visit(
      {.name = "dilute_exponent",
       .range = positive,
       .meaning = "d of B = ε^d above ε = 0.85; without a jump there if d = 1.28 + ln c/ln 0.85."},
      law.dilute_exponent);
}

template <class Visit>
void describe(Visit& visit, DragConstantSettings& constant) {
  visit({.name = "value", .required = true, .meaning = "In `unit`."}, constant.value);
  visit({.name = "unit",
         .otherwise = "`1`",
         .meaning = "SI, of m, s, kg, N, Pa, J, W: products with `.`, powers as digits, e.g. "
                    "`Pa.s`, `kg/(m3.s)`; `1`: a plain number."},
        constant.unit);
}

template <class Visit>
void describe(Visit& visit, DragExpressionSettings& law) {
  visit({.name = "coefficient",
         .required = true,
         .meaning = "Formula whose unit tells what it gives: kg/s, force on one sphere over slip; "
                    "or kg/(m³ s), momentum exchange per volume of bed, β. As for model A: with "
                    "`model: b` it is divided by the voidage. Variables: `voidage`, `diameter` "
                    "(m), `slip` (m/s, interstitial), `density` (kg/m³) and `viscosity` (Pa s) of "
                    "the fluid, `reynolds` (voidage·density·slip·diameter/viscosity), `volume` "
                    "(of the sphere, m³). Numbers are dimensionless. `+ - * / ^`, comparisons, "
                    "`?:`, sqrt, exp, ln, log10, tanh, atan, abs, min, max, pi."},
        law.coefficient);
  visit({.name = "constants",
         .meaning = "Numbers of the formula that have a unit, or deserve a name."},
        law.constants);
  visit({.name = "voidage",
         .range = {.lower = 0, .upper = 1, .without_lower = true},
         .otherwise = "`[0.2, 1]`",
         .meaning = "Where `check` tries the formula, with all diameters that the scene names: "
                    "not finite or negative there is an error of the scene, elsewhere during the "
                    "run one that stops it."},
        law.voidage);
  visit({.name = "slip",
         .dimension = Dimension::velocity,
         .range = not_negative,
         .otherwise = "`[0, 50]`",
         .meaning = "As `voidage`."},
        law.slip);
}

template <class Visit>
void describe(Visit& visit, LubricationSettings& lubrication) {
  visit({.name = "roughness",
         .dimension = Dimension::length,
         .range = positive,
         .required = true,
         .meaning = "Height of the asperities: the film is never thinner. It decides how long a "
                    "sub-step may be."},
        lubrication.roughness);
  visit({.name = "reach",
         .dimension = Dimension::length,
         .range = positive,
         .required = true,
         .meaning = "Gap between two surfaces below which the film acts; a tenth of the radius is "
                    "usual, and the theory holds well below the radius."},
        lubrication.reach);
}

template <class Visit>
void describe(Visit& visit, InterphaseSettings& interphase) {
  visit({.name = "model",
         .meaning = "Where the pressure gradient acts (Gidaspow 1994): `a`: on fluid and "
                    "particles, in proportion to their volume; `b`: on the fluid alone, with the "
                    "drag over the voidage; particles feel buoyancy."},
        interphase.model);
  visit({.name = "voidage",
         .meaning = "Map between particles and cells: a section, or its `map` alone."},
        interphase.voidage);
  visit(
      {.name = "drag",
       .meaning = "Of packed to dilute beds: `gidaspow` (1994), `huilin_gidaspow` (its smooth "
                  "blend, 2003), `di_felice` (1994), `syamlal_obrien` (1987), `koch_hill` (2001), "
                  "`beetstra` (2007), `tang` (2015). Packed: `ergun` (1952). Dilute: `wen_yu` "
                  "(1966). Single spheres: `schiller_naumann` (1933), `stokes` (1851). "
                  "`expression`: a formula of your own. docs/theory.md says where each holds."},
      interphase.drag);
  visit({.name = "syamlal_obrien",
         .applies = interphase.drag == DragLaw::syamlal_obrien,
         .only_with = "drag: syamlal_obrien",
         .meaning = "Its two constants."},
        interphase.syamlal_obrien);
  visit({.name = "drag_expression",
         .required = true,
         .applies = interphase.drag == DragLaw::expression,
         .only_with = "drag: expression",
         .meaning = "The formula."},
        interphase.drag_expression);
  visit({.name = "self_disturbance",
         .meaning = "`corrected`: the drag is that of the flow without the share of it that the "
                    "particle itself has slowed down in its cells, for single particles in cells "
                    "of five diameters and more (`exact`, `centroid`, `satellite`). `none`: that "
                    "of the flow as it is, as drag laws of beds mean it. docs/theory.md, section "
                    "3."},
        interphase.self_disturbance);
  visit({.name = "forces",
         .meaning = "Further forces of the fluid on the particles (docs/theory.md, section 3): "
                    "`pressure_gradient`, buoyancy included; `viscous`: the divergence of the "
                    "fluid's viscous stress (model a); `added_mass`, of liquids; `saffman_lift` in "
                    "shear; `magnus_lift` of spinning spheres; `turbulent_dispersion` by the "
                    "eddies of `model: k_epsilon`; `lubrication` by the film between surfaces that "
                    "come close."},
        interphase.forces);
  const auto asked = [&](InterphaseForce force) {
    return std::ranges::find(interphase.forces, force) != interphase.forces.end();
  };
  visit({.name = "added_mass_crowding",
         .applies = asked(InterphaseForce::added_mass),
         .only_with = "forces: [added_mass]",
         .meaning = "How the coefficient of added mass, 1/2 of a sphere alone, grows with the "
                    "solid fraction φ: not, or by (1 + 2 φ)/(1 - φ) (Zuber 1964)."},
        interphase.added_mass_crowding);
  visit({.name = "dispersion_seed",
         .range = not_negative,
         .applies = asked(InterphaseForce::turbulent_dispersion),
         .only_with = "forces: [turbulent_dispersion]",
         .meaning = "Of the random eddies of `turbulent_dispersion`: the same seed gives the same "
                    "eddies."},
        interphase.dispersion_seed);
  visit({.name = "lubrication",
         .required = true,
         .applies = asked(InterphaseForce::lubrication),
         .only_with = "forces: [lubrication]",
         .meaning = "The film of fluid between surfaces that come close."},
        interphase.lubrication);
  visit({.name = "prescribed",
         .otherwise = "not set; required with `voidage: prescribed`",
         .meaning = "A solid phase at rest given by a formula, for verification."},
        interphase.prescribed);
}

}  // namespace fluxpact
