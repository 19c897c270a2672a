// The tournament against a look at all times.
#include "dem_server/backends/hard_sphere/event_queue.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "dem_server/insertion/random.hpp"

namespace fluxpact {
namespace {

TEST(EventQueue, knows_the_first_of_all_after_any_change) {
  UniformRandom random(7);
  for (const int count : {1, 2, 3, 8, 13, 100}) {
    EventQueue queue;
    queue.reset(count);
    std::vector<double> time(static_cast<std::size_t>(count), INFINITY);
    for (int change = 0; change < 2000; ++change) {
      const auto at = static_cast<std::size_t>(random.next() * count);
      // Few values, so that many are equal; now and then nothing happens to it any more.
      time[at] = random.next() < 0.1 ? INFINITY : std::floor(10 * random.next());
      queue.set(static_cast<int>(at), time[at]);
      const auto first = std::ranges::min_element(time);
      ASSERT_EQ(queue.first(), first - time.begin()) << count << " change " << change;
      ASSERT_EQ(queue.time(queue.first()), *first);
    }
  }
}

}  // namespace
}  // namespace fluxpact
