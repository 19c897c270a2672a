// The mesh arrives as it was sent, or is refused.
#include <gtest/gtest.h>

#include "proto/base/errors.hpp"
#include "proto/mesh/box.hpp"
#include "proto/message/mesh_message.hpp"

namespace fluxpact {
namespace {

Mesh sample() {
  MeshSettings settings;
  settings.box.upper = {1, 1, 2};
  settings.box.cells = {3, 2, 4};
  settings.periodic = {Axis::y};
  settings.patches = {{"inlet", {Side::z_min, {}}}};
  return make_box(settings);
}

TEST(MeshMessage, rebuilds_the_same_mesh) {
  const Mesh sent = sample();
  const Mesh got = mesh_of(mesh_message(sent));
  EXPECT_EQ(fingerprint(got), fingerprint(sent));
  EXPECT_EQ(got.cell_volumes, sent.cell_volumes);
  EXPECT_TRUE(got.lattice.has_value());
  EXPECT_EQ(got.patches.at(0).name, "inlet");
}

TEST(MeshMessage, refuses_a_missing_array_and_wild_indices) {
  const Mesh mesh = sample();
  Message message = mesh_message(mesh);
  message.header.arrays[0].name = "pints";
  EXPECT_THROW(mesh_of(message), ProtocolError);
  message = mesh_message(mesh);
  message.header.body["patch_size:inlet"] = std::int64_t{1} << 40;
  EXPECT_THROW(mesh_of(message), Error);
  Mesh wild = sample();
  wild.neighbour[0] = -3;
  EXPECT_THROW(mesh_of(mesh_message(wild)), ConfigError);
}

}  // namespace
}  // namespace fluxpact
