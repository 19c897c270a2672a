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
  for (State* state : {&committed_, &candidate_}) {
    state->voidage.resize(cells);
    state->drag_coefficient.resize(cells);
  }
  pending_ = false;
}

void PrescribedSolids::start(const Fields& in, Fields& out) {
  const auto began = SteadyClock::now();
  const bool fluid_first = std::ranges::any_of(
      in.views(), [](const FieldView& view) { return view.name == field::velocity; });
  const int cells = static_cast<int>(cell_volumes_.size());
  evaluate(0, 0, fluid_first ? in.vectors(field::velocity, cells) : std::span(zero_));
  candidate_.window = first_window_;
  candidate_.initial = true;
  publish(seconds_since(began), out);
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
  progress();
  const int cells = static_cast<int>(cell_volumes_.size());
  const auto velocity = in.vectors(field::velocity, cells);
  const auto gradient = in.vectors(field::pressure_gradient, cells);
  pending_ = true;
  for (int cell = 0; cell < cells; ++cell) {
    Vector3 impulse = Vector3::Zero();
    if (!committed_.initial) {
      impulse = committed_.window * committed_.drag_coefficient[cell] * velocity[cell];
      if (settings_.pressure_gradient) {
        const double solids = (1 - committed_.voidage[cell]) * cell_volumes_[cell];
        impulse -= window.length * solids * gradient[cell];
      }
    }
    impulse_given_[cell] = impulse;
  }
  evaluate(window.end(), window.step, velocity);
  candidate_.window = window.length;
  candidate_.initial = false;
  publish(seconds_since(began), out);
}

void PrescribedSolids::evaluate(double time, std::int64_t step, std::span<const Vector3> velocity) {
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
    points_[cell] = {voidage, diameter_, velocity[cell].norm()};
  }
  const DragSurvey survey =
      drag_coefficients(settings_.drag, settings_.model, settings_.fluid, points_,
                        settings_.threads, candidate_.drag_coefficient);
  if (const int bad = survey.first_bad; bad >= 0) {
    const Vector3& x = cell_centres_[bad];
    throw_bad_drag(settings_.drag.law,
                   fmt::format("cell {} at ({}, {}, {}) m", bad, x.x(), x.y(), x.z()), points_[bad],
                   candidate_.drag_coefficient[bad]);
  }
  // From one sphere to the (1 − ε) V/V_p of them in the cell.
  const double sphere = ball_volume(diameter_ / 2);
  for (std::size_t cell = 0; cell < cell_volumes_.size(); ++cell) {
    candidate_.drag_coefficient[cell] *=
        (1 - candidate_.voidage[cell]) * cell_volumes_[cell] / sphere;
  }
}

void PrescribedSolids::publish(double wall_seconds, Fields& out) {
  CompensatedSum solids;
  for (std::size_t cell = 0; cell < cell_volumes_.size(); ++cell) {
    solids.add((1 - candidate_.voidage[cell]) * cell_volumes_[cell]);
  }
  out.add(field::voidage, candidate_.voidage);
  out.add(field::drag_coefficient, candidate_.drag_coefficient);
  out.add(field::drag_source, zero_);
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
  std::swap(committed_, candidate_);
  pending_ = false;
}

void PrescribedSolids::rollback() { pending_ = false; }

void PrescribedSolids::snapshot(Fields& /*out*/) {}

}  // namespace fluxpact
