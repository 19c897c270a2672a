// Rows to lanes and back, for vectors of all widths of every target that this machine can run:
// whole numbers, so all that comes out is exact.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "hwy/targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/unit/dem_server/native/row_lanes_test.cpp"
#include "hwy/foreach_target.h"

#include "dem_server/backends/native/batch-inl.hpp"

#ifndef FLUXPACT_ROW_LANES_TEST_
#define FLUXPACT_ROW_LANES_TEST_
namespace fluxpact {

/// Rows of eight numbers, none like another, in an order of lanes of their own.
template <class T>
struct TestRows {
  static constexpr int count = 16;
  alignas(64) T number[count][8];
  explicit TestRows(int first) {
    for (int row = 0; row < count; ++row) {
      for (int c = 0; c < 8; ++c) number[row][c] = static_cast<T>(first + 8 * row + c);
    }
  }
  T* of(int lane) { return number[(5 * lane + 3) % count]; }
};

}  // namespace fluxpact
#endif

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {

template <class D>
class RowLanes {
 public:
  using T = hn::TFromD<D>;
  using V = hn::Vec<D>;
  static constexpr int lanes = lanes_of<D>;

  explicit RowLanes(std::vector<std::string>& wrong) : wrong_(wrong) {}

  void run() {
    const auto first = [&](int k) { return first_.of(k); };
    const auto second = [&](int k) { return second_.of(k); };
    const auto a = [&](int lane, int c) { return first_.of(lane)[c]; };
    const auto b = [&](int lane, int c) { return second_.of(lane)[c]; };
    const auto difference = [&](int lane, int c) {
      return a(lane, c) + (c % 4 == 3 ? b(lane, c) : -b(lane, c));
    };
    const auto motion = [&](int lane, int c) {
      return a(lane, c) + (c < 3 ? -b(lane, c) : b(lane, c));
    };
    const D d;
    expect("gather_rows", gather_rows(d, first), a);
    expect("combine_rows", combine_rows(d, first, second, Flip<T>::difference), difference);
    expect("combine_long_rows", combine_long_rows(d, first, second, Flip<T>::difference),
           difference);
    expect("combine_long_rows, motion", combine_long_rows(d, first, second, Flip<T>::motion),
           motion);
    for (int count = 0; count <= lanes; ++count) scatter(count);
  }

 private:
  template <class Expected>
  void expect(const std::string& what, V lanes_found, int c, const Expected& expected) {
    T found[lanes];
    hn::StoreU(lanes_found, D(), found);
    for (int lane = 0; lane < lanes; ++lane) {
      if (found[lane] != expected(lane, c)) fail(what, lane, c, found[lane], expected(lane, c));
    }
  }
  template <class Expected>
  void expect(const std::string& what, const Quad<V>& found, const Expected& expected) {
    expect(what, found.a, 0, expected);
    expect(what, found.b, 1, expected);
    expect(what, found.c, 2, expected);
    expect(what, found.d, 3, expected);
  }
  template <class Expected>
  void expect(const std::string& what, const Eight<V>& found, const Expected& expected) {
    expect(what, found.low, expected);
    expect(what, found.high, [&](int lane, int c) { return expected(lane, c + 4); });
  }

  /// The first lanes to their rows, and all others as they were.
  void scatter(int count) {
    const D d;
    const auto components = gather_rows(d, [&](int k) { return first_.of(k); });
    TestRows<T> to(1000);
    const TestRows<T> before(1000);
    scatter_rows(d, components, count, [&](int k) { return to.of(k); });
    TestRows<T> expected = before;
    for (int lane = 0; lane < count; ++lane) {
      for (int c = 0; c < 4; ++c) expected.of(lane)[c] = first_.of(lane)[c];
    }
    for (int lane = 0; lane < TestRows<T>::count; ++lane) {
      for (int c = 0; c < 8; ++c) {
        if (to.of(lane)[c] != expected.of(lane)[c]) {
          fail("scatter_rows of " + std::to_string(count), lane, c, to.of(lane)[c],
               expected.of(lane)[c]);
        }
      }
    }
  }

  void fail(const std::string& what, int lane, int c, T found, T expected) {
    wrong_.push_back(what + ", " + std::to_string(lanes) + " lanes of " +
                     std::to_string(8 * sizeof(T)) + " bits: lane " + std::to_string(lane) +
                     ", component " + std::to_string(c) + " is " + std::to_string(found) +
                     " instead of " + std::to_string(expected));
  }

  std::vector<std::string>& wrong_;
  TestRows<T> first_{0};
  TestRows<T> second_{300};
};

/// Loads of a batch to the sums of holders and partners: lane after lane, those of partners
/// mirrored.
template <class Real>
void add_loads(std::vector<std::string>& wrong) {
  constexpr int lanes = width<Real>;
  using V = hn::Vec<Lanes<Real>>;
  const Lanes<Real> d;
  alignas(64) Real number[6][lanes];
  for (int c = 0; c < 6; ++c) {
    for (int k = 0; k < lanes; ++k) number[c][k] = static_cast<Real>(100 * c + k + 1);
  }
  ForceLanes<V> loads = no_force<Real>();
  loads.force = {hn::Load(d, number[0]), hn::Load(d, number[1]), hn::Load(d, number[2])};
  loads.lever = {hn::Load(d, number[3]), hn::Load(d, number[4]), hn::Load(d, number[5])};
  constexpr int particles = 5;  // several lanes a particle
  const auto holder = [](int k) { return k % particles; };
  const auto partner = [](int k) { return (3 * k + 1) % particles; };
  Load<Real, true> found[particles] = {};
  Load<Real, true> expected[particles] = {};
  const LoadRows<Real, true> rows(loads);
  rows.add_to(found, holder, rows, partner);
  rows.add_to(found, holder);
  for (int k = 0; k < lanes; ++k) {
    for (int c = 0; c < 3; ++c) {
      expected[holder(k)].force[c] += 2 * number[c][k];
      expected[holder(k)].lever[c] += 2 * number[c + 3][k];
      expected[partner(k)].force[c] -= number[c][k];
      expected[partner(k)].lever[c] += number[c + 3][k];
    }
  }
  for (int i = 0; i < particles; ++i) {
    for (int c = 0; c < 4; ++c) {
      if (found[i].force[c] != expected[i].force[c] || found[i].lever[c] != expected[i].lever[c]) {
        wrong.push_back("LoadRows, " + std::to_string(lanes) + " lanes: particle " +
                        std::to_string(i) + ", component " + std::to_string(c));
      }
    }
  }
}

std::vector<std::string> wrong_lanes() {
  std::vector<std::string> wrong;
  RowLanes<hn::CappedTag<double, 4>>(wrong).run();
  RowLanes<hn::CappedTag<double, 8>>(wrong).run();
  RowLanes<hn::CappedTag<float, 4>>(wrong).run();
  RowLanes<hn::CappedTag<float, 8>>(wrong).run();
  RowLanes<hn::CappedTag<float, 16>>(wrong).run();
  add_loads<double>(wrong);
  add_loads<float>(wrong);
  return wrong;
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fluxpact {
namespace {

HWY_EXPORT(wrong_lanes);

TEST(RowLanes, hold_what_the_rows_hold) {
  for (const auto target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    for (const std::string& wrong : HWY_DYNAMIC_DISPATCH(wrong_lanes)()) {
      ADD_FAILURE() << hwy::TargetName(target) << ": " << wrong;
    }
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace fluxpact
#endif
