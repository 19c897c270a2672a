// particles.backend: what an engine cannot do is refused under the key that asks for it.
#include "proto/scene/engine_abilities.hpp"
#include "proto/scene/names.hpp"
#include "tests/unit/proto/scene/scene_text.hpp"

namespace fluxpact {
namespace {

constexpr const char* backend_line = "particles:\n  backend: native\n";

std::string with_backend(const std::string& name) {
  return with(backend_line, "particles:\n  backend: " + name + "\n");
}

TEST(Backends, what_an_engine_cannot_do_is_refused_with_its_name) {
  expect_error(
      with_backend("kinematic\n  surfaces: {a: {type: plane, point: [0, 0, 0], normal: [0, "
                   "0, 1]}}"),
      "s.yaml:", {"particles.surfaces", "kinematic"});
  expect_error(with_backend("native\n  ranks: 2"), "s.yaml:", {"particles.ranks", "native", "MPI"});
}

TEST(Backends, hard_spheres_need_springs_only_to_settle_and_a_time_of_contact) {
  constexpr const char* pair = "[glass, glass], normal_stiffness: 1000,";
  const auto without_spring = [&](const std::string& text) {
    return replaced(text, pair, "[glass, glass], tangential_restitution: 0.4,");
  };
  const std::string hard = without_spring(with_backend("hard_sphere"));
  const Scene scene = read_scene(hard, "s.yaml");
  EXPECT_FALSE(scene.particles.contact.pairs[0].normal_stiffness);
  EXPECT_EQ(scene.particles.contact.pairs[0].tangential_restitution, 0.4);
  expect_error(replaced(hard,
                        "type: packing, material: glass, diameter: 2 mm, count: 10, within: "
                        "{z: [0, 0.1]}, seed: 3, velocity: [0, 0, 1]",
                        "type: settled, material: glass, diameter: 2 mm, count: 10"),
               "s.yaml:", {"pairs[0].normal_stiffness", "missing"});
  expect_error(replaced(hard, "  time_step: 1.0e-4\n", ""),
               "s.yaml:", {"particles.time_step", "missing", "hard_sphere"});
  // Springs have their tangential stiffness.
  expect_error(with(pair, std::string(pair) + " tangential_restitution: 0.4,"),
               "s.yaml:", {"pairs[0].tangential_restitution", "only with particles.backend"});
}

TEST(Backends, particles_come_and_go_on_one_rank_only) {
  EXPECT_EQ(read_scene(with_backend("lammps\n  outflow: []\n  ranks: 2"), "s.yaml").particles.ranks,
            2);
  expect_error(with_backend("lammps\n  ranks: 2"),
               "s.yaml:", {"particles.outflow", "on several ranks"});
  EXPECT_EQ(read_scene(with_backend("lammps"), "s.yaml").particles.ranks, 1);
}

TEST(Backends, a_program_is_named_by_custom_engines_and_only_by_them) {
  expect_error(with_backend("custom"), "s.yaml:", {"particles.program", "missing"});
  expect_error(with_backend("native\n  program: mine"),
               "s.yaml:", {"particles.program", "only with `backend: custom`"});
  EXPECT_EQ(read_scene(with_backend("custom\n  program: mine"), "s.yaml").particles.program,
            "mine");
}

TEST(Backends, springs_need_a_step_and_all_pairs_whoever_follows_them) {
  for (const auto& [backend, name] : enum_names<ParticleBackend>) {
    EXPECT_EQ(knows_contacts(backend) && backend != ParticleBackend::hard_sphere,
              knows_springs(backend))
        << name;
  }
}

}  // namespace
}  // namespace fluxpact
