// The coordinator's view of a session: who takes part, in which state each is, and how to ask them.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>

#include "proto/session/channel.hpp"
#include "proto/session/process.hpp"
#include "proto/session/state_machine.hpp"

namespace fluxpact {

class Session {
 public:
  /// Open the socket; with launch.mode local also start the two servers that lie beside this
  /// program, their output appended to `log`. Throws SystemError or ConfigError.
  Session(const Scene& scene, const Mesh& mesh, const std::filesystem::path& log,
          const std::string& log_level);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  std::string endpoint() const { return channel_.endpoint(); }

  /// Wait for both participants, check them against each other and the scene, and hand them scene
  /// and mesh.
  void greet(const std::string& scene_text, const Mesh& mesh);

  /// Say something to a participant and, if it is answered, wait for the result. Throws
  /// ProtocolError if the participant ends, is silent past the deadline, or breaks the protocol;
  /// Error with its own exit code if it reports one.
  Message ask(Role role, Message& message);

  /// The same of both at once, which then work at the same time.
  struct Replies {
    Message fluid;
    Message particles;
  };
  Replies ask_both(Message& fluid, Message& particles);
  void tell(Role role, Message& message);

  /// Step and attempt that the next messages carry.
  void set_step(std::int64_t step, std::int64_t attempt) {
    step_ = step;
    attempt_ = attempt;
  }

  /// Say bye and wait for the processes that we started. Never throws.
  void close() noexcept;

 private:
  struct Peer {
    Role role = Role::fluid;
    std::string name;  ///< for messages: "cfd_server" or "dem_server"
    std::string routing;
    std::string backend;
    std::vector<std::string> gives, needs;
    bool offers = false;
    SessionState state = SessionState::greeting;
    std::int64_t sent = 0;
    std::int64_t received = 0;
    bool asked = false;            ///< we wait for a result
    std::optional<Message> reply;  ///< the result, once it is here
    std::chrono::steady_clock::time_point last_sign{};
    std::unique_ptr<Process> process;  ///< if we started it
    bool present() const { return !routing.empty(); }
  };

  Peer& peer(Role role) { return peers_[static_cast<std::size_t>(role)]; }
  Peer* find(const std::string& routing);
  void launch(const std::filesystem::path& log, const std::string& log_level);
  void take_message(Milliseconds patience);
  void take_from_stranger(const Arrival& arrival);
  void take_hello(const std::string& routing, const Message& hello);
  void refuse(const std::string& routing, const std::string& reason);
  void check_matching() const;
  void check_header(const Peer& from, const Header& header) const;
  void check_processes();
  void keep_idle_awake();
  void await_replies(MessageType asked);
  Message take_reply(Role role);
  std::string where(const Peer& of) const;

  const Scene& scene_;
  std::string id_;
  std::filesystem::path run_directory_;  ///< private folder of the ipc socket, removed at the end
  CoordinatorChannel channel_;
  std::array<Peer, 2> peers_;
  std::int64_t step_ = 0;
  std::int64_t attempt_ = 0;
  std::int64_t foreign_messages_ = 0;
  std::chrono::steady_clock::time_point last_heartbeat_{};
};

}  // namespace fluxpact
