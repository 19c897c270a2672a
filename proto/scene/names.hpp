// The words that stand for the choices of a scene: one table for each enum, used to read, to write,
// for the reference and for messages anywhere.
#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "proto/scene/scene.hpp"

namespace fluxpact {

template <class Enum>
struct Named {
  Enum value{};
  std::string_view name;
};

/// All values of an enum of the scene in the order of the documentation; specialised for each
/// below.
template <class Enum>
inline constexpr int enum_names = 0;

template <>
inline constexpr auto enum_names<Continuity> = std::to_array<Named<Continuity>>({
    {Continuity::conservative, "conservative"},
    {Continuity::legacy, "legacy"},
});
template <>
inline constexpr auto enum_names<LegacyVelocity> = std::to_array<Named<LegacyVelocity>>({
    {LegacyVelocity::faces, "faces"},
    {LegacyVelocity::cells, "cells"},
});
template <>
inline constexpr auto enum_names<OnViolation> = std::to_array<Named<OnViolation>>({
    {OnViolation::stop, "stop"},
    {OnViolation::warn, "warn"},
});
template <>
inline constexpr auto enum_names<CouplingScheme> = std::to_array<Named<CouplingScheme>>({
    {CouplingScheme::serial, "serial"},
    {CouplingScheme::parallel, "parallel"},
});
template <>
inline constexpr auto enum_names<LaunchMode> = std::to_array<Named<LaunchMode>>({
    {LaunchMode::local, "local"},
    {LaunchMode::external, "external"},
});
template <>
inline constexpr auto enum_names<Security> = std::to_array<Named<Security>>({
    {Security::none, "none"},
});
template <>
inline constexpr auto enum_names<Side> = std::to_array<Named<Side>>({
    {Side::x_min, "x_min"},
    {Side::x_max, "x_max"},
    {Side::y_min, "y_min"},
    {Side::y_max, "y_max"},
    {Side::z_min, "z_min"},
    {Side::z_max, "z_max"},
});
template <>
inline constexpr auto enum_names<Axis> = std::to_array<Named<Axis>>({
    {Axis::x, "x"},
    {Axis::y, "y"},
    {Axis::z, "z"},
});
template <>
inline constexpr auto enum_names<BoundaryType> = std::to_array<Named<BoundaryType>>({
    {BoundaryType::velocity, "velocity"},
    {BoundaryType::mass_flow, "mass_flow"},
    {BoundaryType::pressure, "pressure"},
    {BoundaryType::wall, "wall"},
});
template <>
inline constexpr auto enum_names<Slip> = std::to_array<Named<Slip>>({
    {Slip::none, "none"},
    {Slip::free, "free"},
    {Slip::partial, "partial"},
});
template <>
inline constexpr auto enum_names<Along> = std::to_array<Named<Along>>({
    {Along::time, "time"},
    {Along::x, "x"},
    {Along::y, "y"},
    {Along::z, "z"},
});
template <>
inline constexpr auto enum_names<TimeScheme> = std::to_array<Named<TimeScheme>>({
    {TimeScheme::euler, "euler"},
    {TimeScheme::bdf2, "bdf2"},
});
template <>
inline constexpr auto enum_names<PressureModel> = std::to_array<Named<PressureModel>>({
    {PressureModel::a, "a"},
    {PressureModel::b, "b"},
});
template <>
inline constexpr auto enum_names<Convection> = std::to_array<Named<Convection>>({
    {Convection::upwind, "upwind"},
    {Convection::linear_upwind, "linear_upwind"},
    {Convection::limited, "limited"},
});
template <>
inline constexpr auto enum_names<ScalarKind> = std::to_array<Named<ScalarKind>>({
    {ScalarKind::species, "species"},
    {ScalarKind::temperature, "temperature"},
});
template <>
inline constexpr auto enum_names<TurbulenceModel> = std::to_array<Named<TurbulenceModel>>({
    {TurbulenceModel::none, "none"},
    {TurbulenceModel::smagorinsky, "smagorinsky"},
    {TurbulenceModel::k_epsilon, "k_epsilon"},
});
template <>
inline constexpr auto enum_names<FluidBackend> = std::to_array<Named<FluidBackend>>({
    {FluidBackend::native, "native"},
});
template <>
inline constexpr auto enum_names<LinearSolverChoice> = std::to_array<Named<LinearSolverChoice>>({
    {LinearSolverChoice::automatic, "automatic"},
    {LinearSolverChoice::multigrid, "multigrid"},
    {LinearSolverChoice::conjugate_gradient, "conjugate_gradient"},
});
template <>
inline constexpr auto enum_names<Precision> = std::to_array<Named<Precision>>({
    {Precision::full, "double"},
    {Precision::mixed, "mixed"},
});
template <>
inline constexpr auto enum_names<ParticleBackend> = std::to_array<Named<ParticleBackend>>({
    {ParticleBackend::native, "native"},
    {ParticleBackend::hard_sphere, "hard_sphere"},
    {ParticleBackend::lammps, "lammps"},
    {ParticleBackend::liggghts, "liggghts"},
    {ParticleBackend::yade, "yade"},
    {ParticleBackend::kinematic, "kinematic"},
    {ParticleBackend::custom, "custom"},
});
template <>
inline constexpr auto enum_names<ContactLaw> = std::to_array<Named<ContactLaw>>({
    {ContactLaw::linear, "linear"},
    {ContactLaw::hertz, "hertz"},
});
template <>
inline constexpr auto enum_names<RollingLaw> = std::to_array<Named<RollingLaw>>({
    {RollingLaw::none, "none"},
    {RollingLaw::constant_torque, "constant_torque"},
    {RollingLaw::spring_dashpot, "spring_dashpot"},
});
template <>
inline constexpr auto enum_names<CohesionLaw> = std::to_array<Named<CohesionLaw>>({
    {CohesionLaw::none, "none"},
    {CohesionLaw::sjkr, "sjkr"},
    {CohesionLaw::jkr, "jkr"},
    {CohesionLaw::liquid_bridge, "liquid_bridge"},
});
template <>
inline constexpr auto enum_names<InsertionType> = std::to_array<Named<InsertionType>>({
    {InsertionType::packing, "packing"},
    {InsertionType::settled, "settled"},
    {InsertionType::lattice, "lattice"},
    {InsertionType::file, "file"},
});
template <>
inline constexpr auto enum_names<Mobility> = std::to_array<Named<Mobility>>({
    {Mobility::free, "free"},
    {Mobility::fixed, "fixed"},
});
template <>
inline constexpr auto enum_names<SizeDistribution> = std::to_array<Named<SizeDistribution>>({
    {SizeDistribution::table, "table"},
    {SizeDistribution::uniform, "uniform"},
    {SizeDistribution::normal, "normal"},
    {SizeDistribution::lognormal, "lognormal"},
});
template <>
inline constexpr auto enum_names<SizeWeight> = std::to_array<Named<SizeWeight>>({
    {SizeWeight::number, "number"},
    {SizeWeight::mass, "mass"},
});
template <>
inline constexpr auto enum_names<Overlaps> = std::to_array<Named<Overlaps>>({
    {Overlaps::refuse, "refuse"},
    {Overlaps::relax, "relax"},
});
template <>
inline constexpr auto enum_names<WallSource> = std::to_array<Named<WallSource>>({
    {WallSource::from_mesh, "from_mesh"},
    {WallSource::none, "none"},
});
template <>
inline constexpr auto enum_names<MotionType> = std::to_array<Named<MotionType>>({
    {MotionType::none, "none"},
    {MotionType::translation, "translation"},
    {MotionType::rotation, "rotation"},
    {MotionType::vibration, "vibration"},
});
template <>
inline constexpr auto enum_names<SurfaceType> = std::to_array<Named<SurfaceType>>({
    {SurfaceType::plane, "plane"},
    {SurfaceType::cylinder, "cylinder"},
    {SurfaceType::cone, "cone"},
    {SurfaceType::stl, "stl"},
});
template <>
inline constexpr auto enum_names<SurfaceSide> = std::to_array<Named<SurfaceSide>>({
    {SurfaceSide::both, "both"},
    {SurfaceSide::inside, "inside"},
    {SurfaceSide::outside, "outside"},
});
template <>
inline constexpr auto enum_names<VoidageMap> = std::to_array<Named<VoidageMap>>({
    {VoidageMap::exact, "exact"},
    {VoidageMap::centroid, "centroid"},
    {VoidageMap::satellite, "satellite"},
    {VoidageMap::kernel, "kernel"},
    {VoidageMap::diffusion, "diffusion"},
    {VoidageMap::prescribed, "prescribed"},
});
template <>
inline constexpr auto enum_names<DiffusedMap> = std::to_array<Named<DiffusedMap>>({
    {DiffusedMap::exact, "exact"},
    {DiffusedMap::centroid, "centroid"},
});
template <>
inline constexpr auto enum_names<DragLaw> = std::to_array<Named<DragLaw>>({
    {DragLaw::none, "none"},
    {DragLaw::gidaspow, "gidaspow"},
    {DragLaw::ergun, "ergun"},
    {DragLaw::wen_yu, "wen_yu"},
    {DragLaw::stokes, "stokes"},
    {DragLaw::di_felice, "di_felice"},
    {DragLaw::koch_hill, "koch_hill"},
    {DragLaw::beetstra, "beetstra"},
    {DragLaw::tang, "tang"},
    {DragLaw::syamlal_obrien, "syamlal_obrien"},
    {DragLaw::schiller_naumann, "schiller_naumann"},
    {DragLaw::huilin_gidaspow, "huilin_gidaspow"},
    {DragLaw::expression, "expression"},
});
template <>
inline constexpr auto enum_names<InterphaseForce> = std::to_array<Named<InterphaseForce>>({
    {InterphaseForce::pressure_gradient, "pressure_gradient"},
    {InterphaseForce::viscous, "viscous"},
    {InterphaseForce::added_mass, "added_mass"},
    {InterphaseForce::saffman_lift, "saffman_lift"},
    {InterphaseForce::magnus_lift, "magnus_lift"},
    {InterphaseForce::turbulent_dispersion, "turbulent_dispersion"},
    {InterphaseForce::lubrication, "lubrication"},
});
template <>
inline constexpr auto enum_names<Crowding> = std::to_array<Named<Crowding>>({
    {Crowding::none, "none"},
    {Crowding::zuber, "zuber"},
});
template <>
inline constexpr auto enum_names<SelfDisturbance> = std::to_array<Named<SelfDisturbance>>({
    {SelfDisturbance::none, "none"},
    {SelfDisturbance::corrected, "corrected"},
});

/// The word for a value.
template <class Enum>
std::string_view name_of(Enum value) {
  for (const auto& entry : enum_names<Enum>) {
    if (entry.value == value) {
      return entry.name;
    }
  }
  throw std::logic_error("a value of an enum of the scene has no name in proto/scene/names.hpp");
}

/// The value for a word; nothing if there is none.
template <class Enum>
std::optional<Enum> value_of(std::string_view name) {
  for (const auto& entry : enum_names<Enum>) {
    if (entry.name == name) {
      return entry.value;
    }
  }
  return std::nullopt;
}

}  // namespace fluxpact
