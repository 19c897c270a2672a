// A valid scene that uses every section, and what reading a variant of it says.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "proto/base/errors.hpp"
#include "proto/scene/read_scene.hpp"

namespace fluxpact {

// Line numbers below are those that messages name.
inline const std::string valid_scene = R"(version: 1
scene:
  name: test
  gravity: [0, 0, -9.81]
  end_time: 0.1
coupling:
  window: 1.0e-3
  scheme: serial
  continuity: conservative
  audit: {limit: 1.0e-10, on_violation: stop}
fluid:
  backend: native
  density: 1.225
  viscosity: 1.8e-5
  mesh:
    box: {lower: [0, 0, 0], upper: [0.1, 0.1, 0.2], cells: [4, 4, 8]}
    periodic: [y]
    patches:
      jet: {side: z_min, within: {x: [0.04, 0.06]}}
      inlet: {side: z_min}
      outlet: {side: z_max}
  boundaries:
    jet: {type: velocity, interstitial: [0, 0, 5]}
    inlet: {type: mass_flow, rate: 0.001}
    outlet: {type: pressure, value: 10}
    walls: {type: wall, slip: free}
  initial: {superficial: [0, 0, 1]}
  numerics: {convection: upwind, correctors: 3, pressure_tolerance: 1e-5, solver: multigrid, legacy: {tolerance: 1e-3, iterations: 7, velocity: cells}}
particles:
  backend: native
  time_step: 1.0e-4
  materials:
    glass: {density: 2250}
    steel: {density: 7800}
  contact:
    law: linear
    pairs:
      - {between: [glass, glass], normal_stiffness: 1000, restitution: 0.8, friction: 0.2}
      - {between: [steel, glass], normal_stiffness: 2000, tangential_stiffness: 500}
      - {between: [steel, steel], normal_stiffness: 3000}
      - {between: [glass, walls], normal_stiffness: 4000}
      - {between: [walls, steel], normal_stiffness: 5000}
  walls: from_mesh
  insertion:
    - {type: packing, material: glass, diameter: 2 mm, count: 10, within: {z: [0, 0.1]}, seed: 3, velocity: [0, 0, 1]}
    - {type: lattice, material: steel, diameter: 0.003}
    - {type: file, material: glass, path: "bed.csv"}
  numerics: {threads: 2}
interphase:
  voidage: centroid
  drag: wen_yu
  forces: []
output:
  directory: runs/elsewhere
  fields: {every: 0.01}
  particles: {every: 0.02}
launch:
  mode: external
  listen: "tcp://127.0.0.1:5555"
  deadline: 20
  start_deadline: 10
)";

/// The text with one occurrence of `old_part` replaced; fails the test if it does not stand there
/// exactly once.
inline std::string replaced(std::string text, const std::string& old_part,
                            const std::string& new_part) {
  const std::size_t at = text.find(old_part);
  EXPECT_NE(at, std::string::npos) << "not in the scene: " << old_part;
  EXPECT_EQ(text.find(old_part, at + 1), std::string::npos) << "twice in the scene: " << old_part;
  return at == std::string::npos ? text : text.replace(at, old_part.size(), new_part);
}

inline std::string with(const std::string& old_part, const std::string& new_part) {
  return replaced(valid_scene, old_part, new_part);
}

/// What read_scene says, or nothing if it reads the text.
inline std::string errors_in(const std::string& text,
                             const std::vector<std::string>& overrides = {}) {
  try {
    read_scene(text, "s.yaml", overrides);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

/// Exactly one error, which starts with `start` (place and key) and contains each of `fragments`.
inline void expect_error(const std::string& text, const std::string& start,
                         const std::vector<std::string>& fragments,
                         const std::vector<std::string>& overrides = {}) {
  const std::string errors = errors_in(text, overrides);
  EXPECT_EQ(errors.find('\n'), std::string::npos) << "more than one error:\n" << errors;
  EXPECT_EQ(errors.substr(0, start.size()), start) << errors;
  for (const std::string& fragment : fragments) {
    EXPECT_NE(errors.find(fragment), std::string::npos) << "no `" << fragment << "` in: " << errors;
  }
}

}  // namespace fluxpact
