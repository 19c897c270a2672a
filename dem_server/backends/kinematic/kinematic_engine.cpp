#include "dem_server/backends/kinematic/kinematic_engine.hpp"

#include "dem_server/backends/domain.hpp"
#include "dem_server/backends/particle_rows.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

class KinematicEngine final : public ParticleEngine {
 public:
  KinematicEngine(const Scene& scene, const Mesh& mesh, ParticleState initial)
      : domain_(particle_domain(scene, mesh)),
        presented_(
            checked_rows(std::move(initial), static_cast<int>(scene.particles.materials.size()))),
        committed_position_(presented_.position) {}

  const ParticleState& particles() const override { return presented_; }
  bool mobile() const override { return false; }

  void advance(double window, int, std::span<const Vector3>, const Progress& progress) override {
    for (int row = 0; row < presented_.size(); ++row) {
      const Vector3 position = committed_position_[row] + window * presented_.velocity[row];
      const int side = lost_through(domain_, position, presented_.radius[row]);
      if (side >= 0 || !position.allFinite()) refuse(row, position, side);
      presented_.position[row] = wrapped(domain_, position);
    }
    if (progress) progress();
  }
  void commit() override { committed_position_ = presented_.position; }
  void rollback() override { presented_.position = committed_position_; }

 private:
  [[noreturn]] void refuse(int row, const Vector3& at, int side) const {
    throw NumericsError(
        "particle {} of the kinematic engine would go to ({:.6g}, {:.6g}, {:.6g}) m and leave the "
        "domain "
        "through {}; lower its velocity, make that direction periodic, or enlarge the box",
        presented_.id[row], at.x(), at.y(), at.z(), side < 0 ? "infinity" : side_name(side));
  }

  Domain domain_;
  ParticleState presented_;
  std::vector<Vector3> committed_position_;
};

/// Nothing would keep them inside.
void refuse_other_than_box(const Scene& scene, const Mesh& mesh) {
  const std::vector<int> faces = faces_off_the_box(scene, mesh, particle_domain(scene, mesh));
  if (faces.empty()) return;
  const Vector3& at = mesh.face_centres[faces.front()];
  throw ConfigError(
      "particles.backend: kinematic particles know the sides of a box only, and a face at ({:.6g}, "
      "{:.6g}, {:.6g}) m is off the outer box of the mesh; use a box mesh, or the native backend",
      at.x(), at.y(), at.z());
}

}  // namespace

std::unique_ptr<ParticleEngine> make_kinematic_engine(const Scene& scene, const Mesh& mesh,
                                                      ParticleState initial) {
  if (initial.size() > 0) refuse_other_than_box(scene, mesh);
  return std::make_unique<KinematicEngine>(scene, mesh, std::move(initial));
}

}  // namespace fluxpact
