// Both sides in one process, window by window as the coordinator has them: what the fluid does to
// one sphere and the sphere to the fluid.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cfd_server/backends/native/fluid_participant.hpp"
#include "dem_server/participant/particle_participant.hpp"
#include "proto/mesh/box.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact {

class Coupled {
 public:
  /// `make_engine`: with the particles in it.
  Coupled(const Scene& scene, const EngineFactory& make_engine)
      : mesh(make_box(scene.fluid.mesh)),
        window_(scene.coupling.window),
        particles("test", make_engine) {
    particles.configure(scene, mesh);
    fluid.configure(scene, mesh);
    Fields nothing;
    particles.start(nothing, from_particles);
    Fields in;
    in.add(field::voidage, from_particles.scalars(field::voidage, mesh.cells()));
    fluid.start(in, from_fluid);
    keep();
  }

  /// One window. One-way: the particles see the fluid as it was at time 0, and it does not move.
  void advance(bool two_way = true) {
    const Window window{++step, static_cast<double>(step - 1) * window_, window_};
    Fields in;
    in.add(field::velocity, velocity);
    in.add(field::pressure_gradient, gradient);
    from_particles = Fields();
    particles.advance(window, in, from_particles, [] {});
    if (two_way) {
      Fields solids;
      solids.add(field::voidage, from_particles.scalars(field::voidage, mesh.cells()));
      solids.add(field::drag_coefficient,
                 from_particles.scalars(field::drag_coefficient, mesh.cells()));
      solids.add(field::drag_source, from_particles.vectors(field::drag_source, mesh.cells()));
      from_fluid = Fields();
      fluid.advance(window, solids, from_fluid, [] {});
      fluid.commit();
      keep();
    }
    particles.commit();
  }

  std::span<const double> pressure() const {
    return from_fluid.scalars(field::pressure, mesh.cells());
  }
  /// By the fluid to all particles in the last window [N s].
  Vector3 impulse_given() const {
    Vector3 sum = Vector3::Zero();
    for (const Vector3& cell : from_particles.vectors(field::impulse_given, mesh.cells())) {
      sum += cell;
    }
    return sum;
  }
  Vector3 particle(const char* name) {
    Fields out;
    particles.snapshot(out);
    return out.vectors(name, 1).front();
  }

  Mesh mesh;

 private:
  void keep() {
    const auto u = from_fluid.vectors(field::velocity, mesh.cells());
    const auto g = from_fluid.vectors(field::pressure_gradient, mesh.cells());
    velocity.assign(u.begin(), u.end());
    gradient.assign(g.begin(), g.end());
  }

  double window_ = 0;
  std::int64_t step = 0;
  ParticleParticipant particles;
  NativeFluid fluid;
  Fields from_particles;
  Fields from_fluid;
  std::vector<Vector3> velocity;
  std::vector<Vector3> gradient;
};

struct NamedMap {
  std::string name;
  VoidageSettings settings;
};

/// All maps; kernel and diffusion with a width [m].
inline std::vector<NamedMap> all_maps(double width) {
  std::vector<NamedMap> maps;
  for (const auto& [map, name] :
       {std::pair(VoidageMap::centroid, "centroid"), std::pair(VoidageMap::satellite, "satellite"),
        std::pair(VoidageMap::exact, "exact"), std::pair(VoidageMap::kernel, "kernel"),
        std::pair(VoidageMap::diffusion, "diffusion")}) {
    VoidageSettings settings(map);
    settings.width = width;
    maps.push_back({name, settings});
  }
  return maps;
}

inline ParticleState single_sphere(const Vector3& position, const Vector3& velocity,
                                   double diameter, double density) {
  return {{1}, {position}, {velocity}, {Vector3::Zero()}, {0.5 * diameter}, {density}, {0}};
}

}  // namespace fluxpact
