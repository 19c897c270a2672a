#include "dem_server/participant/prescribed_solids.hpp"

#include <algorithm>
#include <chrono>

#include "dem_server/participant/particle_participant.hpp"
#include "proto/base/compensated_sum.hpp"
#include "proto/base/errors.hpp"
#include "proto/participant/field_names.hpp"

namespace fluxpact {
namespace {

using SteadyClock = std::chrono::steady_clock;

double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

}  // namespace

Identity PrescribedSolids::identity() const { return particle_identity(backend_); }

void PrescribedSolids::configure(const Scene& scene, const Mesh& mesh) {
  if (!scene.interphase.prescribed) {
    throw ConfigError(
        "interphase.voidage is 'prescribed', but interphase.prescribed (voidage, diameter) is "
        "missing");
  }
  settings_ = exchange_settings(scene, false);
  formula_.emplace(scene.interphase.prescribed->voidage);
  diameter_ = scene.interphase.prescribed->diameter;
  first_window_ = scene.coupling.window;
  cell_volumes_ = mesh.cell_volumes;
  cell_centres_ = mesh.cell_centres;
  const auto cells = cell_volumes_.size();
  points_.resize(cells);
  zero_.assign(cells, Vector3::Zero());
  impulse_given_.assign(cells, Vector3::Zero());
  offers_ = scene.coupling.scheme == CouplingScheme::parallel;
  for (State* state : {&answered_, &committed_, &candidate_}) {
    state->voidage.resize(cells);
    state->drag_coefficient.resize(cells);
  }
  pending_ = false;
  offered_ = false;
  answered_.initial = true;
}

void PrescribedSolids::start(const Fields& in, Fields& out) {
  const auto began = SteadyClock::now();
  const bool fluid_first = std::ranges::any_of(
      in.views(), [](const FieldView& view) { return view.name == field::velocity; });
  const int cells = static_cast<int>(cell_volumes_.size());
  find_voidage(0, 0);
  find_drag(fluid_first ? in.vectors(field::velocity, cells) : std::span(zero_), candidate_);
  candidate_.window = first_window_;
  candidate_.initial = true;
  publish_offer(candidate_, out);
  publish_state(seconds_since(began), out);
  std::swap(committed_, candidate_);
}

void PrescribedSolids::advance(const Window& window, const Fields& in, Fields& out,
                               const Progress& progress) {
  const auto began = SteadyClock::now();
  if (pending_) {
    throw ProtocolError(
        "particle side: asked to advance step {} while the last candidate is neither committed nor "
        "rolled back",
        window.step);
  }
  if (offers_ && !offered_) {
    throw ProtocolError(
        "particle side: asked to advance step {} in coupling.scheme parallel without being asked "
        "for its offer first",
        window.step);
  }
  progress();
  pending_ = true;
  if (!offers_) find_impulse(window, in, committed_);
  find_voidage(window.end(), window.step);
  if (!offers_) {
    find_drag(in.vectors(field::velocity, static_cast<int>(cell_volumes_.size())), candidate_);
    candidate_.window = window.length;
    candidate_.initial = false;
    publish_offer(candidate_, out);
  }
  publish_state(seconds_since(began), out);
}

void PrescribedSolids::offer(const Window& window, const Fields& in, Fields& out,
                             const Progress& progress) {
  if (!offers_) Participant::offer(window, in, out, progress);
  if (pending_) {
    throw ProtocolError(
        "particle side: asked for an offer in step {} while the last candidate is neither "
        "committed nor rolled back",
        window.step);
  }
  const auto began = SteadyClock::now();
  find_impulse(window, in, answered_);
  find_drag(in.vectors(field::velocity, static_cast<int>(cell_volumes_.size())), committed_);
  committed_.window = window.length;
  committed_.initial = false;
  offered_ = true;
  publish_offer(committed_, out);
  out.add_number(field::wall_seconds, seconds_since(began));
}

/// What the fluid gave in answer to the drag of `answered`.
void PrescribedSolids::find_impulse(const Window& window, const Fields& in, const State& answered) {
  const int cells = static_cast<int>(cell_volumes_.size());
  const auto velocity = in.vectors(field::velocity, cells);
  const auto gradient = in.vectors(field::pressure_gradient, cells);
  for (int cell = 0; cell < cells; ++cell) {
    Vector3 impulse = Vector3::Zero();
    if (!answered.initial) {
      impulse = answered.window * answered.drag_coefficient[cell] * velocity[cell];
      if (settings_.pressure_gradient) {
        const double solids = (1 - answered.voidage[cell]) * cell_volumes_[cell];
        impulse -= window.length * solids * gradient[cell];
      }
    }
    impulse_given_[cell] = impulse;
  }
}

void PrescribedSolids::find_voidage(double time, std::int64_t step) {
  for (std::size_t cell = 0; cell < cell_volumes_.size(); ++cell) {
    const Vector3& x = cell_centres_[cell];
    const double voidage = (*formula_)(x, time);
    if (!(voidage > 0 && voidage <= 1)) {
      throw NumericsError(
          "interphase.prescribed.voidage is {} in cell {} at ({}, {}, {}) m at {} s (step {}); it "
          "must be above 0 and at most 1 everywhere",
          voidage, cell, x.x(), x.y(), x.z(), time, step);
    }
    candidate_.voidage[cell] = voidage;
  }
}

/// The drag coefficient of the voidage of `state`.
void PrescribedSolids::find_drag(std::span<const Vector3> velocity, State& state) {
  for (std::size_t cell = 0; cell < cell_volumes_.size(); ++cell) {
    points_[cell] = {state.voidage[cell], diameter_, velocity[cell].norm()};
  }
  const DragSurvey survey = drag_coefficients(settings_.drag, settings_.model, settings_.fluid,
                                              points_, settings_.threads, state.drag_coefficient);
  if (const int bad = survey.first_bad; bad >= 0) {
    const Vector3& x = cell_centres_[bad];
    throw_bad_drag(settings_.drag.law,
                   fmt::format("cell {} at ({}, {}, {}) m", bad, x.x(), x.y(), x.z()), points_[bad],
                   state.drag_coefficient[bad]);
  }
  // From one sphere to the (1 − ε) V/V_p of them in the cell.
  const double sphere = ball_volume(diameter_ / 2);
  for (std::size_t cell = 0; cell < cell_volumes_.size(); ++cell) {
    state.drag_coefficient[cell] *= (1 - state.voidage[cell]) * cell_volumes_[cell] / sphere;
  }
}

void PrescribedSolids::publish_offer(const State& state, Fields& out) {
  out.add(field::drag_coefficient, state.drag_coefficient);
  out.add(field::drag_source, zero_);
}

void PrescribedSolids::publish_state(double wall_seconds, Fields& out) {
  CompensatedSum solids;
  for (std::size_t cell = 0; cell < cell_volumes_.size(); ++cell) {
    solids.add((1 - candidate_.voidage[cell]) * cell_volumes_[cell]);
  }
  out.add(field::voidage, candidate_.voidage);
  out.add(field::impulse_given, impulse_given_);
  out.add(field::particle_velocity, zero_);
  out.add_number(field::particle_volume, solids.value());
  out.add_number(field::particle_count, 0);  // solids without particles, and without a mass
  out.add_number(field::particle_mass, 0);
  out.add_number(field::excess_moved, 0);
  out.add_number(field::wall_seconds, wall_seconds);
}

void PrescribedSolids::commit() {
  if (!pending_) throw ProtocolError("particle side: asked to commit, but nothing was advanced");
  if (offers_) std::swap(answered_, committed_);
  std::swap(committed_, candidate_);
  pending_ = offered_ = false;
}

void PrescribedSolids::rollback() { pending_ = offered_ = false; }

void PrescribedSolids::snapshot(Fields& /*out*/) {}

}  // namespace fluxpact
