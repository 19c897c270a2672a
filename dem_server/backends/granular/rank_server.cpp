#include "dem_server/backends/granular/rank_server.hpp"

#include <omp.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "dem_server/backends/granular/ranks.hpp"
#include "proto/base/logging.hpp"
#include "proto/message/mesh_message.hpp"
#include "proto/participant/server_main.hpp"
#include "proto/scene/names.hpp"
#include "proto/scene/read_scene.hpp"

namespace fluxpact {
namespace {

constexpr int message_tag = 2;
constexpr useconds_t nap = 50;  // [us] while nothing is asked: the fluid needs the processor

std::span<std::byte> bytes_of(std::string& text) {
  return std::as_writable_bytes(std::span(text.data(), text.size()));
}

void send(const Ranks& ranks, Message& message) {
  std::string header = encode_header(message.header);
  const auto size = static_cast<long long>(header.size());
  for (int rank = 1; rank < ranks.size(); ++rank) {
    MPI_Send(&size, 1, MPI_LONG_LONG, rank, message_tag, ranks.all());
  }
  ranks.broadcast(bytes_of(header));
  for (zmq::message_t& frame : message.frames) {
    ranks.broadcast({static_cast<std::byte*>(frame.data()), frame.size()});
  }
}

Message receive(const Ranks& ranks) {
  for (int there = 0; there == 0;) {
    MPI_Iprobe(0, message_tag, ranks.all(), &there, MPI_STATUS_IGNORE);
    if (there == 0) usleep(nap);
  }
  long long size = 0;
  MPI_Recv(&size, 1, MPI_LONG_LONG, 0, message_tag, ranks.all(), MPI_STATUS_IGNORE);
  std::string header(static_cast<std::size_t>(size), ' ');
  ranks.broadcast(bytes_of(header));
  Message message;
  message.header = decode_header(std::as_bytes(std::span(header.data(), header.size())));
  for (const ArrayInfo& array : message.header.arrays) {
    std::size_t frame = size_of(array.dtype);
    for (const std::int64_t length : array.shape) frame *= static_cast<std::size_t>(length);
    zmq::message_t& room = message.frames.emplace_back(frame);
    ranks.broadcast({static_cast<std::byte*>(room.data()), room.size()});
  }
  return message;
}

/// The threads of a machine are shared by the ranks on it.
Scene share_threads(Scene scene, const Ranks& ranks) {
  int& threads = scene.particles.numerics.threads;
  if (threads == 0) threads = std::max(1, omp_get_num_procs() / ranks.size());
  return scene;
}

/// Rank 0: what it is asked it asks of the others, too, and waits for them at the end.
class Leader final : public Participant {
 public:
  Leader(const Ranks& ranks, std::unique_ptr<Participant> own)
      : ranks_(ranks), own_(std::move(own)) {}

  Identity identity() const override { return own_->identity(); }
  void keep_alive(Progress alive) override { own_->keep_alive(std::move(alive)); }

  void configure(const Scene& scene, const Mesh& mesh) override {
    const Scene shared = share_threads(scene, ranks_);
    Message words;
    words.header.type = MessageType::configure;
    words.header.body["scene"] = write_scene(shared);
    send(ranks_, words);
    Message geometry = mesh_message(mesh);
    send(ranks_, geometry);
    own_->configure(shared, mesh);
    ranks_.meet();
  }
  void start(const Fields& in, Fields& out) override {
    pass_on(MessageType::start, {}, in);
    own_->start(in, out);
    ranks_.meet();
  }
  void advance(const Window& window, const Fields& in, Fields& out,
               const Progress& progress) override {
    pass_on(MessageType::advance, window, in);
    own_->advance(window, in, out, progress);
    ranks_.meet();
  }
  void offer(const Window& window, const Fields& in, Fields& out,
             const Progress& progress) override {
    pass_on(MessageType::offer, window, in);
    own_->offer(window, in, out, progress);
    ranks_.meet();
  }
  void commit() override {
    pass_on(MessageType::commit, {}, {});
    own_->commit();
    ranks_.meet();
  }
  void rollback() override {
    pass_on(MessageType::rollback, {}, {});
    own_->rollback();
    ranks_.meet();
  }
  // Rank 0 knows all particles.
  void snapshot(Fields& out) override { own_->snapshot(out); }
  void figures(Fields& out, const Progress& progress) override { own_->figures(out, progress); }

 private:
  void pass_on(MessageType type, const Window& window, const Fields& in) {
    Message message;
    message.header.type = type;
    message.header.step = window.step;
    add_fields(message, in);
    message.header.body["start"] = window.start;
    message.header.body["length"] = window.length;
    send(ranks_, message);
  }

  const Ranks& ranks_;
  std::unique_ptr<Participant> own_;
};

/// Any other rank, until rank 0 says bye.
void follow(const Ranks& ranks, Participant& own) {
  Scene scene;
  for (;;) {
    const Message message = receive(ranks);
    const Header& header = message.header;
    const auto window = [&] {
      return Window{header.step, number(header, "start"), number(header, "length")};
    };
    Fields out;
    switch (header.type) {
      case MessageType::configure:
        scene = read_scene(text(header, "scene"), "the scene of rank 0");
        continue;
      case MessageType::mesh:
        own.configure(scene, mesh_of(message));
        break;
      case MessageType::start:
        own.start(fields_of(message), out);
        break;
      case MessageType::advance:
        own.advance(window(), fields_of(message), out, {});
        break;
      case MessageType::offer:
        own.offer(window(), fields_of(message), out, {});
        break;
      case MessageType::commit:
        own.commit();
        break;
      case MessageType::rollback:
        own.rollback();
        break;
      default:  // bye
        return;
    }
    ranks.meet();
  }
}

int serve_as_follower(const Ranks& ranks, const EngineMaker& engine) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // with mpirun, however that ends
  log_to_stderr(fmt::format("dem_server, rank {}", ranks.rank()), "error");
  const std::string where = fmt::format("rank {}: ", ranks.rank());
  try {
    const auto own = make_particle_participant(std::string(name_of(engine.backend)), {engine});
    follow(ranks, *own);
    return static_cast<int>(ExitCode::done);
  } catch (const Error& error) {
    ranks.report(where + error.what(), error.exit_code());
  } catch (const std::exception& error) {
    ranks.report(where + error.what(), ExitCode::participant);
  }
}

}  // namespace

int rank_server_main(int argc, char** argv, const EngineMaker& engine) {
  const Ranks ranks;
  if (ranks.size() == 1) return particle_server_main(argc, argv, "dem_server", {engine});
  if (ranks.rank() > 0) return serve_as_follower(ranks, engine);
  ServerProgram server;
  server.name = "dem_server";
  server.description = "fluxpact particle server: takes part in a session as the particle side";
  server.backends.emplace_back(name_of(engine.backend));
  server.make = [&](const std::string& backend) {
    return std::make_unique<Leader>(ranks, make_particle_participant(backend, {engine}));
  };
  const int code = server_main(argc, argv, server);
  if (code != static_cast<int>(ExitCode::done)) MPI_Abort(ranks.all(), code);
  Message bye;
  bye.header.type = MessageType::bye;
  send(ranks, bye);
  return code;
}

}  // namespace fluxpact
