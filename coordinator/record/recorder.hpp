// The record of a run: scene.yaml, audit.csv, results.h5 and results.xdmf in one directory.
//
// Stands after the commit of a window: nothing is recorded that was not committed. After every
// record of fields or particles, and every 256 windows, results.h5 is flushed: it is readable up to
// there if the process dies. audit.csv is complete to the last row. Two runs with the same data
// give the same results.h5, to the byte.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coordinator/audit/audit_row.hpp"
#include "coordinator/record/audit_table.hpp"
#include "coordinator/record/xdmf.hpp"
#include "proto/base/vector.hpp"
#include "proto/io/hdf5.hpp"
#include "proto/io/text_file.hpp"
#include "proto/mesh/mesh.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// What is said once about a run.
struct RunDescription {
  std::string scene_text;  ///< the resolved scene as YAML
  std::string program_version;
  Continuity continuity = Continuity::conservative;
  std::vector<ScalarName> scalars = {};
  bool particle_flow = false;  ///< particles can come in or leave
};

/// A committed time.
struct Moment {
  std::int64_t step = 0;  ///< windows committed; 0: the start
  double time = 0;        ///< [s]
};

/// The committed fields; one row a cell, except `face_flux`: one a face.
struct FieldRecord {
  std::span<const double> voidage;                    ///< [-]
  std::span<const Vector3> velocity;                  ///< interstitial [m/s]
  std::span<const double> pressure;                   ///< p − ρ g·x [Pa]
  std::span<const double> drag_coefficient;           ///< [kg/s]
  std::span<const Vector3> particle_velocity;         ///< [m/s]
  std::span<const double> face_flux;                  ///< superficial, out of the owner [kg/s]
  std::vector<std::span<const double>> scalars = {};  ///< c, in the order of the run's scalars
};

/// The committed particles, one row each, ascending by id.
struct ParticleRecord {
  std::span<const double> id;         ///< whole numbers, as they come on the wire
  std::span<const Vector3> position;  ///< [m]
  std::span<const Vector3> velocity;  ///< [m/s]
  std::span<const Vector3> spin;      ///< [rad/s]
  std::span<const double> radius;     ///< [m]
  std::span<const double> density;    ///< [kg/m³]
};

class Recorder {
 public:
  /// Makes the directory and starts the record. One that holds an earlier record is written over:
  /// only the files that we write, whatever else it holds stays. Throws ConfigError if there are
  /// files of these names that no run of ours wrote (scene.yaml without our first line),
  /// SystemError naming path and reason if it cannot be written.
  Recorder(std::filesystem::path directory, const Mesh& mesh, const RunDescription& run);
  /// Closes; an error then can only be logged, so call `close` where it matters.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// One committed window. Throws SystemError.
  void append(const AuditRow& row);
  /// /fields/<index>. Sizes are those of the mesh. Throws SystemError.
  void record_fields(const Moment& moment, const FieldRecord& fields);
  /// /particles/<index>. Throws SystemError, and ProtocolError if ids are not whole or not
  /// ascending.
  void record_particles(const Moment& moment, const ParticleRecord& particles);
  /// Writes out what is kept back and closes all files. Throws SystemError.
  void close();

  const std::filesystem::path& directory() const { return directory_; }

 private:
  std::string begin_record(const char* kind, std::size_t index, const Moment& moment);
  void finish_record();

  std::filesystem::path directory_;
  std::vector<ScalarName> scalars_;
  bool particle_flow_ = false;
  std::size_t cells_ = 0;
  std::size_t faces_ = 0;
  Hdf5File file_;
  std::optional<AuditTable> audit_;
  TextFile csv_;
  XdmfIndex index_;
  std::size_t field_records_ = 0;
  std::size_t particle_records_ = 0;
  fmt::memory_buffer line_;        ///< reused for each row of audit.csv
  std::vector<std::int64_t> ids_;  ///< reused for each record of particles
};

}  // namespace fluxpact
