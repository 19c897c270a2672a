#include "proto/session/process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

/// What posix_spawn is told; freed on every way out.
struct SpawnSettings {
  posix_spawn_file_actions_t actions{};
  posix_spawnattr_t attributes{};

  explicit SpawnSettings(const std::string& log) {
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, 0644);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
};

/// Our environment; and unless the user says otherwise the threads of a server soon sleep while
/// they wait for each other. By default g++'s OpenMP spins for about a millisecond, which on a
/// machine with other work makes two threads several times slower than one; 10,000 rounds are some
/// 10 microseconds.
std::vector<std::string> environment_of_servers() {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable)
    variables.emplace_back(*variable);
  if (std::getenv("OMP_WAIT_POLICY") == nullptr && std::getenv("GOMP_SPINCOUNT") == nullptr)
    variables.emplace_back("GOMP_SPINCOUNT=10000");
  return variables;
}

/// As the system wants lists of strings.
std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

Process::Process(std::string name, const std::filesystem::path& program,
                 const std::vector<std::string>& arguments, const std::filesystem::path& log)
    : name_(std::move(name)) {
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<std::string> variables = environment_of_servers();
  const SpawnSettings settings(log.string());
  const int code = posix_spawn(&pid_, program.c_str(), &settings.actions, &settings.attributes,
                               pointers_to(words).data(), pointers_to(variables).data());
  if (code != 0) {
    pid_ = -1;
    throw SystemError("cannot start {} ('{}'): {}; it is expected there", name_, program.string(),
                      std::strerror(code));
  }
  watch();
}

void Process::watch() {
  descriptor_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  if (descriptor_ >= 0) return;
  const int reason = errno;
  finish(std::chrono::milliseconds(0));
  throw SystemError("cannot watch {} (process {}): {}", name_, pid_, std::strerror(reason));
}

Process::~Process() {
  finish(std::chrono::milliseconds(0));
  if (descriptor_ >= 0) close(descriptor_);
}

void Process::follow(pid_t successor, std::chrono::milliseconds grace) {
  finish(grace);
  close(descriptor_);
  pid_ = successor;
  status_.reset();
  watch();
}

std::optional<std::string> Process::ended() {
  if (!status_) {
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
    status_ = status;
  }
  if (WIFSIGNALED(*status_))
    return fmt::format("signal {} ({})", WTERMSIG(*status_), strsignal(WTERMSIG(*status_)));
  return fmt::format("exit code {}", WEXITSTATUS(*status_));
}

void Process::finish(std::chrono::milliseconds grace) noexcept {
  if (pid_ < 0 || status_) return;
  if (descriptor_ >= 0 && grace.count() > 0) {
    pollfd item{descriptor_, POLLIN, 0};
    poll(&item, 1, static_cast<int>(grace.count()));
  }
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) != pid_) {
    kill(pid_, SIGKILL);
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
  }
  status_ = status;
}

}  // namespace fluxpact
