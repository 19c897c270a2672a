#include "dem_server/backends/granular/ranks.hpp"
#include "dem_server/backends/liggghts/liggghts_engine.hpp"
#include "tests/verification/engines/under_test.hpp"

namespace fluxpact {
namespace {

class WithMpi : public ::testing::Environment {
 public:
  void SetUp() override { session_ = std::make_unique<MpiSession>(nullptr, nullptr); }
  void TearDown() override { session_.reset(); }

 private:
  std::unique_ptr<MpiSession> session_;
};

const auto* const registered = ::testing::AddGlobalTestEnvironment(new WithMpi);

}  // namespace

// The lever r - δ/2, and Coulomb's limit on the spring alone, whose dashpot acts while it sticks:
// 2 % of what an impact changes where it sticks first and slips then. Where a contact begins to
// slip the dashpot goes at once: round-off decides in which step, and one step in 40 of a contact's
// force is far above round-off then.
UnderTest under_test() { return {"liggghts", 3e-2, 5e-2, 1e-5}; }

std::unique_ptr<ParticleEngine> make_under_test(const Scene& scene, const ParticleState& state) {
  return make_liggghts_engine(scene, make_box(scene.fluid.mesh), state);
}

}  // namespace fluxpact
