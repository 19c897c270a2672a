// The scene in LAMMPS' own commands: box, walls, the law of contacts. Text only.
//
// Types of atoms: material + 1, and as many more for those that are fixed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/native/contact_law.hpp"
#include "dem_server/backends/particle_engine.hpp"

namespace fluxpact {

struct LammpsScript {
  std::optional<double> mass;       ///< [kg] of every sphere, if the law is made for one
  std::vector<std::string> start;   ///< once
  std::vector<std::string> groups;  ///< whenever atoms were put in
  /// Whenever atoms were put in, after `groups`: LAMMPS of 2021 turns the coefficient of `damping
  /// tsuji` of a wall into another one each time a run is set up.
  std::vector<std::string> walls;
};

struct LammpsScene {
  const Domain& domain;
  const ContactLaws& laws;
  Vector3 gravity;
  const ParticleState& spheres;
  bool more_to_come = false;  ///< spheres whose masses are not known yet
};

/// The coefficient c of `damping tsuji` with which LAMMPS makes the dashpot `share` sqrt(k m*): the
/// root of its polynomial for `share` in [0, 2.5].
double tsuji_coefficient(double share);

LammpsScript lammps_script(const LammpsScene& scene);

int lammps_type(const ParticleState& spheres, int materials, int row);

}  // namespace fluxpact
