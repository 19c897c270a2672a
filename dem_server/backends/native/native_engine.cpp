#include "dem_server/backends/native/native_engine.hpp"

#include "dem_server/backends/native/soft_spheres.hpp"

namespace fluxpact {
namespace {

template <class Real>
std::unique_ptr<ParticleEngine> make_engine(const Scene& scene, const Mesh& mesh,
                                            ParticleState initial) {
  const LubricationSettings& lubrication = scene.interphase.lubrication;
  std::optional<Film> film;
  if (has_force(scene, InterphaseForce::lubrication)) {
    film = Film{scene.fluid.viscosity, lubrication.roughness, lubrication.reach};
  }
  ContactLaws laws(scene.particles, film);
  if (laws.any_friction()) {
    return std::make_unique<SoftSpheres<Real, true>>(scene, mesh, std::move(laws),
                                                     std::move(initial));
  }
  return std::make_unique<SoftSpheres<Real, false>>(scene, mesh, std::move(laws),
                                                    std::move(initial));
}

}  // namespace

std::unique_ptr<ParticleEngine> make_native_engine(const Scene& scene, const Mesh& mesh,
                                                   ParticleState initial) {
  if (scene.particles.numerics.precision == Precision::mixed) {
    return make_engine<float>(scene, mesh, std::move(initial));
  }
  return make_engine<double>(scene, mesh, std::move(initial));
}

}  // namespace fluxpact
