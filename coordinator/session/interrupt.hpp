// Ctrl-C: the first ends the run after the current window, the second at once.
#pragma once

namespace fluxpact {

/// Count SIGINT and SIGTERM from now on instead of dying of them. SIGPIPE and SIGXFSZ become errors
/// of the writing call.
void watch_for_interrupts();

/// How many have come.
int interrupts();

}  // namespace fluxpact
