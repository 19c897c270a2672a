#include "dem_server/participant/late_exchange.hpp"

#include <array>
#include <utility>

#include "dem_server/interphase/first_window.hpp"
#include "dem_server/interphase/prediction.hpp"
#include "proto/base/compensated_sum.hpp"

namespace fluxpact {

void LateExchange::start(std::span<const double> voidage) {
  answered_.initial = true;
  rows_.clear();
  past_length_ = 0;
  offered_ = false;
  voidage_.assign(voidage.begin(), voidage.end());
  impulse_given_.assign(voidage.size(), Vector3::Zero());
}

void LateExchange::offer(const Here& here, const Window& window, const Fields& in,
                         OfferMaker& maker, FluidView& view, Offer& standing) {
  const ExchangeSettings& settings = here.settings;
  const FluidSeen fluid =
      fluid_seen(settings, in, static_cast<int>(here.voidage.size()), !answered_.initial);
  measure_bulk(here.particles, bulk_);
  if (here.rows_change) {
    places_.id = here.particles.id;
    places_.position = here.particles.position;
  }
  find_forces(here, window, fluid, maker, view, standing);

  velocity_ = here.particles.velocity;
  velocities_ahead(settings, here.particles, bulk_,
                   {past_velocity_, past_length_, &past_forces_, rows_}, forces_, window.length,
                   ahead_);
  standing.window = window.length;
  standing.initial = false;
  maker.make(
      settings, view.of(fluid, standing.weights),
      standing.weights.seen(here.voidage, voidage_seen_), here.particles, bulk_,
      {velocity_, window.length, &forces_, {}, rows_.empty() ? answered_.eddies : eddies_, ahead_},
      standing);
  length_ = window.length;
  offered_ = true;
}

void LateExchange::find_forces(const Here& here, const Window& window, const FluidSeen& fluid,
                               OfferMaker& maker, FluidView& view, Offer& standing) {
  const ExchangeSettings& settings = here.settings;
  departed_.setZero();
  if (!fluid.solved) {
    first_forces(settings,
                 {window.step, window.length, here.particles, bulk_, here.voidage,
                  here.cell_volumes, here.add_up},
                 fluid, maker, view, standing, forces_);
    deposit_vectors(standing.weights, forces_.impulse, settings.threads, impulse_given_);
    return;
  }
  // No rows and others than before: all have left.
  const bool same = rows_.empty() && here.particles.size() == answered_.weights.particles();
  WindowForces& answer = same ? forces_ : answer_;
  window_forces(settings, answered_, view.of(fluid, answered_.weights),
                same ? here.particles : answered_places_, answered_bulk_, window.step,
                window.length, answer);
  deposit_vectors(answered_.weights, answer.impulse, settings.threads, impulse_given_);
  if (!same) match_rows(here);
}

/// From the rows of the offer that was answered to those of the particles that are there now.
void LateExchange::match_rows(const Here& here) {
  const auto count = rows_.size();
  for (auto* array : {&forces_.drag_impulse, &forces_.impulse, &forces_.force}) {
    array->assign(count, Vector3::Zero());
  }
  eddies_.assign(count, Eddy{});
  std::array<CompensatedSum, 3> departed;
  std::size_t next = 0;  // row of the answer that is not accounted for yet
  const auto leave_until = [&](std::size_t row) {
    for (; next < row; ++next) {
      for (int axis = 0; axis < 3; ++axis) departed.at(axis).add(answer_.impulse[next][axis]);
    }
  };
  for (std::size_t row = 0; row < count; ++row) {
    if (rows_[row] < 0) {
      if (here.settings.buoyancy) {
        forces_.force[row] =
            -here.settings.fluid.density * bulk_.volume[row] * here.settings.gravity;
      }
      continue;
    }
    const auto before = static_cast<std::size_t>(rows_[row]);
    leave_until(before);
    next = before + 1;
    forces_.drag_impulse[row] = answer_.drag_impulse[before];
    forces_.impulse[row] = answer_.impulse[before];
    forces_.force[row] = answer_.force[before];
    if (before < answered_.eddies.size()) eddies_[row] = answered_.eddies[before];
  }
  leave_until(answer_.impulse.size());
  departed_ = {departed[0].value(), departed[1].value(), departed[2].value()};
}

void LateExchange::commit(Offer& committed, Offer& candidate, std::vector<double>& voidage,
                          std::span<const int> rows) {
  std::swap(answered_, committed);
  std::swap(committed, candidate);
  std::swap(voidage_, voidage);
  std::swap(answered_bulk_, bulk_);
  std::swap(answered_places_, places_);
  std::swap(past_forces_, forces_);
  std::swap(past_velocity_, velocity_);
  past_length_ = length_;
  rows_.assign(rows.begin(), rows.end());
  offered_ = false;
}

std::vector<Vector3> LateExchange::last_force(int count) const {
  std::vector<Vector3> force(static_cast<std::size_t>(count), Vector3::Zero());
  if (rows_.empty() && past_forces_.force.size() == force.size()) return past_forces_.force;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    if (rows_[row] >= 0) force[row] = past_forces_.force[static_cast<std::size_t>(rows_[row])];
  }
  return force;
}

}  // namespace fluxpact
