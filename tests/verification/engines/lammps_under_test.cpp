#include "dem_server/backends/granular/ranks.hpp"
#include "dem_server/backends/lammps/lammps_engine.hpp"
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

// The moment of touching is known to a sub-step only: γ dt = 1e-3, and twice that for the damped
// spring along the surface. Law and steps are those of the native engine: round-off (1e-16 in each
// of 1200 sub-steps), grown by collisions.
UnderTest under_test() { return {"lammps", 2e-3, 1e-11, 1e-11}; }

std::unique_ptr<ParticleEngine> make_under_test(const Scene& scene, const ParticleState& state) {
  return make_lammps_engine(scene, make_box(scene.fluid.mesh), state);
}

}  // namespace fluxpact
