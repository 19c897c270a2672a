#include <gtest/gtest.h>

#include "bench.hpp"
#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/kinematic/kinematic_engine.hpp"
#include "dem_server/backends/native/native_engine.hpp"
#include "dem_server/participant/particle_server.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

using testing_bench::Bench;

std::unique_ptr<Participant> particle_side(const std::string& backend) {
  return make_particle_participant(
      backend, {{ParticleBackend::native, {}, make_native_engine},
                {ParticleBackend::kinematic, check_box_mesh, make_kinematic_engine}});
}

TEST(MakeParticleParticipant, refuses_an_engine_that_the_scene_does_not_ask_for) {
  EXPECT_THROW(particle_side("lammps"), ConfigError);
  Bench bench;
  bench.scene.particles.backend = ParticleBackend::kinematic;
  const auto side = particle_side("native");
  EXPECT_EQ(side->identity().backend, "native");
  EXPECT_THROW(side->configure(bench.scene, bench.mesh), ConfigError);
}

TEST(MakeParticleParticipant, takes_part_with_an_engine_or_with_prescribed_solids) {
  Bench bench;
  bench.scene.particles.backend = ParticleBackend::kinematic;
  bench.scene.particles.materials["glass"].density = 2500;
  InsertionSettings insertion;
  insertion.type = InsertionType::packing;
  insertion.material = "glass";
  insertion.diameter = 0.02;
  insertion.count = 25;
  bench.scene.particles.insertion = {insertion};
  const auto moving = particle_side("kinematic");
  moving->configure(bench.scene, bench.mesh);
  Fields out;
  moving->start({}, out);
  EXPECT_EQ(out.number(field::particle_count), 25);

  bench.scene.interphase.voidage = VoidageMap::prescribed;
  bench.scene.interphase.prescribed = PrescribedSettings{"0.5", 1e-3};
  const auto solids = particle_side("native");
  solids->configure(bench.scene, bench.mesh);
  Fields given;
  solids->start({}, given);
  EXPECT_EQ(given.scalars(field::voidage, 27)[13], 0.5);
}

}  // namespace
}  // namespace fluxpact
