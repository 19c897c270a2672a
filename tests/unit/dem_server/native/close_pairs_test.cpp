// How long close pairs do, and springs that stay with their pairs.
#include "dem_server/backends/native/close_pairs.hpp"

#include <gtest/gtest.h>

#include <random>

namespace fluxpact {
namespace {

/// On a line: the distance of two surfaces that fly towards each other, kicked in every step. A
/// pair that was not close when it was looked at may not touch before it is looked at again.
TEST(CloseBudget, ends_before_a_pair_that_was_not_close_can_touch) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  constexpr double usual_room = 1e-6;
  constexpr double time_step = 1e-5;
  int longest = 0;
  int nearly = 0;  // came to a thousandth of the room
  for (int round = 0; round < 2000; ++round) {
    const double largest = std::pow(10.0, 2 * any(random) - 3);  // kick of both together [m/s]
    CloseBudget budget;
    ASSERT_FALSE(budget.spend(largest, time_step));
    budget.renew(largest, time_step, usual_room);
    double velocity = any(random);
    // As near as a pair may be that does not count as close.
    double gap = budget.room - std::min(0.0, velocity) * budget.flight;
    int steps = 0;
    while (true) {
      const double grown = 1 + 0.1 * round / 2000;  // kicks grow, which nobody knew
      const double kick = largest * std::pow(grown, steps) * (round % 2 == 0 ? -1 : any(random));
      velocity += kick;
      gap += velocity * time_step;
      if (!budget.spend(std::abs(kick), time_step)) break;
      ++steps;
      ASSERT_GT(gap, 0) << "round " << round << ", step " << steps;
      if (gap < 1e-2 * budget.room) ++nearly;
    }
    longest = std::max(longest, steps);
    ASSERT_GT(steps, 2);
  }
  EXPECT_EQ(longest, 32);
  EXPECT_GT(nearly, 0);
}

TEST(CloseBudget, is_spent_where_it_was_forgotten) {
  CloseBudget budget;
  budget.renew(0, 1e-5, 1e-6);
  EXPECT_TRUE(budget.spend(0, 1e-5));
  budget.forget();
  EXPECT_FALSE(budget.spend(0, 1e-5));
}

/// Springs of 30 pairs, every third with some; the number n of pair p is 10 p + n + 1.
template <class Real>
PairSprings<Real> some_springs(const SpringNumbers& each) {
  PairSprings<Real> springs;
  springs.reset(30, each, 10);
  for (int pair = 0; pair < 30; pair += 3) {
    std::array<Real, 7> numbers{};
    for (int n = 0; n < each.count; ++n) numbers[n] = static_cast<Real>(10 * pair + n + 1);
    springs.append(pair, numbers.data(), 1, false);
  }
  return springs;
}

template <class Real>
class ClosePairsOf : public testing::Test {};
using Reals = testing::Types<double, float>;
TYPED_TEST_SUITE(ClosePairsOf, Reals);

TYPED_TEST(ClosePairsOf, keep_the_springs_of_those_that_stay_close) {
  using Real = TypeParam;
  const SpringNumbers each = spring_numbers(
      {.rolling = RollingLaw::spring_dashpot, .cohesion = CohesionLaw::jkr, .friction = true});
  ASSERT_EQ(each.count, 7);
  OuterList list;
  for (int pair = 0; pair < 30; ++pair) {
    list.other.push_back(100 + pair);
    list.mine.push_back(static_cast<std::uint16_t>(pair / 2));
  }
  ClosePairs<Real> before;
  std::vector<std::int32_t> room;
  before.bring_back(list, some_springs<Real>(each), room);
  EXPECT_EQ(before.count(), 10);
  const std::vector<std::int32_t> places{1, 2, 3, 5, 6, 9, 12, 15, 20, 24, 28};
  ClosePairs<Real> renewed;
  renewed.renew(list, places, before);
  ClosePairs<Real> close;
  close.copy(renewed);
  ASSERT_EQ(close.count(), 11);
  for (int n = 0; n < 16; ++n) {  // the last batch is filled with the last pair
    const int place = places[std::min(n, 10)];
    EXPECT_EQ(close.other()[n], 100 + place);
    EXPECT_EQ(close.mine()[n], place / 2);
    EXPECT_EQ(close.places()[n], place);
    for (int k = 0; k < 7; ++k) {
      const int expected = place % 3 == 0 && n < 11 ? 10 * place + k + 1 : 0;
      EXPECT_EQ(close.springs(n)[k * ClosePairs<Real>::batch_size], static_cast<Real>(expected))
          << place;
    }
  }
  PairSprings<Real> taken;
  close.take_springs(taken);
  taken.number();
  EXPECT_EQ(taken.find(1), nullptr);
  EXPECT_EQ(taken.find(18), nullptr);  // was not close any more
  ASSERT_NE(taken.find(24), nullptr);
  EXPECT_EQ(*taken.find(24), 241);
}

/// One number that is not 0 is a spring, whichever it is; none is none. In whole batches and in a
/// part of one.
TYPED_TEST(ClosePairsOf, take_the_springs_of_those_that_have_some) {
  using Real = TypeParam;
  const SpringNumbers each = spring_numbers(
      {.rolling = RollingLaw::spring_dashpot, .cohesion = CohesionLaw::jkr, .friction = true});
  constexpr int pairs = 3 * ClosePairs<Real>::batch_size - 5;
  OuterList list;
  std::vector<std::int32_t> places;
  for (int pair = 0; pair < pairs; ++pair) {
    list.other.push_back(100 + pair);
    list.mine.push_back(static_cast<std::uint16_t>(pair));
    places.push_back(pair);
  }
  ClosePairs<Real> none;
  std::vector<std::int32_t> room;
  PairSprings<Real> empty;
  empty.reset(pairs, each, 0);
  none.bring_back(list, empty, room);
  ClosePairs<Real> close;
  close.renew(list, places, none);
  const auto number = [](int pair) { return static_cast<Real>(pair % 2 == 0 ? pair + 1 : -pair); };
  for (int pair = 0; pair < pairs; ++pair) {
    if (pair % 8 == 7) continue;
    close.springs(pair)[pair % 8 * ClosePairs<Real>::batch_size] = number(pair);
  }
  PairSprings<Real> taken;
  close.take_springs(taken);
  taken.number();
  for (int pair = 0; pair < pairs; ++pair) {
    const Real* const found = taken.find(pair);
    ASSERT_EQ(found == nullptr, pair % 8 == 7) << pair;
    for (int k = 0; found != nullptr && k < each.count; ++k) {
      EXPECT_EQ(found[k], k == pair % 8 ? number(pair) : 0) << pair;
    }
  }
}

TEST(PairSprings, seen_from_the_partner_change_their_sign_but_for_what_is_even) {
  const SpringNumbers each =
      spring_numbers({.cohesion = CohesionLaw::liquid_bridge, .friction = true});
  ASSERT_EQ(each.count, 4);
  PairSprings<double> springs;
  springs.reset(2, each, 1);
  const std::array<double, 4> numbers{1, 2, 3, 4};
  springs.append(1, numbers.data(), 1, true);
  std::vector<double> rows;
  springs.store(1, rows);
  EXPECT_EQ(rows, (std::vector<double>{0, 0, 0, 0, -1, -2, -3, 4}));
  PairSprings<double> again;
  again.restore(2, each, 1, rows);
  again.number();
  EXPECT_EQ(again.find(0), nullptr);
  ASSERT_NE(again.find(1), nullptr);
  EXPECT_EQ(again.find(1)[3], 4);
}

}  // namespace
}  // namespace fluxpact
