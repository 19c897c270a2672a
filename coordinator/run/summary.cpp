#include "coordinator/run/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "proto/participant/field_names.hpp"
#include "proto/scene/names.hpp"

namespace fluxpact {
namespace {

/// Cross-section of the domain that the weight rests on: volume over height along gravity [m²].
double cross_section(const Mesh& mesh, const Vector3& up) {
  double volume = 0;
  for (const double cell : mesh.cell_volumes) volume += cell;
  double low = INFINITY;
  double high = -INFINITY;
  for (const Vector3& point : mesh.points) {
    low = std::min(low, point.dot(up));
    high = std::max(high, point.dot(up));
  }
  return volume / (high - low);
}

}  // namespace

void Summary::start(const Mesh& mesh, const Scene& scene, const CommittedState& state) {
  mesh_ = &mesh;
  window_ = scene.coupling.window;
  second_half_ = windows(scene) / 2;
  const Fields particles = fields_of(state.particles);
  const double gravity = scene.scene.gravity.norm();
  if (gravity > 0) {
    const double displaced = scene.fluid.density * particles.number(field::particle_volume);
    weight_per_area_ = gravity * (particles.number(field::particle_mass) - displaced) /
                       cross_section(mesh, -scene.scene.gravity / gravity);
  }
}

/// Mean pressure of the cells at the faces where fluid enters, by area, less that where it leaves
/// [Pa].
double Summary::pressure_drop(const CommittedState& state) const {
  const Fields fluid = fields_of(state.fluid);
  const auto flux = fluid.scalars(field::face_flux, mesh_->faces());
  const auto pressure = fluid.scalars(field::pressure, mesh_->cells());
  double in = 0, in_pressure = 0, out = 0, out_pressure = 0;
  for (int face = mesh_->internal_faces(); face < mesh_->faces(); ++face) {
    const double area = mesh_->face_areas[face].norm();
    if (flux[face] < 0) {
      in += area;
      in_pressure += area * pressure[mesh_->owner[face]];
    } else if (flux[face] > 0) {
      out += area;
      out_pressure += area * pressure[mesh_->owner[face]];
    }
  }
  return in > 0 && out > 0 ? in_pressure / in - out_pressure / out : 0.0;
}

void Summary::add(const AuditRow& row, const CommittedState& state, double record_seconds) {
  ++windows_;
  mass_in_.add(row.mass.mass_in * window_);
  mass_out_.add(row.mass.mass_out * window_);
  largest_imbalance_ = std::max(largest_imbalance_, std::abs(row.mass.relative_imbalance));
  largest_residual_ = std::max(largest_residual_, row.mass.max_cell_residual);
  largest_handover_ =
      std::max({largest_handover_, row.momentum.handover_error, row.momentum.impulse_error});
  largest_particle_error_ = std::max(largest_particle_error_, row.particles.mass_error);
  const double excess = row.particles.window.excess_moved;
  largest_excess_ = std::max(largest_excess_, excess);
  excess_windows_ += excess > 0 ? 1 : 0;
  largest_correction_ =
      std::max(largest_correction_, fields_of(state.fluid).number(field::closure_correction));
  if (row.step > second_half_) {
    pressure_drop_.add(pressure_drop(state));
    ++pressure_windows_;
  }
  const Fields given = fields_of(state.particles);
  const auto beyond = given.numbers().find(field::particles_beyond_drag);
  if (beyond != given.numbers().end() && row.particles.window.count > 0) {
    const double share = beyond->second / static_cast<double>(row.particles.window.count);
    beyond_drag_ += share;
    most_beyond_drag_ = std::max(most_beyond_drag_, share);
  }
  solver_iterations_ += row.solver_iterations;
  scalars_.resize(row.scalars.size());
  for (std::size_t i = 0; i < scalars_.size(); ++i) {
    ScalarExtent& extent = scalars_[i];
    extent.lowest = std::min(extent.lowest, row.scalars[i].lowest);
    extent.highest = std::max(extent.highest, row.scalars[i].highest);
    extent.largest_imbalance =
        std::max(extent.largest_imbalance, std::abs(row.scalars[i].imbalance));
  }
  cfd_ += row.wall_cfd;
  dem_ += row.wall_dem;
  exchange_ += row.wall_exchange;
  both_ += row.wall_both;
  record_ += record_seconds;
  last_ = row;
}

std::string Summary::text(const Scene& scene, double wall_seconds) const {
  if (windows_ == 0) return "no window was committed\n";
  fmt::memory_buffer text;
  const auto line = [&]<class... Args>(fmt::format_string<Args...> pattern, Args&&... args) {
    fmt::format_to(std::back_inserter(text), pattern, std::forward<Args>(args)...);
    text.push_back('\n');
  };
  line("\n{}: {} windows, {:.6g} s simulated in {:.1f} s", scene.scene.name, windows_, last_.time,
       wall_seconds);
  line("  continuity            {}", scene.coupling.continuity == Continuity::conservative
                                         ? "conservative"
                                         : "LEGACY (does not conserve mass; for comparison only)");
  line("  gas in / out          {:.9g} / {:.9g} kg", mass_in_.value(), mass_out_.value());
  line("  largest imbalance     {:.2e} of the inflow, in any window", largest_imbalance_);
  line("  largest cell residual {:.2e} of the cell's gas", largest_residual_);
  line("  drift at the end      {:.2e} of the gas in the domain",
       std::abs(last_.mass.cumulative_drift));
  line("  momentum handover     {:.2e} relative, in any window", largest_handover_);
  const Vector3& flight = last_.momentum.ledger;
  line("  in flight at the end  momentum ({:.3g}, {:.3g}, {:.3g}) N s, on its way to the particles",
       flight.x(), flight.y(), flight.z());
  if (scene.coupling.scheme == CouplingScheme::parallel) {
    line("                        {:.3g} kg of fluid, yet to give way to particles that came in",
         last_.mass.displaced);
  }
  line("  flux closure          {:.2e} of the largest flux, at most", largest_correction_);
  const std::vector<ScalarName> names = scalar_names(scene);
  for (std::size_t i = 0; i < scalars_.size(); ++i) {
    line("  scalar {:<14} {:.15g} .. {:.15g}; budget {:.2e} of its amount, in any window",
         names[i].name, scalars_[i].lowest, scalars_[i].highest, scalars_[i].largest_imbalance);
  }
  if (violations_ > 0)
    line("  AUDIT VIOLATIONS      in {} of {} windows (limit {:g}; on_violation: warn)",
         violations_, windows_, scene.coupling.audit.limit);
  const ParticleWindow& particles = last_.particles.window;
  line("  particles             {} ({:.6g} kg)", particles.count, particles.mass);
  if (particles_flow(scene)) {
    const ParticleTotal& flow = last_.particles.total;
    line("  particles in and out  {} in ({:.6g} kg), {} out ({:.6g} kg), {} waiting",
         flow.count_entered, flow.entered.value(), flow.count_left, flow.left.value(),
         particles.waiting);
    line("  particle mass         {:.2e} relative, in any window", largest_particle_error_);
  }
  if (figures_.contains(field::precision_velocity_rms)) {
    line(
        "  mixed precision       off double after one more window: velocities {:.2g} (rms; at most "
        "{:.2g}) of their gains,",
        figures_.at(field::precision_velocity_rms), figures_.at(field::precision_velocity_max));
    line(
        "                        overlaps {:.2g} ({:.2g}) of their mean, positions {:.2g} ({:.2g}) "
        "of the radius",
        figures_.at(field::precision_overlap_rms), figures_.at(field::precision_overlap_max),
        figures_.at(field::precision_position_rms), figures_.at(field::precision_position_max));
  }
  if (excess_windows_ > 0) {
    line(
        "  over-full cells       passed on up to {:.3g} m3 of particles a window, in {} of {} "
        "windows",
        largest_excess_, excess_windows_, windows_);
  }
  if (most_beyond_drag_ > 0) {
    line(
        "  drag law              {}: {:.3g} % of the particles beyond its range, at most {:.3g} % "
        "in a window",
        name_of(scene.interphase.drag), 100 * beyond_drag_ / static_cast<double>(windows_),
        100 * most_beyond_drag_);
  }
  if (pressure_windows_ > 0) {
    const double drop = pressure_drop_.value() / static_cast<double>(pressure_windows_);
    const std::string weight =
        particles.count > 0 ? fmt::format("; bed weight per area {:.4g} Pa", weight_per_area_)
                            : std::string{};
    line("  pressure drop         {:.4g} Pa (mean of the second half){}", drop, weight);
  }
  line("  fluid                 {:.3g} iterations of the pressure and {:.3g} ms a window",
       static_cast<double>(solver_iterations_) / static_cast<double>(windows_),
       1000 * cfd_ / static_cast<double>(windows_));
  const double steps = cfd_ + dem_ - both_ + exchange_ + record_;
  const auto share = [&](double part) { return 100 * part / std::max(steps, 1e-12); };
  line("  wall time             total {:.2f} s, {:.3g} ms a window", wall_seconds,
       1000 * steps / static_cast<double>(windows_));
  line("    particles (DEM)     {:8.2f} s  {:5.1f} %", dem_, share(dem_));
  line("    fluid (CFD)         {:8.2f} s  {:5.1f} %", cfd_, share(cfd_));
  if (both_ > 0) line("    of these both       {:8.2f} s  {:5.1f} %", both_, share(both_));
  line("    exchange + audit    {:8.2f} s  {:5.1f} %", exchange_, share(exchange_));
  line("    record              {:8.2f} s  {:5.1f} %", record_, share(record_));
  line("  results               {} (audit.csv, results.h5, results.xdmf, run.log)",
       scene.output.directory);
  return fmt::to_string(text);
}

}  // namespace fluxpact
