// Messages over a real socket: alignment, order, foreign bytes, size limits, peers that are not
// there.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <numeric>

#include "proto/base/errors.hpp"
#include "proto/session/channel.hpp"

namespace fluxpact {
namespace {

constexpr Milliseconds patience{5000};

std::string socket_path() {
  static int count = 0;
  return "ipc:///tmp/fluxpact-test-" + std::to_string(getpid()) + "-" + std::to_string(count++);
}

Message message_of_sizes(const std::vector<std::vector<double>>& arrays) {
  Message message;
  message.header.type = MessageType::result;
  for (std::size_t i = 0; i < arrays.size(); ++i)
    add_array(message, {fmt::format("a{}", i), 1, arrays[i]});
  return message;
}

// Borrowed memory must outlive the channel that sends it: so the arrays stand before the channels
// in these tests.

TEST(Channel, brings_arrays_of_any_size_aligned_and_unchanged) {
  std::vector<std::vector<double>> arrays;
  for (const std::size_t size : {0u, 1u, 3u, 4u, 5u, 100u, 1023u, 1024u, 5000u, 100000u}) {
    arrays.emplace_back(size);
    std::iota(arrays.back().begin(), arrays.back().end(), 0.5);
  }
  for (const std::string& endpoint : {socket_path(), std::string("tcp://127.0.0.1:*")}) {
    CoordinatorChannel coordinator(endpoint, 1 << 26);
    ParticipantChannel participant(coordinator.endpoint());
    Message sent = message_of_sizes(arrays);
    participant.send(sent, patience);
    const auto arrival = coordinator.wait({}, patience).arrival;
    ASSERT_TRUE(arrival && arrival->message) << (arrival ? arrival->defect : "nothing came");
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      const auto& frame = arrival->message->frames[i];
      EXPECT_TRUE(frame.size() == 0 ||
                  reinterpret_cast<std::uintptr_t>(frame.data()) % alignof(double) == 0);
      const auto got = fields_of(*arrival->message)
                           .scalars(fmt::format("a{}", i), static_cast<int>(arrays[i].size()));
      EXPECT_TRUE(std::equal(got.begin(), got.end(), arrays[i].begin(), arrays[i].end()));
    }
  }
}

TEST(Channel, brings_answers_back_to_the_one_who_asked) {
  CoordinatorChannel coordinator(socket_path(), 1 << 20);
  ParticipantChannel one(coordinator.endpoint());
  ParticipantChannel other(coordinator.endpoint());
  for (ParticipantChannel* each : {&one, &other}) {
    Message hello;
    hello.header.type = MessageType::hello;
    hello.header.body["name"] = std::string(each == &one ? "one" : "other");
    each->send(hello, patience);
  }
  for (int i = 0; i < 2; ++i) {
    auto arrival = coordinator.wait({}, patience).arrival;
    ASSERT_TRUE(arrival && arrival->message);
    Message reply;
    reply.header.type = MessageType::welcome;
    reply.header.body["name"] = text(arrival->message->header, "name");
    coordinator.send(arrival->peer, reply);
  }
  EXPECT_EQ(text(one.receive(patience)->header, "name"), "one");
  EXPECT_EQ(text(other.receive(patience)->header, "name"), "other");
}

TEST(Channel, reports_foreign_bytes_as_a_defect_and_goes_on) {
  CoordinatorChannel coordinator(socket_path(), 1 << 20);
  zmq::context_t context(1);
  zmq::socket_t stranger(context, zmq::socket_type::dealer);
  stranger.set(zmq::sockopt::linger, 0);
  stranger.connect(coordinator.endpoint());
  stranger.send(zmq::str_buffer("\xff\xfenonsense"), zmq::send_flags::none);
  const auto bad = coordinator.wait({}, patience).arrival;
  ASSERT_TRUE(bad.has_value());
  EXPECT_FALSE(bad->message.has_value());
  EXPECT_FALSE(bad->defect.empty());
  ParticipantChannel participant(coordinator.endpoint());
  Message hello;
  hello.header.type = MessageType::hello;
  participant.send(hello, patience);
  const auto good = coordinator.wait({}, patience).arrival;
  ASSERT_TRUE(good.has_value());
  EXPECT_TRUE(good->message.has_value());
}

TEST(Channel, drops_a_frame_over_the_limit_without_taking_it_in) {
  const std::vector<std::vector<double>> large{std::vector<double>(100000)};
  CoordinatorChannel coordinator(socket_path(), 4096);
  ParticipantChannel participant(coordinator.endpoint());
  Message message = message_of_sizes(large);
  participant.send(message, patience);
  EXPECT_FALSE(coordinator.wait({}, Milliseconds(300)).arrival.has_value());
}

TEST(Channel, says_so_when_a_peer_is_gone) {
  CoordinatorChannel coordinator(socket_path(), 1 << 20);
  Message message;
  EXPECT_THROW(coordinator.send("nobody", message), ProtocolError);
}

TEST(Channel, refuses_a_sequence_with_a_gap) {
  CoordinatorChannel coordinator(socket_path(), 1 << 20);
  ParticipantChannel participant(coordinator.endpoint());
  Message hello;
  hello.header.type = MessageType::hello;
  participant.send(hello, patience);
  const auto arrival = coordinator.wait({}, patience).arrival;
  ASSERT_TRUE(arrival.has_value());
  Message welcome;
  welcome.header.type = MessageType::welcome;
  welcome.header.sequence = 1;  // 0 was lost
  coordinator.send(arrival->peer, welcome);
  EXPECT_THROW(participant.receive(patience), ProtocolError);
}

TEST(Channel, waits_no_longer_than_asked) {
  ParticipantChannel participant(socket_path());
  EXPECT_FALSE(participant.receive(Milliseconds(50)).has_value());
}

TEST(Channel, names_an_address_that_it_cannot_use) {
  EXPECT_THROW(CoordinatorChannel("tcp://256.1.1.1:5", 1 << 20), SystemError);
  EXPECT_THROW(ParticipantChannel("nonsense"), SystemError);
}

}  // namespace
}  // namespace fluxpact
