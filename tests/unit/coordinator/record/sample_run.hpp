// A small made-up run for the tests of the record.
#pragma once

#include <filesystem>
#include <vector>

#include "coordinator/record/recorder.hpp"
#include "proto/mesh/box.hpp"

namespace fluxpact {

inline Mesh sample_box(std::vector<Axis> periodic = {}) {
  MeshSettings settings;
  settings.box = {{0, 0, 0}, {0.3, 0.2, 0.8}, {3, 2, 4}};
  settings.patches = {{"inlet", {Side::z_min, {}}}};
  settings.periodic = std::move(periodic);
  return make_box(settings);
}

/// The same mesh sheared: no lattice stands behind it any more.
inline Mesh sample_sheared(std::vector<Axis> periodic = {}) {
  const Mesh box = sample_box(std::move(periodic));
  MeshTopology topology = static_cast<const MeshTopology&>(box);
  for (Vector3& point : topology.points) point.x() += 0.25 * point.z();
  return with_geometry(std::move(topology));
}

inline AuditRow sample_row(int step) {
  AuditRow row;
  row.step = step;
  row.time = 0.1 * step;
  row.mass.mass_in = 1.0 / (step + 2);
  row.mass.max_cell_residual = 1e-16 / 3 * step;
  row.mass.fluid_mass = 4.9e-324;  // the smallest double
  row.momentum.ledger = {-1.0 / 3, 1e300 / 7, 0.1 + 0.2};
  row.particles.window.count = 3;
  row.wall_cfd = 0.125;
  return row;
}

/// Numbers for every field, different for each time.
struct SampleState {
  SampleState(const Mesh& mesh, int particles, double seed) {
    const auto cells = static_cast<std::size_t>(mesh.cells());
    for (std::size_t c = 0; c < cells; ++c) {
      const double number = seed + 0.1 * static_cast<double>(c);
      scalar.push_back(number);
      vector.emplace_back(number, -number, 1 / (1 + number));
    }
    for (int face = 0; face < mesh.faces(); ++face) flux.push_back(seed - face);
    for (int i = 0; i < particles; ++i) {
      id.push_back(1 + 2 * i);
      position.emplace_back(0.05 * (i + 1), 0.1, 0.3 + 0.01 * seed);
      radius.push_back(1e-3 * (i + 1));
    }
  }
  FieldRecord fields() const { return {scalar, vector, scalar, scalar, vector, flux}; }
  ParticleRecord particles() const { return {id, position, position, position, radius, radius}; }

  std::vector<double> scalar;
  std::vector<Vector3> vector;
  std::vector<double> flux;
  std::vector<double> id;
  std::vector<Vector3> position;
  std::vector<double> radius;
};

/// Start, 300 windows (more than are kept back), and a record after windows 100 and 300.
inline void record_sample_run(const std::filesystem::path& directory, const Mesh& mesh,
                              double wall_seconds = 0.125) {
  Recorder recorder(directory, mesh, {"version: 1\n", "0.0-test", Continuity::conservative});
  recorder.record_fields({0, 0}, SampleState(mesh, 0, 1).fields());
  recorder.record_particles({0, 0}, SampleState(mesh, 0, 1).particles());
  for (int step = 1; step <= 300; ++step) {
    AuditRow row = sample_row(step);
    row.wall_dem = wall_seconds;
    recorder.append(row);
    if (step != 100 && step != 300) continue;
    const SampleState state(mesh, 3, step);
    recorder.record_fields({step, row.time}, state.fields());
    recorder.record_particles({step, row.time}, state.particles());
  }
  recorder.close();
}

}  // namespace fluxpact
