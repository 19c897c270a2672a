// The contact laws: which keys go with which.
#include <fmt/format.h>

#include "tests/unit/proto/scene/scene_text.hpp"

namespace fluxpact {
namespace {

/// The valid scene with Hertz' law, rolling springs and the pair keys given.
std::string hertz_scene(const std::string& contact, const std::string& pair_keys) {
  std::string text = with("glass: {density: 2250}",
                          "glass: {density: 2250, youngs_modulus: 5 MPa, poisson_ratio: 0.25}");
  text = replaced(text, "steel: {density: 7800}",
                  "steel: {density: 7800, youngs_modulus: 2 GPa, poisson_ratio: 0.3}");
  text = replaced(text, "    law: linear\n", contact);
  text = replaced(text, "[glass, glass], normal_stiffness: 1000", "[glass, glass]" + pair_keys);
  text = replaced(text, "[steel, glass], normal_stiffness: 2000, tangential_stiffness: 500",
                  "[steel, glass]" + pair_keys);
  text = replaced(text, "[steel, steel], normal_stiffness: 3000", "[steel, steel]" + pair_keys);
  text = replaced(text, "[glass, walls], normal_stiffness: 4000", "[glass, walls]" + pair_keys);
  return replaced(text, "[walls, steel], normal_stiffness: 5000", "[walls, steel]" + pair_keys);
}

const std::string hertz =
    "    law: hertz\n    walls: {youngs_modulus: 70 GPa, poisson_ratio: 0.33}\n";
const std::string wet = ", liquid_volume: 0.01 mm3, surface_tension: 0.072, contact_angle: 0.2 rad";

/// One of the errors starts with `start`, its place in the file left out or not, and has
/// `fragments` in its line.
void expect_line(const std::string& text, const std::string& start,
                 const std::vector<std::string>& fragments) {
  const std::string errors = fmt::format("\n{}", errors_in(text));
  const std::size_t at = errors.find((start.starts_with("s.yaml") ? "\n" : ": ") + start);
  ASSERT_NE(at, std::string::npos) << "no `" << start << "` in:" << errors;
  const std::string line = errors.substr(at + 1, errors.find('\n', at + 1) - at - 1);
  for (const std::string& fragment : fragments) {
    EXPECT_NE(line.find(fragment), std::string::npos) << "no `" << fragment << "` in: " << line;
  }
}

TEST(SceneContact, gives_every_value_of_the_text) {
  const std::string text =
      hertz_scene(hertz + "    rolling: spring_dashpot\n    cohesion: liquid_bridge\n",
                  ", rolling_friction: 0.05, rolling_damping: 0.4" + wet);
  const Scene scene = read_scene(write_scene(read_scene(text, "s.yaml")), "written");
  EXPECT_EQ(scene.particles.materials.at("glass").youngs_modulus, 5e6);
  EXPECT_EQ(scene.particles.materials.at("glass").poisson_ratio, 0.25);
  const ContactSettings& contact = scene.particles.contact;
  EXPECT_EQ(contact.law, ContactLaw::hertz);
  EXPECT_EQ(contact.rolling, RollingLaw::spring_dashpot);
  EXPECT_EQ(contact.cohesion, CohesionLaw::liquid_bridge);
  EXPECT_EQ(contact.walls->youngs_modulus, 7e10);
  EXPECT_EQ(contact.walls->poisson_ratio, 0.33);
  for (const PairSettings& pair : contact.pairs) {
    EXPECT_EQ(pair.rolling_friction, 0.05);
    EXPECT_EQ(pair.rolling_damping, 0.4);
    EXPECT_EQ(pair.liquid_volume, 1e-11);
    EXPECT_EQ(pair.surface_tension, 0.072);
    EXPECT_EQ(pair.contact_angle, 0.2);
    EXPECT_FALSE(pair.normal_stiffness || pair.tangential_stiffness);
    EXPECT_FALSE(pair.cohesion_energy_density);
  }
}

TEST(SceneContact, fills_in_what_follows_from_other_keys) {
  const Scene linear = read_scene(valid_scene, "s.yaml");
  EXPECT_EQ(linear.particles.contact.pairs[0].tangential_stiffness, 2.0 / 7 * 1000);
  EXPECT_FALSE(linear.particles.contact.pairs[0].rolling_damping);
  const Scene rolling = read_scene(
      hertz_scene(hertz + "    rolling: spring_dashpot\n", ", rolling_friction: 0.05"), "s.yaml");
  EXPECT_EQ(rolling.particles.contact.pairs[0].rolling_damping, 0.3);
  EXPECT_FALSE(rolling.particles.contact.pairs[0].tangential_stiffness);
}

TEST(SceneContact, names_what_a_law_needs) {
  expect_line(with("[steel, glass], normal_stiffness: 2000, ", "[steel, glass], "),
              "s.yaml:39:9: particles.contact.pairs[1].normal_stiffness: missing",
              {"particles.contact.law: linear"});
  expect_line(replaced(hertz_scene(hertz, ""), ", poisson_ratio: 0.25}", "}"),
              "s.yaml:33:5: particles.materials.glass.poisson_ratio: missing",
              {"particles.contact.law: hertz"});
  expect_line(hertz_scene("    law: hertz\n", ""), "s.yaml:35:3: particles.contact.walls: missing",
              {"youngs_modulus"});
  expect_line(hertz_scene(hertz + "    rolling: constant_torque\n", ""),
              "s.yaml:40:9: particles.contact.pairs[0].rolling_friction: missing",
              {"rolling: constant_torque"});
  expect_line(hertz_scene(hertz + "    cohesion: sjkr\n", ""),
              "s.yaml:40:9: particles.contact.pairs[0].cohesion_energy_density: missing",
              {"cohesion: sjkr"});
  expect_line(hertz_scene(hertz + "    cohesion: jkr\n", ""),
              "s.yaml:40:9: particles.contact.pairs[0].work_of_adhesion: missing",
              {"cohesion: jkr"});
  for (const char* key : {"liquid_volume", "surface_tension", "contact_angle"}) {
    expect_line(hertz_scene(hertz + "    cohesion: liquid_bridge\n", ""),
                fmt::format("s.yaml:40:9: particles.contact.pairs[0].{}: missing", key),
                {"cohesion: liquid_bridge"});
  }
}

TEST(SceneContact, names_what_has_no_meaning_with_a_law) {
  expect_line(with("steel: {density: 7800}", "steel: {density: 7800, youngs_modulus: 2 GPa}"),
              "s.yaml:34:44: particles.materials.steel.youngs_modulus: has no meaning here",
              {"particles.contact.law: hertz"});
  expect_line(with("    law: linear\n",
                   "    law: linear\n    walls: {youngs_modulus: 1e7, "
                   "poisson_ratio: 0.3}\n"),
              "s.yaml:37:5: particles.contact.walls: has no meaning here",
              {"particles.contact.law: hertz"});
  expect_line(hertz_scene(hertz, ", normal_stiffness: 100"),
              "s.yaml:39:53: particles.contact.pairs[0].normal_stiffness: has no meaning here",
              {"particles.contact.law: linear"});
  expect_line(hertz_scene(hertz, ", tangential_stiffness: 100"),
              "particles.contact.pairs[0].tangential_stiffness: has no meaning here", {});
  expect_line(hertz_scene(hertz, ", rolling_friction: 0.1"),
              "particles.contact.pairs[0].rolling_friction: has no meaning here",
              {"rolling: constant_torque | spring_dashpot"});
  expect_line(hertz_scene(hertz + "    rolling: constant_torque\n",
                          ", rolling_friction: 0.1, rolling_damping: 0.3"),
              "particles.contact.pairs[0].rolling_damping: has no meaning here",
              {"rolling: spring_dashpot"});
  expect_line(hertz_scene(hertz, ", cohesion_energy_density: 100"),
              "particles.contact.pairs[0].cohesion_energy_density: has no meaning here",
              {"cohesion: sjkr"});
  expect_line(hertz_scene(hertz, ", work_of_adhesion: 50 mJ/m2"),
              "particles.contact.pairs[0].work_of_adhesion: has no meaning here",
              {"cohesion: jkr"});
  expect_line(with("    law: linear\n", "    law: linear\n    cohesion: jkr\n"),
              "particles.contact.cohesion: `jkr`", {"law: hertz"});
  for (const char* key : {"liquid_volume", "surface_tension", "contact_angle"}) {
    expect_line(hertz_scene(hertz, wet),
                fmt::format("particles.contact.pairs[0].{}: has no meaning here", key),
                {"cohesion: liquid_bridge"});
  }
}

TEST(SceneContact, keeps_numbers_in_their_ranges) {
  expect_line(replaced(hertz_scene(hertz, ""), "poisson_ratio: 0.33", "poisson_ratio: 0.6"),
              "particles.contact.walls.poisson_ratio: `0.6` is out of range", {"<= 0.5"});
  expect_line(hertz_scene(hertz + "    cohesion: liquid_bridge\n", replaced(wet, "0.2 rad", "90")),
              "particles.contact.pairs[0].contact_angle: `90` is out of range", {});
}

}  // namespace
}  // namespace fluxpact
