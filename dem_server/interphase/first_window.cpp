#include "dem_server/interphase/first_window.hpp"

#include "dem_server/interphase/prediction.hpp"

namespace fluxpact {

void first_forces(const ExchangeSettings& settings, const FirstWindow& at, const FluidSeen& fluid,
                  OfferMaker& maker, FluidView& view, Offer& offer, WindowForces& forces) {
  const auto cells = at.cell_volumes.size();
  std::vector<double> buffer;  // all of this is needed once in a run
  offer.window = at.length;
  offer.initial = true;
  maker.make(settings, view.of(fluid, offer.weights), offer.weights.seen(at.voidage, buffer),
             at.particles, at.bulk, {}, offer);
  for (int i = 0; i < at.particles.size(); ++i) {
    offer.velocity[i] = at.particles.velocity[i];
    if (!settings.mobile || at.particles.is_fixed(i)) offer.coefficient[i] = 0;
  }

  std::vector<double> coefficient(cells);
  std::vector<Vector3> velocity(cells);
  deposit_offer(offer, settings.threads, coefficient, velocity);
  if (at.add_up) {
    at.add_up(coefficient);
    at.add_up(numbers_in(velocity));
  }
  for (std::size_t c = 0; c < cells; ++c) {
    const double mass = settings.fluid.density * at.voidage[c] * at.cell_volumes[c];
    velocity[c] =
        (mass * fluid.velocity[c] + at.length * velocity[c]) / (mass + at.length * coefficient[c]);
  }
  FluidSeen answer;
  answer.solved = true;
  answer.velocity = velocity;
  answer.pressure_gradient = fluid.pressure_gradient;
  window_forces(settings, offer, view.of(answer, offer.weights), at.particles, at.bulk, at.step,
                at.length, forces);
}

void take_back(std::span<const Vector3> impulse_given, double length,
               std::span<Vector3> drag_source) {
  for (std::size_t c = 0; c < drag_source.size(); ++c) drag_source[c] -= impulse_given[c] / length;
}

}  // namespace fluxpact
