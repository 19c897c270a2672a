// What a solver implements to take part, and what it is handed.
//
// A participant keeps a committed and a candidate state. `advance` writes only the candidate;
// `commit` makes it the committed one; `rollback` forgets it. That one idea gives retry, implicit
// coupling and recovery. What `offer` says of a window is part of that window's candidate.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "proto/base/vector.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// A named array on its way in or out: a view, the data stay with their owner until the next call.
struct FieldView {
  std::string name;
  int components = 1;  ///< 1: scalar per row, 3: vector per row
  std::span<const double> values;
};

/// The arrays and numbers of one message, in order.
class Fields {
 public:
  void add(std::string name, std::span<const double> values) {
    views_.push_back({std::move(name), 1, values});
  }
  void add(std::string name, std::span<const Vector3> values) {
    views_.push_back({std::move(name), 3, as_doubles(values)});
  }
  void add_number(std::string name, double value) { numbers_[std::move(name)] = value; }

  /// Throw ProtocolError naming the field if it is missing or has another size than asked for.
  std::span<const double> scalars(std::string_view name, int size) const;
  std::span<const Vector3> vectors(std::string_view name, int size) const;
  double number(std::string_view name) const;

  const std::vector<FieldView>& views() const { return views_; }
  const std::map<std::string, double>& numbers() const { return numbers_; }

 private:
  const FieldView& find(std::string_view name, int components, int size) const;
  std::vector<FieldView> views_;
  std::map<std::string, double> numbers_;
};

/// One coupling window.
struct Window {
  std::int64_t step = 0;  ///< number of the window, from 1
  double start = 0;       ///< [s]
  double length = 0;      ///< [s]
  double end() const { return start + length; }
};

enum class Role { fluid, particles };

/// Who a participant is, and the names of the fields that it gives and needs.
struct Identity {
  Role role = Role::fluid;
  std::string backend;
  std::vector<std::string> gives;
  std::vector<std::string> needs;
  /// Particles: can `offer`, and so take part in coupling.scheme parallel.
  bool offers = false;
};

/// To be called now and then during a long `advance`: tells the coordinator that we are alive.
/// Cheap.
using Progress = std::function<void()>;

class Participant {
 public:
  virtual ~Participant() = default;
  virtual Identity identity() const = 0;

  /// What long work in `configure` is to call now and then; given before it. Without it the
  /// coordinator takes a silence of launch.start_deadline for a hang.
  // NOLINTNEXTLINE(performance-unnecessary-value-param): who keeps it moves it
  virtual void keep_alive(Progress /*alive*/) {}

  /// Build everything for this scene and mesh. The committed state is that of time 0.
  virtual void configure(const Scene& scene, const Mesh& mesh) = 0;

  /// The fields of the committed state at time 0, so that the other side has something to start
  /// from. Called once, after `configure`; `in` holds the initial fields of the participants before
  /// us.
  virtual void start(const Fields& in, Fields& out) = 0;

  /// From the committed state at window.start to a candidate at window.end().
  virtual void advance(const Window& window, const Fields& in, Fields& out,
                       const Progress& progress) = 0;
  virtual void commit() = 0;
  virtual void rollback() = 0;

  /// Particles in coupling.scheme parallel, before the `advance` of the same window, which then
  /// gets no fields: from the committed state at window.start, and what the fluid has made of it,
  /// the drag that the fluid is to meet in this window. Throws ProtocolError unless
  /// `Identity::offers`.
  virtual void offer(const Window& window, const Fields& in, Fields& out, const Progress& progress);

  /// The committed state of what only this side holds (particles), for the record. Empty if
  /// nothing.
  virtual void snapshot(Fields& out) = 0;

  /// Figures of the whole run, as numbers: asked at most once, after the last window. The committed
  /// state stays as it is.
  virtual void figures(Fields& /*out*/, const Progress& /*progress*/) {}
};

}  // namespace fluxpact
