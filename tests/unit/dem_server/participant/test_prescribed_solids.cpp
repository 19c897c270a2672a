#include "dem_server/participant/prescribed_solids.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "proto/base/errors.hpp"
#include "proto/mesh/box.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact {
namespace {

const Progress quiet = [] {};

class Solids : public testing::Test {
 protected:
  Solids() {
    scene.coupling.window = 0.5;
    scene.fluid.density = 1.2;
    scene.fluid.viscosity = 1.8e-5;
    scene.fluid.mesh.box = {{0, 0, 0}, {1, 0.1, 0.1}, {10, 1, 1}};
    scene.interphase.voidage = VoidageMap::prescribed;
    scene.interphase.drag = DragLaw::ergun;
    scene.interphase.prescribed = PrescribedSettings{"0.5 + 0.3*x - 0.1*t", 2e-3};
    mesh = make_box(scene.fluid.mesh);
    velocity.assign(10, Vector3(0, 0.6, -0.8));
    gradient.assign(10, Vector3(0, 0, 40));
  }
  void begin() {
    side.configure(scene, mesh);
    Fields out;
    side.start({}, out);
  }
  Fields fluid() const {
    Fields in;
    in.add(field::velocity, velocity);
    in.add(field::pressure_gradient, gradient);
    return in;
  }
  double voidage(int cell, double time) const {
    return 0.5 + 0.3 * mesh.cell_centres[cell].x() - 0.1 * time;
  }
  /// Ergun's β [kg/(m³ s)].
  static double beta(double e, double slip) {
    return 150 * (1 - e) * (1 - e) * 1.8e-5 / (e * 4e-6) + 1.75 * (1 - e) * 1.2 * slip / 2e-3;
  }

  Scene scene;
  Mesh mesh;
  std::vector<Vector3> velocity;
  std::vector<Vector3> gradient;
  PrescribedSolids side{"native"};
};

TEST_F(Solids, follow_the_formula_in_space_and_time) {
  begin();
  Fields out;
  side.advance({1, 0, 0.5}, fluid(), out, quiet);
  double volume = 0;
  for (int c = 0; c < 10; ++c) {
    EXPECT_NEAR(out.scalars(field::voidage, 10)[c], voidage(c, 0.5), 1e-15);
    volume += (1 - voidage(c, 0.5)) * mesh.cell_volumes[c];
  }
  EXPECT_NEAR(out.number(field::particle_volume), volume, 1e-15 * 10);
  EXPECT_EQ(out.number(field::particle_count), 0);
}

TEST_F(Solids, offer_the_drag_of_a_bed_at_rest) {
  begin();
  Fields out;
  side.advance({1, 0, 0.5}, fluid(), out, quiet);
  for (int c = 0; c < 10; ++c) {
    const double expected = beta(voidage(c, 0.5), 1.0) * mesh.cell_volumes[c];  // |u| = 1
    EXPECT_NEAR(out.scalars(field::drag_coefficient, 10)[c], expected, 1e-14 * expected);
    EXPECT_EQ(out.vectors(field::drag_source, 10)[c], Vector3(0, 0, 0));
    EXPECT_EQ(out.vectors(field::particle_velocity, 10)[c], Vector3(0, 0, 0));
  }
}

TEST_F(Solids, take_the_impulse_of_the_fluids_last_step) {
  begin();
  Fields first;
  side.advance({1, 0, 0.5}, fluid(), first, quiet);
  for (const Vector3& impulse : first.vectors(field::impulse_given, 10)) {
    EXPECT_EQ(impulse, Vector3(0, 0, 0));  // no fluid step yet
  }
  std::vector<double> offered(10);
  std::ranges::copy(first.scalars(field::drag_coefficient, 10), offered.begin());
  side.commit();
  std::ranges::fill(velocity, Vector3(0, 0, 3));
  Fields second;
  side.advance({2, 0.5, 0.5}, fluid(), second, quiet);
  for (int c = 0; c < 10; ++c) {
    const double solids = (1 - voidage(c, 0.5)) * mesh.cell_volumes[c];
    const double expected = 0.5 * offered[c] * 3 - 0.5 * solids * 40;
    EXPECT_NEAR(second.vectors(field::impulse_given, 10)[c].z(), expected,
                1e-14 * 0.5 * solids * 40);
  }
}

TEST_F(Solids, offer_for_where_they_are_and_take_the_answer_a_window_later_in_parallel) {
  scene.coupling.scheme = CouplingScheme::parallel;
  begin();
  const double cell_volume = 1e-3;
  for (std::int64_t step = 1; step <= 3; ++step) {
    const double start = 0.5 * static_cast<double>(step - 1);
    Fields offer;
    Fields out;
    EXPECT_THROW(side.advance({step, start, 0.5}, {}, out, quiet), ProtocolError);
    side.offer({step, start, 0.5}, fluid(), offer, quiet);
    side.advance({step, start, 0.5}, {}, out, quiet);
    const auto drag = offer.scalars(field::drag_coefficient, 10);
    const auto given = out.vectors(field::impulse_given, 10);
    for (int cell = 0; cell < 10; ++cell) {
      EXPECT_DOUBLE_EQ(out.scalars(field::voidage, 10)[cell], voidage(cell, start + 0.5));
      const double here = cell_volume * beta(voidage(cell, start), 1);
      EXPECT_NEAR(drag[cell], here, 1e-12 * here);
      if (step == 1) {
        EXPECT_EQ(given[cell], Vector3(0, 0, 0));
        continue;
      }
      const double e = voidage(cell, start - 0.5);  // of the offer before
      const Vector3 expected =
          0.5 * cell_volume * (beta(e, 1) * velocity[cell] - (1 - e) * gradient[cell]);
      EXPECT_LE((given[cell] - expected).norm(), 1e-12 * expected.norm()) << cell;
    }
    side.commit();
  }
}

TEST_F(Solids, repeat_a_window_with_the_same_bits_after_a_rollback) {
  begin();
  Fields first;
  side.advance({1, 0, 0.5}, fluid(), first, quiet);
  side.commit();
  const auto read = [](const Fields& out) {
    std::vector<double> all;
    for (const FieldView& view : out.views()) {
      all.insert(all.end(), view.values.begin(), view.values.end());
    }
    return all;
  };
  Fields once;
  side.advance({2, 0.5, 0.5}, fluid(), once, quiet);
  const auto expected = read(once);
  side.rollback();
  Fields other;
  side.advance({2, 0.5, 0.7}, fluid(), other, quiet);
  EXPECT_NE(read(other), expected);
  side.rollback();
  Fields again;
  side.advance({2, 0.5, 0.5}, fluid(), again, quiet);
  EXPECT_EQ(read(again), expected);
}

TEST_F(Solids, refuse_a_voidage_that_is_none_by_cell_and_value) {
  scene.interphase.prescribed->voidage = "x > 0.6 ? 1.25 : 0.5";
  side.configure(scene, mesh);
  Fields out;
  try {
    side.start({}, out);
    FAIL() << "accepted";
  } catch (const NumericsError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("1.25 in cell 6"), std::string::npos) << text;
  }
  for (const char* bad : {"0", "-0.1", "0/0", "1/0"}) {
    scene.interphase.prescribed->voidage = bad;
    side.configure(scene, mesh);
    EXPECT_THROW(side.start({}, out), NumericsError) << bad;
  }
}

TEST_F(Solids, need_their_settings) {
  scene.interphase.prescribed.reset();
  EXPECT_THROW(side.configure(scene, mesh), ConfigError);
}

}  // namespace
}  // namespace fluxpact
