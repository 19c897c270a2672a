// A cloud of spheres of mixed sizes with random velocities in a box of 3 cm.
#pragma once

#include "dem_server/insertion/packing.hpp"
#include "dem_server/insertion/random.hpp"
#include "tests/unit/dem_server/native/spheres_in_a_box.hpp"

namespace fluxpact {

inline constexpr double cloud_box = 0.03;  ///< [m]

inline Scene cloud_scene(std::vector<Axis> periodic) {
  Scene scene = box_scene(Vector3::Constant(cloud_box), std::move(periodic));
  add_laws(scene, 1000, 0.9, 0.3);
  return scene;
}

/// Diameters between 0.7 and 1 of what packs `count` spheres to 40 %, speeds up to `speed` [m/s] in
/// each direction.
inline ParticleState random_cloud(int count, double speed) {
  const double diameter = cloud_box * std::cbrt(0.4 * 6 / (3.14159 * count));
  const PackingBox box{Vector3::Zero(), Vector3::Constant(cloud_box), {}};
  const auto centres = random_packing(box, count, diameter, 1);
  UniformRandom random(2);
  ParticleState state;
  for (const Vector3& centre : centres.value()) {
    const Vector3 direction(random.next() - 0.5, random.next() - 0.5, random.next() - 0.5);
    add_sphere(state, centre, 2 * speed * direction, 0.5 * diameter * (0.7 + 0.3 * random.next()));
  }
  return state;
}

}  // namespace fluxpact
