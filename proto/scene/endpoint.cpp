#include "proto/scene/endpoint.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>

namespace fluxpact {
namespace {

/// The whole text as a number from 0 to `largest`; -1 if it is none.
int small_number(std::string_view text, int largest) {
  int value = -1;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = read.ec == std::errc() && read.ptr == text.data() + text.size();
  return whole && value >= 0 && value <= largest ? value : -1;
}

/// 127.x.y.z written in digits; a host called 127.example.org is another machine.
bool is_loopback_address(std::string_view host) {
  constexpr int loopback_network = 127;
  constexpr int largest_byte = 255;
  for (int part = 0; part < 4; ++part) {
    const std::size_t end = part < 3 ? host.find('.') : host.size();
    const int byte =
        end == std::string_view::npos ? -1 : small_number(host.substr(0, end), largest_byte);
    if (byte < 0 || (part == 0 && byte != loopback_network)) {
      return false;
    }
    host.remove_prefix(std::min(end + 1, host.size()));
  }
  return true;
}

}  // namespace

Reach reach_of(std::string_view endpoint) {
  constexpr std::string_view ipc = "ipc://";
  constexpr std::string_view tcp = "tcp://";
  if (endpoint.starts_with(ipc)) {
    return endpoint.size() > ipc.size() ? Reach::this_machine : Reach::unknown;
  }
  const std::size_t colon = endpoint.rfind(':');
  if (!endpoint.starts_with(tcp) || colon < tcp.size()) {
    return Reach::unknown;
  }
  const std::string_view host = endpoint.substr(tcp.size(), colon - tcp.size());
  const std::string_view port = endpoint.substr(colon + 1);
  constexpr int largest_port = 65535;
  if (host.empty() || host.find_first_of(" /") != std::string_view::npos ||
      (port != "*" && small_number(port, largest_port) < 1)) {
    return Reach::unknown;
  }
  return host == "localhost" || host == "[::1]" || is_loopback_address(host) ? Reach::this_machine
                                                                             : Reach::network;
}

}  // namespace fluxpact
