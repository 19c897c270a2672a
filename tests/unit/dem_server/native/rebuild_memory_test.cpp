// New lists of neighbours need no memory of their own once there were a few, and a particle no more
// than it must. Alone in its program, since it counts what every `new` takes.
#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/unit/dem_server/native/random_cloud.hpp"

namespace {

std::atomic<std::size_t> taken = 0;
std::atomic<std::size_t> bytes_now = 0;
std::atomic<std::size_t> bytes_at_most = 0;

/// Stands before the memory that was asked for.
struct alignas(16) Before {
  void* base;
  std::size_t bytes;
};
static_assert(sizeof(Before) == 16);

void* take(std::size_t bytes, std::size_t alignment) {
  ++taken;
  const std::size_t whole = (bytes + alignment - 1) / alignment * alignment;
  void* const base = std::aligned_alloc(alignment, alignment + whole);
  if (base == nullptr) throw std::bad_alloc();
  char* const memory = static_cast<char*>(base) + alignment;
  *reinterpret_cast<Before*>(memory - sizeof(Before)) = {base, bytes};
  bytes_now += bytes;
  bytes_at_most = std::max(bytes_at_most.load(), bytes_now.load());
  return memory;
}

void give(void* memory) {
  if (memory == nullptr) return;
  const Before before = *reinterpret_cast<Before*>(static_cast<char*>(memory) - sizeof(Before));
  bytes_now -= before.bytes;
  std::free(before.base);
}

}  // namespace

void* operator new(std::size_t bytes) { return take(bytes, alignof(std::max_align_t)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return take(bytes, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return take(bytes, alignof(std::max_align_t));
}
void operator delete(void* memory) noexcept { give(memory); }
void operator delete(void* memory, std::size_t) noexcept { give(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { give(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { give(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { give(memory); }

namespace fluxpact {
namespace {

TEST(NewLists, need_no_memory_after_the_first_few) {
  const Scene scene = cloud_scene({Axis::x, Axis::y});
  const auto engine = make_engine(scene, random_cloud(1000, 1.0));
  const std::vector<Vector3> none(1000, Vector3::Zero());
  const auto go_on = [&](int windows) {
    for (int window = 0; window < windows; ++window) {
      engine->advance(2e-4, 100, none, {});
      engine->commit();
    }
  };
  go_on(60);
  const std::int64_t lists = engine->counters().rebuilds;
  const std::size_t before = taken;
  go_on(60);
  const auto made = engine->counters().rebuilds - lists;
  ASSERT_GT(made, 20);
  // Numbers of pairs fluctuate: a vector grows now and then, one in several lists. Memory that is
  // taken anew would be so in each list, several times.
  EXPECT_LT(static_cast<double>(taken - before), 0.5 * static_cast<double>(made))
      << taken - before << " in " << made;
}

/// Chains of spheres that touch, each with two more neighbours in the list: about as many contacts
/// as in a bed at rest. All drift together through periodic sides, so that lists are made anew.
TEST(OneParticle, takes_few_bytes_while_lists_are_remade) {
  constexpr double diameter = 1e-3;
  const Vector3 apart = diameter * Vector3(1 - 1e-4, 1.05, 1.05);
  const std::array<int, 3> counts{16, 16, 256};
  ParticleState state;
  for (int k = 0; k < counts[2]; ++k) {
    for (int j = 0; j < counts[1]; ++j) {
      for (int i = 0; i < counts[0]; ++i) {
        const Vector3 centre = apart.cwiseProduct(Vector3(i + 0.5, j + 0.5, k + 0.5));
        add_sphere(state, centre, {1, 0, 0}, diameter / 2);
        state.spin.back() = {0, 0, 1};  // so that the springs of all contacts are stretched
      }
    }
  }
  const int count = state.size();
  Scene scene = box_scene(apart.cwiseProduct(Vector3(counts[0], counts[1], counts[2])),
                          {Axis::x, Axis::y, Axis::z});
  add_laws(scene, 1000, 0.9, 0.3);
  const std::vector<Vector3> none(count, Vector3::Zero());

  const std::size_t before = bytes_now;
  bytes_at_most = before;
  const auto engine = make_engine(scene, state);
  for (int window = 0; window < 5; ++window) {
    engine->advance(6e-5, 30, none, {});
    engine->commit();
  }
  ASSERT_GE(engine->counters().rebuilds, 3);  // one of them at the start
  const double bytes = static_cast<double>(bytes_at_most - before) / count;
  // State 292 (bodies 96, loads 48, those kept for rollback 48, presented 100). With the room for
  // more that vectors have, a part in 32: two lists of 20 and 3.2 pairs of 5 each: 74. Close pairs,
  // of 10 and springs of 24 each, 1.1 to 1.3 of them: 44. Springs of 1.06 touching pairs, saved for
  // rollback: 27; of the 3 blocks of 8 from which particles of one block come, on their way to the
  // new list: 10. What a thread finds and goes through, of one block: 14. Loads of the 3 blocks of
  // 8 that wait for their turn: 24. Cells and order of the search: 8. That is 493 at most, since
  // not all of it is there at once; with springs of all blocks on their way it was 502.
  EXPECT_LT(bytes, 493);
  std::printf("%.0f bytes a particle\n", bytes);
}

}  // namespace
}  // namespace fluxpact
