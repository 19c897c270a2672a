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
