// The same contacts on every target that this machine can run: eight doubles or one, the forces
// agree to rounding, and each lane has its own pair of materials, contact and mask.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "dem_server/backends/native/contact_law.hpp"
#include "hwy/targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/unit/dem_server/native/contact_targets_test.cpp"
#include "hwy/foreach_target.h"

#include "dem_server/backends/native/contact_force-inl.hpp"

#ifndef FLUXPACT_CONTACT_TARGETS_TEST_
#define FLUXPACT_CONTACT_TARGETS_TEST_
namespace fluxpact {

/// Numbers of a contact: what goes in and what comes out, in the order of `push_rows`.
constexpr int inputs = 14;
constexpr int springs = 7;
constexpr int outputs = 9;
struct Rows {
  std::vector<double> in, spring, out;  // row-major, one row a contact
  std::vector<std::int64_t> pair;
  std::vector<double> near;
};

}  // namespace fluxpact
#endif

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {

/// Contacts `lanes` at a time; the rows are a multiple of the widest vector.
void push_rows(const LawTable<double>& table, Rows& rows) {
  const hn::ScalableTag<double> d;
  const hn::RebindToSigned<decltype(d)> di;
  using V = hn::Vec<decltype(d)>;
  const auto lanes = hn::Lanes(d);
  std::vector<std::int64_t> offsets(lanes);
  const auto columns = [&](std::size_t first, std::int64_t stride, const double* data) HWY_ATTR {
    for (std::size_t i = 0; i < lanes; ++i) {
      offsets[i] = static_cast<std::int64_t>(first + i) * stride;
    }
    return [=, at = hn::LoadU(di, offsets.data())](int column)
               HWY_ATTR { return hn::GatherIndex(d, data + column, at); };
  };
  for (std::size_t first = 0; first < rows.pair.size(); first += lanes) {
    const auto in = columns(first, inputs, rows.in.data());
    const auto old = columns(first, springs, rows.spring.data());
    TouchLanes<V> touch{{in(0), in(1), in(2)},
                        in(3),
                        {in(4), in(5), in(6)},
                        {in(7), in(8), in(9)},
                        {in(10), in(7), in(4)},
                        in(11),
                        in(12),
                        in(13)};
    SpringLanes<V> spring{{old(0), old(1), old(2)}, {old(3), old(4), old(5)}, old(6)};
    const V zero = hn::Zero(d);
    ForceLanes<V> out{{zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}};
    const auto law = load_law(d, table, hn::LoadU(di, &rows.pair[first]));
    contact_force<true>(d, table.model, law, touch, hn::Set(d, 1e-6), spring,
                        hn::Gt(hn::LoadU(d, &rows.near[first]), zero), out);
    const V results[] = {out.force.x, out.force.y,  out.force.z,  out.lever.x, out.lever.y,
                         out.lever.z, out.torque.x, out.torque.y, out.torque.z};
    const V kept[] = {spring.tangential.x, spring.tangential.y, spring.tangential.z,
                      spring.rolling.x,    spring.rolling.y,    spring.rolling.z,
                      spring.bridge};
    std::vector<double> values(lanes);
    const auto store = [&](const V* from, int count, std::vector<double>& to) HWY_ATTR {
      for (int column = 0; column < count; ++column) {
        hn::StoreU(from[column], d, values.data());
        for (std::size_t i = 0; i < lanes; ++i) {
          to[(first + i) * static_cast<std::size_t>(count) + static_cast<std::size_t>(column)] =
              values[i];
        }
      }
    };
    store(results, outputs, rows.out);
    store(kept, springs, rows.spring);
  }
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fluxpact {
namespace {

HWY_EXPORT(push_rows);

constexpr int contacts = 512;

Rows random_rows(int pairs) {
  std::mt19937 random(20261122);  // NOLINT: the same contacts every time
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  Rows rows;
  for (int i = 0; i < contacts; ++i) {
    double n[3] = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (const double x : n) rows.in.push_back(x / length);
    rows.in.push_back(uniform(-2e-6, 1e-5));                              // overlap
    for (int k = 0; k < 6; ++k) rows.in.push_back(uniform(-0.05, 0.05));  // velocity, radius spin
    rows.in.push_back(uniform(-50, 50));                                  // spin
    rows.in.push_back(std::sqrt(uniform(1e-6, 1e-5)));
    rows.in.push_back(1 / uniform(2e-4, 2e-3));
    rows.in.push_back(1 / uniform(1e-12, 1e-11));
    for (int k = 0; k < 3; ++k) rows.spring.push_back(uniform(-5e-6, 5e-6));
    for (int k = 0; k < 3; ++k) rows.spring.push_back(uniform(-0.05, 0.05));
    rows.spring.push_back(uniform(0, 1) < 0.5 ? 0 : 1);
    rows.pair.push_back(i % pairs);
    rows.near.push_back(uniform(0, 1) < 0.9 ? 1 : 0);
  }
  rows.out.assign(static_cast<std::size_t>(contacts * outputs), 0);
  return rows;
}

ParticleSettings settings_with(ContactLaw law, RollingLaw rolling, CohesionLaw cohesion) {
  ParticleSettings settings;
  settings.contact.law = law;
  settings.contact.rolling = rolling;
  settings.contact.cohesion = cohesion;
  settings.contact.walls = WallMaterialSettings{2e7, 0.2};
  const char* const names[] = {"a", "b", "walls"};
  for (int i = 0; i < 2; ++i) {
    settings.materials[names[i]] = {2500, 5e6 * (i + 1), 0.3};
    for (int j = i; j < 3; ++j) {
      PairSettings pair;
      pair.between = {names[i], names[j]};
      if (law == ContactLaw::linear) pair.normal_stiffness = 500 * (i + j + 1);
      pair.friction = 0.1 * (i + j);
      if (rolling != RollingLaw::none) pair.rolling_friction = 0.05 * (1 + j);
      if (cohesion == CohesionLaw::sjkr) pair.cohesion_energy_density = 1e3 * (1 + i);
      if (cohesion == CohesionLaw::jkr) pair.work_of_adhesion = 1e-3 * j;
      if (cohesion == CohesionLaw::liquid_bridge) {
        pair.liquid_volume = 1e-15 * j;
        pair.surface_tension = 0.07;
        pair.contact_angle = 0.1 * j;
      }
      settings.contact.pairs.push_back(pair);
    }
  }
  return settings;
}

void compare(const ParticleSettings& settings) {
  const ContactLaws laws(settings);
  const auto table = law_table<double>(laws);
  const Rows start = random_rows(laws.count());
  std::vector<Rows> results;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    results.push_back(start);
    HWY_DYNAMIC_DISPATCH(push_rows)(table, results.back());
    hwy::SetSupportedTargetsForTest(0);
    // Fused or not, a sum of ten terms: 1e-14 of the largest force, torque, elongation, angle.
    const Rows& first = results.front();
    const Rows& last = results.back();
    for (std::size_t i = 0; i < first.out.size(); ++i) {
      const double size = i % outputs < 6 ? 0.1 : 1e-5;
      EXPECT_NEAR(last.out[i], first.out[i], 1e-14 * size) << hwy::TargetName(target) << ' ' << i;
    }
    for (std::size_t i = 0; i < first.spring.size(); ++i) {
      const double size = i % springs < 3 ? 1e-5 : 0.1;
      EXPECT_NEAR(last.spring[i], first.spring[i], 1e-14 * size)
          << hwy::TargetName(target) << ' ' << i;
    }
  }
}

TEST(ContactTargets, agree_to_rounding) {
  for (const ContactLaw law : {ContactLaw::linear, ContactLaw::hertz}) {
    for (const RollingLaw rolling :
         {RollingLaw::none, RollingLaw::constant_torque, RollingLaw::spring_dashpot}) {
      for (const CohesionLaw cohesion :
           {CohesionLaw::none, CohesionLaw::sjkr, CohesionLaw::jkr, CohesionLaw::liquid_bridge}) {
        if (cohesion == CohesionLaw::jkr && law != ContactLaw::hertz) continue;
        compare(settings_with(law, rolling, cohesion));
      }
    }
  }
}

}  // namespace
}  // namespace fluxpact
#endif
