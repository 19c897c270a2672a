// What must fit together: one test for each rule, with its place.
#include "proto/scene/endpoint.hpp"
#include "tests/unit/proto/scene/scene_text.hpp"

namespace fluxpact {
namespace {

const std::string prescribed_scene = R"(version: 1
scene: {name: step, end_time: 0.1}
coupling: {window: 1 ms}
fluid:
  density: 1
  viscosity: 1 Pa.s
  mesh:
    box: {upper: [1, 1, 1], cells: [4, 1, 1]}
    periodic: [x, y, z]
interphase:
  voidage: prescribed
  prescribed: {voidage: "x < 0.5 ? 0.42 : 1", diameter: 2 mm}
)";

TEST(SceneChecks, window_is_at_least_one_time_step) {
  expect_error(with("time_step: 1.0e-4", "time_step: 2.0e-3"),
               "s.yaml:31:14: particles.time_step: 0.002 s is longer", {"0.001"});
}

TEST(SceneChecks, time_step_is_needed_by_native_particles_only) {
  const std::string without = with("  time_step: 1.0e-4\n", "");
  expect_error(without, "s.yaml:29:1: particles.time_step: missing", {"native"});
  EXPECT_EQ(errors_in(without, {"particles.backend=kinematic"}), "");
  EXPECT_EQ(errors_in(without, {"particles.insertion=[]"}), "");
}

TEST(SceneChecks, end_time_is_a_whole_number_of_windows) {
  expect_error(with("end_time: 0.1", "end_time: 0.1005"),
               "s.yaml:5:13: scene.end_time: 0.1005 s is not a whole number",
               {"nearest: 0.1 or 0.101"});
  expect_error(with("end_time: 0.1", "end_time: 1e8"),
               "s.yaml:7:11: coupling.window: ", {"1e+11 windows"});
}

TEST(SceneChecks, a_ramp_needs_something_that_grows) {
  EXPECT_EQ(errors_in(with("value: 10}", "value: 10, ramp: 1 s}")), "");
  EXPECT_EQ(errors_in(with("slip: free}", "ramp: 1 s, velocity: [0, 0, 1]}")), "");
  EXPECT_NE(errors_in(with("slip: free}", "slip: free, ramp: 1 s}"))
                .find("fluid.boundaries.walls.ramp: has no meaning here"),
            std::string::npos);
}

TEST(SceneChecks, box_has_a_volume) {
  expect_error(with("upper: [0.1, 0.1, 0.2]", "upper: [0.1, 0, 0.2]"),
               "s.yaml:16:29: fluid.mesh.box.upper: 0 in y", {});
}

TEST(SceneChecks, a_mesh_comes_from_one_place) {
  const std::string box = "box: {lower: [0, 0, 0], upper: [0.1, 0.1, 0.2], cells: [4, 4, 8]}";
  expect_error(with(box, box + "\n    gmsh: {path: a.msh}"),
               "s.yaml:16:5: fluid.mesh.box: has no meaning here", {"neither polymesh nor gmsh"});
  expect_error(replaced(prescribed_scene,
                        "    box: {upper: [1, 1, 1], cells: [4, 1, 1]}\n    periodic: [x, y, z]\n",
                        "    gmsh: {path: a.msh}\n    polymesh: {path: a}\n"),
               "s.yaml:8:5: fluid.mesh.gmsh: has no meaning here", {});
  expect_error(replaced(prescribed_scene, "    box: {upper: [1, 1, 1], cells: [4, 1, 1]}\n", ""),
               "s.yaml:7:3: fluid.mesh.box: missing", {});
  expect_error(replaced(prescribed_scene, "box: {upper: [1, 1, 1], cells: [4, 1, 1]}",
                        "gmsh: {path: a.msh, scale: 1 mm}"),
               "s.yaml:8:32: fluid.mesh.gmsh.scale", {});
}

TEST(SceneChecks, patches_of_a_file_are_not_known_yet) {
  const std::string text = replaced(
      prescribed_scene, "    box: {upper: [1, 1, 1], cells: [4, 1, 1]}\n    periodic: [x, y, z]\n",
      "    polymesh: {path: a}\n  boundaries: {any: {type: wall}}\n");
  EXPECT_EQ(errors_in(text), "");
  EXPECT_EQ(errors_in(replaced(text, "type: wall", "type: velocity"))
                .find("s.yaml:9:16: fluid.boundaries.any: none of `superficial`"),
            0U);
}

TEST(SceneChecks, patches_have_faces_of_their_own) {
  expect_error(with("inlet: {side: z_min}", "inlet: {side: y_min}"),
               "s.yaml:20:7: fluid.mesh.patches.inlet: y_min is periodic", {});
  std::string text = with("outlet: {side: z_max}", "walls: {side: z_max}");
  text = replaced(text, "    outlet: {type: pressure, value: 10}\n", "");
  expect_error(text, "s.yaml:21:7: fluid.mesh.patches.walls: this name is taken", {});
}

TEST(SceneChecks, every_patch_has_one_condition) {
  expect_error(with("    outlet: {type: pressure, value: 10}\n", ""),
               "s.yaml:22:3: fluid.boundaries.outlet: missing", {});
  expect_error(with("    walls: {type: wall, slip: free}\n", ""),
               "s.yaml:22:3: fluid.boundaries.walls: missing", {});
  expect_error(with("    walls: {type: wall, slip: free}",
                    "    walls: {type: wall}\n    outlett: {type: wall}"),
               "s.yaml:27:5: fluid.boundaries.outlett: no such patch",
               {"nearest: `outlet`", "patches: jet, inlet, outlet, walls"});
  const std::string closed =
      replaced(prescribed_scene, "interphase:", "  boundaries: {walls: {type: wall}}\ninterphase:");
  expect_error(closed, "s.yaml:10:16: fluid.boundaries.walls: all faces belong", {});
}

TEST(SceneChecks, velocity_is_given_once) {
  expect_error(with("type: velocity, interstitial: [0, 0, 5]", "type: velocity"),
               "s.yaml:23:5: fluid.boundaries.jet: none of `superficial` and `interstitial`",
               {"exactly one"});
  expect_error(with("interstitial: [0, 0, 5]", "interstitial: [0, 0, 5], superficial: [0, 0, 5]"),
               "s.yaml:23:5: fluid.boundaries.jet: each of", {"exactly one"});
}

TEST(SceneChecks, contact_pairs_are_complete_known_and_single) {
  expect_error(with("      - {between: [steel, steel], normal_stiffness: 3000}\n", ""),
               "s.yaml:37:5: particles.contact.pairs: no entry with between: [steel, steel]", {});
  expect_error(with("      - {between: [walls, steel], normal_stiffness: 5000}\n", ""),
               "s.yaml:37:5: particles.contact.pairs: no entry with between: [steel, walls]", {});
  expect_error(with("      - {between: [walls, steel], normal_stiffness: 5000}\n",
                    "      - {between: [walls, steel], normal_stiffness: 5000}\n"
                    "      - {between: [walls, glas], normal_stiffness: 5000}\n"),
               "s.yaml:43:27: particles.contact.pairs[5].between[1]: `glas`", {"nearest: `glass`"});
  expect_error(with("      - {between: [walls, steel], normal_stiffness: 5000}\n",
                    "      - {between: [walls, steel], normal_stiffness: 5000}\n"
                    "      - {between: [glass, steel], normal_stiffness: 5000}\n"),
               "s.yaml:43:10: particles.contact.pairs[5].between: the pair glass, steel",
               {"second time"});
  expect_error(with("      - {between: [walls, steel], normal_stiffness: 5000}\n",
                    "      - {between: [walls, steel], normal_stiffness: 5000}\n"
                    "      - {between: [walls, walls], normal_stiffness: 5000}\n"),
               "s.yaml:43:10: particles.contact.pairs[5].between: walls do not touch", {});
}

TEST(SceneChecks, pairs_with_walls_are_not_needed_without_walls) {
  std::string text = with("      - {between: [glass, walls], normal_stiffness: 4000}\n", "");
  text = replaced(text, "      - {between: [walls, steel], normal_stiffness: 5000}\n", "");
  EXPECT_EQ(errors_in(text, {"particles.walls=none"}), "");
}

TEST(SceneChecks, pairs_are_not_needed_of_what_stands_still) {
  std::string text = with("      - {between: [steel, steel], normal_stiffness: 3000}\n", "");
  text = replaced(text, "      - {between: [walls, steel], normal_stiffness: 5000}\n", "");
  const std::string fixed = replaced(text, "material: steel, diameter: 0.003}",
                                     "material: steel, diameter: 0.003, motion: fixed}");
  EXPECT_EQ(errors_in(fixed), "");
  EXPECT_NE(errors_in(text), "");
  // With one entry that moves they are, and so is that of what moves with what is fixed.
  EXPECT_NE(errors_in(replaced(fixed, "    - {type: file, material: glass, path: \"bed.csv\"}\n",
                               "    - {type: file, material: steel, path: \"bed.csv\"}\n")),
            "");
  expect_error(
      replaced(
          fixed,
          "      - {between: [steel, glass], normal_stiffness: 2000, tangential_stiffness: 500}\n",
          ""),
      "s.yaml:37:5: particles.contact.pairs: no entry with between: [glass, steel]", {});
}

TEST(SceneChecks, kinematic_particles_need_no_contact) {
  EXPECT_EQ(errors_in(valid_scene, {"particles.backend=kinematic", "particles.contact={}"}), "");
  EXPECT_NE(errors_in(valid_scene, {"particles.contact={}"}), "");
}

TEST(SceneChecks, inserted_material_is_known) {
  expect_error(with("material: steel", "material: stel"),
               "s.yaml:46:33: particles.insertion[1].material: `stel`",
               {"nearest: `steel`", "allowed: glass, steel"});
}

std::string with_forces(const std::string& forces) {
  return with("forces: []", "forces: [" + forces + "]");
}

TEST(SceneChecks, forces_fit_the_rest_of_the_scene) {
  EXPECT_EQ(errors_in(with_forces("viscous, added_mass, saffman_lift, magnus_lift")), "");
  const std::string forces = "s.yaml:52:3: interphase.forces: ";
  expect_error(replaced(with_forces("viscous"), "drag: wen_yu", "model: b"),
               forces + "`viscous` has no meaning with `model: b`", {"`model: a`"});
  expect_error(with_forces("turbulent_dispersion"),
               forces + "`turbulent_dispersion` takes its eddies", {"`none`", "`k_epsilon`"});
  const std::string turbulent = replaced(
      with_forces("turbulent_dispersion"), "  initial: {superficial: [0, 0, 1]}",
      "  initial: {superficial: [0, 0, 1]}\n  turbulence: {model: k_epsilon, kinetic_energy: 1, "
      "dissipation: 1, inlets: {jet: {length_scale: 0.01}, inlet: {length_scale: 0.01}}}");
  EXPECT_EQ(errors_in(turbulent), "");
  expect_error(replaced(turbulent, "drag: wen_yu", "drag: none"),
               "s.yaml:53:3: interphase.forces: `turbulent_dispersion` acts through the drag",
               {"choose a law"});
  expect_error(replaced(prescribed_scene, "voidage: prescribed",
                        "voidage: prescribed\n  forces: [added_mass]"),
               "s.yaml:12:3: interphase.forces: `added_mass` acts on particles", {"remove it"});
}

TEST(SceneChecks, lubrication_has_a_film_and_an_engine_that_knows_it) {
  const auto film = [](const std::string& section) {
    return replaced(with_forces("lubrication"), "drag: wen_yu", "drag: wen_yu\n  " + section);
  };
  const std::string good = film("lubrication: {roughness: 1 um, reach: 0.1 mm}");
  EXPECT_EQ(errors_in(good), "");
  expect_error(with_forces("lubrication"), "s.yaml:49:1: interphase.lubrication: missing", {});
  expect_error(
      film("lubrication: {roughness: 1 mm, reach: 0.1 mm}"),
      "s.yaml:52:41: interphase.lubrication.reach: 0.0001 m is not more than the roughness", {});
  EXPECT_NE(errors_in(good, {"particles.backend=kinematic", "particles.contact={}"})
                .find("`lubrication` acts between particles that move"),
            std::string::npos);
}

TEST(SceneChecks, keys_of_a_force_have_no_meaning_without_it) {
  EXPECT_EQ(errors_in(with_forces("added_mass")), "");
  EXPECT_EQ(errors_in(replaced(with_forces("added_mass"), "drag: wen_yu",
                               "drag: wen_yu\n  added_mass_crowding: zuber")),
            "");
  expect_error(with("drag: wen_yu", "drag: wen_yu\n  added_mass_crowding: zuber"),
               "s.yaml:52:3: interphase.added_mass_crowding: has no meaning here", {"added_mass"});
  expect_error(with("drag: wen_yu", "drag: wen_yu\n  dispersion_seed: 2"),
               "s.yaml:52:3: interphase.dispersion_seed: has no meaning here",
               {"turbulent_dispersion"});
}

TEST(SceneChecks, prescribed_voidage_has_its_formula_and_no_particles) {
  EXPECT_EQ(errors_in(prescribed_scene), "");
  expect_error(replaced(prescribed_scene,
                        "  prescribed: {voidage: \"x < 0.5 ? 0.42 : 1\", diameter: 2 mm}\n", ""),
               "s.yaml:10:1: interphase.prescribed: missing", {"`voidage: prescribed`"});
  expect_error(replaced(prescribed_scene, "voidage: prescribed", "voidage: exact"),
               "s.yaml:12:3: interphase.prescribed: has no meaning here", {});
  expect_error(valid_scene,
               "s.yaml:44:3: particles.insertion: with `interphase.voidage: prescribed`", {},
               {"interphase={voidage: prescribed, prescribed: {voidage: 1, diameter: 1}}"});
}

TEST(SceneChecks, formula_is_parsed) {
  expect_error(replaced(prescribed_scene, "x < 0.5 ? 0.42 : 1", "x < q"),
               "s.yaml:12:25: interphase.prescribed.voidage: ", {"q"});
}

TEST(SceneChecks, participants_from_outside_must_know_where_to_connect) {
  EXPECT_NE(errors_in(prescribed_scene, {"launch.mode=external"}).find("launch.listen: missing"),
            std::string::npos);
  EXPECT_EQ(errors_in(prescribed_scene,
                      {"launch.mode=external", "launch.listen=\"tcp://127.0.0.1:5555\""}),
            "");
}

TEST(SceneChecks, nothing_listens_off_loopback_by_accident) {
  const std::string listen = "listen: \"tcp://127.0.0.1:5555\"";
  expect_error(with(listen, "listen: \"tcp://0.0.0.0:5555\""),
               "s.yaml:59:11: launch.listen: `tcp://0.0.0.0:5555`", {"`security: none`"});
  EXPECT_EQ(errors_in(with(listen, "listen: \"tcp://0.0.0.0:5555\"\n  security: none")), "");
  expect_error(with(listen, "listen: here"), "s.yaml:59:11: launch.listen: `here` is no endpoint",
               {"ipc://PATH"});
}

TEST(Endpoint, is_of_this_machine_only_for_ipc_and_loopback) {
  for (const char* endpoint : {"ipc:///tmp/a", "tcp://127.0.0.1:5555", "tcp://127.8.9.255:*",
                               "tcp://localhost:1", "tcp://[::1]:65535"}) {
    EXPECT_EQ(reach_of(endpoint), Reach::this_machine) << endpoint;
  }
  for (const char* endpoint :
       {"tcp://*:5555", "tcp://0.0.0.0:5555", "tcp://[::]:5555", "tcp://eth0:1",
        "tcp://127.example.org:1", "tcp://127.0.0.1.example.org:1", "tcp://127.0.0.256:1",
        "tcp://localhost.example.org:1", "tcp://127.1:1"}) {
    EXPECT_EQ(reach_of(endpoint), Reach::network) << endpoint;
  }
  for (const char* endpoint :
       {"", "ipc://", "tcp://", "tcp://host", "tcp://host:", "tcp://host:0", "tcp://host:65536",
        "tcp://:5", "http://127.0.0.1:80", "inproc://a", "tcp://127.0.0.1:5 5", "127.0.0.1:5555"}) {
    EXPECT_EQ(reach_of(endpoint), Reach::unknown) << endpoint;
  }
}

}  // namespace
}  // namespace fluxpact
