// New lists of neighbours need no memory of their own once there were a few. Alone in its program,
// since it counts what every `new` takes.
#include <cstdlib>
#include <new>

#include "tests/unit/dem_server/native/random_cloud.hpp"

namespace {

std::size_t taken = 0;

void* take(std::size_t bytes, std::size_t alignment) {
  ++taken;
  const std::size_t whole = (bytes + alignment - 1) / alignment * alignment;
  void* const memory = std::aligned_alloc(alignment, whole);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t bytes) { return take(bytes, alignof(std::max_align_t)); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return take(bytes, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return take(bytes, alignof(std::max_align_t));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }

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

}  // namespace
}  // namespace fluxpact
