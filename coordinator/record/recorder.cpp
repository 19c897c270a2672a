#include "coordinator/record/recorder.hpp"

#include <spdlog/spdlog.h>

#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "coordinator/record/results_file.hpp"
#include "proto/base/errors.hpp"

namespace fluxpact {

namespace {

constexpr auto scene_name = "scene.yaml";
constexpr auto csv_name = "audit.csv";
constexpr auto xdmf_name = "results.xdmf";
// By this line we know a directory that we may write over.
constexpr std::string_view scene_mark =
    "# The resolved scene of a fluxpact run, every default filled in. It marks this directory as a "
    "record.\n";

bool holds_our_scene(const std::filesystem::path& directory) {
  const std::filesystem::path scene = directory / scene_name;
  return std::filesystem::exists(scene) && read_file(scene).starts_with(scene_mark);
}

// The directory exists and holds nothing that would be lost. Returns it, so that it can stand first
// in the list of initialisers.
std::filesystem::path prepare(std::filesystem::path directory, const std::string& scene_text) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) {
    throw SystemError("cannot make the results directory '{}': {}. Choose another one with --out",
                      directory.string(), error.message());
  }
  if (!holds_our_scene(directory)) {
    for (const char* name : {scene_name, csv_name, results_file_name, xdmf_name}) {
      if (!std::filesystem::exists(directory / name)) continue;
      throw ConfigError(
          "'{}' holds a file '{}' that no run wrote, and a record would replace it. Choose another "
          "directory with --out, or move the file away",
          directory.string(), name);
    }
  }
  replace_file(directory / scene_name, std::string(scene_mark) + scene_text);
  // An old index would name datasets that the new file does not have yet.
  std::filesystem::remove(directory / xdmf_name, error);
  if (error) {
    throw SystemError("cannot remove '{}': {}", (directory / xdmf_name).string(), error.message());
  }
  return directory;
}

XdmfIndex make_index(Hdf5File& file, const Mesh& mesh) {
  if (mesh.lattice) return {results_file_name, *mesh.lattice};
  const XdmfPolyhedra polyhedra = draw_polyhedra(mesh);
  file.write(drawn::points, as_doubles(polyhedra.points), {polyhedra.points.size(), 3}, "m");
  file.write(drawn::connectivity, std::span(polyhedra.connectivity),
             {polyhedra.connectivity.size()}, "1");
  return {results_file_name, mesh.cells(), polyhedra};
}

void check_ids(std::span<const double> ids) {
  // Doubles tell whole numbers apart up to here.
  constexpr double most = 9007199254740992.0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const bool whole = std::abs(ids[i]) <= most && ids[i] == std::floor(ids[i]);
    if (!whole || (i > 0 && ids[i] <= ids[i - 1])) {
      throw ProtocolError(
          "the particle side sent id {} in row {} of its snapshot: ids must be whole and ascending",
          ids[i], i);
    }
  }
}

}  // namespace

Recorder::Recorder(std::filesystem::path directory, const Mesh& mesh, const RunDescription& run)
    : directory_(prepare(std::move(directory), run.scene_text)),
      scalars_(run.scalars),
      particle_flow_(run.particle_flow),
      cells_(static_cast<std::size_t>(mesh.cells())),
      faces_(static_cast<std::size_t>(mesh.faces())),
      // First: HDF5 locks the file, so a second run into the same directory stops here.
      file_(create_results(directory_ / results_file_name, run.program_version, run.continuity)),
      audit_(std::in_place, file_, scalars_, particle_flow_),
      csv_(TextFile::create(directory_ / csv_name)),
      index_(make_index(file_, mesh)) {
  write_mesh(file_, mesh);
  csv_.append(audit_csv_header(scalars_, particle_flow_));
  file_.flush();
}

Recorder::~Recorder() {
  try {
    close();
  } catch (const std::exception& error) {
    spdlog::error("the record in '{}' is not complete: {}", directory_.string(), error.what());
  }
}

void Recorder::append(const AuditRow& row) {
  line_.clear();
  const auto add = [&](const AuditColumn& column) {
    if (line_.size() > 0) line_.push_back(',');
    // The shortest text that reads back to the same bits.
    std::visit(
        [&](const auto value) { fmt::format_to(std::back_inserter(line_), "{}", value(row)); },
        column.value);
  };
  for (const AuditColumn& column : audit_columns()) add(column);
  if (particle_flow_) {
    for (const AuditColumn& column : flow_columns()) add(column);
  }
  for (const ScalarAudit& scalar : row.scalars) {
    for (const ScalarColumn& column : scalar_columns())
      fmt::format_to(std::back_inserter(line_), ",{}", column.value(scalar));
  }
  line_.push_back('\n');
  csv_.append({line_.data(), line_.size()});

  audit_->append(row);
  if (!audit_->full()) return;
  audit_->write_out();
  file_.flush();
}

std::string Recorder::begin_record(const char* kind, std::size_t index, const Moment& moment) {
  std::string group = fmt::format("/{}/{}", kind, record_name(index));
  file_.make_group(group);
  file_.set_attribute(group, "time", moment.time);
  file_.set_attribute(group, "step", moment.step);
  return group;
}

// The index comes last: it never names what is not there.
void Recorder::finish_record() {
  audit_->write_out();
  file_.flush();
  replace_file(directory_ / xdmf_name, index_.text());
}

void Recorder::record_fields(const Moment& moment, const FieldRecord& fields) {
  const std::string group = begin_record("fields", field_records_++, moment) + "/";
  const auto scalar = [&](const char* name, std::span<const double> values, const char* units,
                          std::size_t rows) { file_.write(group + name, values, {rows}, units); };
  const auto vector = [&](const char* name, std::span<const Vector3> values, const char* units) {
    file_.write(group + name, as_doubles(values), {cells_, 3}, units);
  };
  scalar("voidage", fields.voidage, "1", cells_);
  vector("velocity", fields.velocity, "m/s");
  scalar("pressure", fields.pressure, "Pa", cells_);
  scalar("drag_coefficient", fields.drag_coefficient, "kg/s", cells_);
  vector("particle_velocity", fields.particle_velocity, "m/s");
  scalar("face_flux", fields.face_flux, "kg/s", faces_);
  std::vector<XdmfField> of_cells{{"voidage", group + "voidage"},
                                  {"velocity", group + "velocity", 3},
                                  {"pressure", group + "pressure"},
                                  {"drag_coefficient", group + "drag_coefficient"},
                                  {"particle_velocity", group + "particle_velocity", 3}};
  for (std::size_t i = 0; i < scalars_.size(); ++i) {
    const std::string name = "scalar_" + scalars_[i].name;
    scalar(name.c_str(), fields.scalars.at(i),
           scalars_[i].kind == ScalarKind::temperature ? "K" : "1", cells_);
    of_cells.push_back({name, group + name});
  }
  index_.add_fields(moment.time, of_cells);
  finish_record();
}

void Recorder::record_particles(const Moment& moment, const ParticleRecord& particles) {
  check_ids(particles.id);
  ids_.resize(particles.id.size());
  for (std::size_t i = 0; i < ids_.size(); ++i)
    ids_[i] = static_cast<std::int64_t>(particles.id[i]);

  const std::size_t count = ids_.size();
  const std::string group = begin_record("particles", particle_records_++, moment) + "/";
  const auto scalar = [&](const char* name, std::span<const double> values, const char* units) {
    file_.write(group + name, values, {count}, units);
  };
  const auto vector = [&](const char* name, std::span<const Vector3> values, const char* units) {
    file_.write(group + name, as_doubles(values), {count, 3}, units);
  };
  file_.write(group + "id", std::span<const std::int64_t>(ids_), {count}, "1");
  vector("position", particles.position, "m");
  vector("velocity", particles.velocity, "m/s");
  vector("spin", particles.spin, "rad/s");
  scalar("radius", particles.radius, "m");
  scalar("density", particles.density, "kg/m3");
  // A grid without points makes readers fail: a time without particles is left out of the drawing.
  if (count > 0) {
    index_.add_particles(moment.time, count, group + "position",
                         {{"id", group + "id", 1, true},
                          {"velocity", group + "velocity", 3},
                          {"spin", group + "spin", 3},
                          {"radius", group + "radius"},
                          {"density", group + "density"}});
  }
  finish_record();
}

void Recorder::close() {
  if (!audit_) return;
  // The columns hold the file open: they go first, even if their last rows cannot be written.
  AuditTable audit = std::move(*audit_);
  audit_.reset();
  audit.write_out();
  { const AuditTable closed = std::move(audit); }
  file_.close();
  csv_.close();
}

}  // namespace fluxpact
