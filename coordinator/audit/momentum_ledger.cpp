#include "coordinator/audit/momentum_ledger.hpp"

#include <cmath>

#include "coordinator/audit/mass_ledger.hpp"

namespace fluxpact {

namespace {

// No error is none even where nothing is exchanged; any error there is infinite.
double ratio(double error, double scale) { return error == 0 ? 0 : error / scale; }

struct HandedOver {
  CompensatedVector impulse;  ///< Σ H [N s]
  CompensatedSum scale;       ///< [N s]
  CompensatedSum difference;  ///< Σ |J sent − J recomputed| [N s]
  double worst = 0;           ///< the largest of these [N s]
  int worst_cell = -1;
};

HandedOver hand_over(const Mesh& mesh, const MomentumWindow& window) {
  HandedOver sum;
  for (std::size_t c = 0; c < mesh.cell_volumes.size(); ++c) {
    const double volume = mesh.cell_volumes[c];
    const Vector3 drag = window.drag_coefficient[c] * window.velocity[c];
    Vector3 returned = Vector3::Zero();
    if (!window.pressure_return.empty()) {
      returned = window.pressure_return[c] * window.pressure_gradient[c];
    }
    const Vector3 expected = window.length * (window.drag_source[c] - drag - returned);
    const double difference = (window.impulse_taken[c] - expected).norm();
    sum.difference.add(difference);
    if (!std::isnan(sum.worst) && !(difference <= sum.worst)) {
      sum.worst = difference;
      sum.worst_cell = static_cast<int>(c);
    }

    Vector3 handed = -window.impulse_taken[c];
    if (window.pressure_gradient_force) {
      handed -= window.length * (1 - window.voidage[c]) * volume * window.pressure_gradient[c];
      sum.scale.add(window.length * audit_floor * volume * window.pressure_gradient[c].norm());
    }
    sum.impulse.add(handed);
    sum.scale.add(handed.norm() +
                  window.length * (window.drag_source[c].norm() + drag.norm() + returned.norm()));
  }
  return sum;
}

}  // namespace

void CompensatedVector::add(const Vector3& term) {
  x.add(term.x());
  y.add(term.y());
  z.add(term.z());
}

MomentumAudit audit_momentum(const Mesh& mesh, const MomentumWindow& window,
                             const MomentumTotal& committed) {
  const HandedOver handed = hand_over(mesh, window);
  CompensatedVector given;
  for (const Vector3& impulse : window.impulse_given) given.add(impulse);

  MomentumAudit audit;
  audit.momentum_to_fluid = -handed.impulse.value();
  audit.momentum_to_particles = given.value();
  audit.impulse_error = ratio(handed.difference.value(), handed.scale.value());
  audit.impulse_error_cell = handed.worst_cell;
  Vector3 lent = Vector3::Zero();
  if (committed.begun) {
    audit.handover_error =
        ratio((audit.momentum_to_particles - committed.handed_over).norm(), committed.scale);
  } else {
    lent = audit.momentum_to_particles;
  }

  audit.total.begun = true;
  audit.total.handed_over = handed.impulse.value() - lent;
  audit.total.scale = handed.scale.value();
  audit.total.in_flight = committed.in_flight;
  audit.total.in_flight.add(handed.impulse.value());
  audit.total.in_flight.add(-audit.momentum_to_particles);
  audit.ledger = audit.total.in_flight.value();
  return audit;
}

}  // namespace fluxpact
