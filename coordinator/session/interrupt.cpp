#include "coordinator/session/interrupt.hpp"

#include <csignal>

namespace fluxpact {
namespace {

volatile std::sig_atomic_t count = 0;  // a signal handler can reach nothing else

void on_signal(int) { count = count + 1; }

}  // namespace

void watch_for_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction ignore {};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &ignore, nullptr);
  sigaction(SIGXFSZ, &ignore, nullptr);
}

int interrupts() { return count; }

}  // namespace fluxpact
