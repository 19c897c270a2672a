// Blocks that move in place: none before all that read it have their forces.
#include "dem_server/backends/native/block_turns.hpp"

#include <gtest/gtest.h>

#include <random>

namespace fluxpact {
namespace {

using Partners = std::vector<std::vector<int>>;

BlockTurns planned(const Partners& partners, int threads) {
  BlockTurns turns;
  turns.plan(static_cast<int>(partners.size()), threads,
             [&](int block) -> const std::vector<int>& { return partners[block]; });
  return turns;
}

void expect_sound(const Partners& partners, int threads) {
  const int blocks = static_cast<int>(partners.size());
  const BlockTurns turns = planned(partners, threads);
  ASSERT_EQ(turns.first(0), 0);
  ASSERT_EQ(turns.first(threads), blocks);
  for (int t = 0; t < threads; ++t) {
    const auto own = [&](int b) { return turns.first(t) <= b && b < turns.first(t + 1); };
    for (int b = turns.first(t); b < turns.first(t + 1); ++b) {
      EXPECT_GE(turns.last_reader(b), b);
      EXPECT_LT(turns.room(b), turns.rooms());
      for (const int read : partners[b]) {
        EXPECT_GE(turns.last_reader(read), own(read) ? b : blocks);
      }
      for (int waits = turns.first(t); waits < b; ++waits) {
        if (turns.last_reader(waits) < b) continue;
        EXPECT_NE(turns.room(waits), turns.room(b));
      }
    }
  }
}

TEST(BlockTurns, let_no_block_move_before_its_readers) {
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    Partners partners(1 + random() % 20);
    for (auto& of_block : partners) {
      for (std::size_t n = random() % 5; n > 0; --n) {
        of_block.push_back(static_cast<int>(random() % partners.size()));
      }
    }
    expect_sound(partners,
                 1 + static_cast<int>(random() % std::min<std::size_t>(4, partners.size())));
  }
}

TEST(BlockTurns, need_few_rooms_for_slabs) {
  constexpr int blocks = 50;
  Partners slabs(blocks);
  for (int b = 0; b < blocks; ++b) {
    if (b > 0) slabs[b].push_back(b - 1);
    if (b + 1 < blocks) slabs[b].push_back(b + 1);
  }
  EXPECT_EQ(planned(slabs, 1).rooms(), 2);
  slabs.front().push_back(blocks - 1);  // a periodic side: the first waits for the last
  slabs.back().push_back(0);
  EXPECT_EQ(planned(slabs, 1).rooms(), 3);
}

}  // namespace
}  // namespace fluxpact
