// The table of the session: its one path to commit, and nothing beside it.
#include <gtest/gtest.h>

#include "proto/base/errors.hpp"
#include "proto/session/state_machine.hpp"

namespace fluxpact {
namespace {

using enum MessageType;

TEST(StateMachine, leads_from_hello_to_a_committed_window) {
  SessionState state = SessionState::greeting;
  for (const MessageType said : {welcome, configure, mesh, start, advance, commit, advance,
                                 rollback, snapshot, advance, commit}) {
    const auto next = next_state(state, said);
    ASSERT_TRUE(next.has_value()) << name_of(said) << " in " << name_of(state);
    state = *next;
  }
  EXPECT_EQ(state, SessionState::committed);
}

TEST(StateMachine, leads_from_an_offer_to_its_window_or_back) {
  const auto leads = [](SessionState from, MessageType said) { return next_state(from, said); };
  EXPECT_EQ(leads(SessionState::committed, offer), SessionState::offered);
  EXPECT_EQ(leads(SessionState::offered, advance), SessionState::candidate);
  EXPECT_EQ(leads(SessionState::offered, rollback), SessionState::committed);
  for (const MessageType said : {offer, commit, snapshot, start})
    EXPECT_FALSE(leads(SessionState::offered, said).has_value()) << name_of(said);
  EXPECT_FALSE(leads(SessionState::candidate, offer).has_value());
  EXPECT_TRUE(is_answered(offer));
}

TEST(StateMachine, allows_a_commit_only_of_a_candidate) {
  for (const SessionState state :
       {SessionState::greeting, SessionState::welcomed, SessionState::configured,
        SessionState::meshed, SessionState::committed, SessionState::closed}) {
    EXPECT_FALSE(next_state(state, commit).has_value()) << name_of(state);
    EXPECT_FALSE(next_state(state, rollback).has_value()) << name_of(state);
  }
}

TEST(StateMachine, lets_nothing_be_said_once_closed) {
  for (int type = 0; type <= static_cast<int>(bye); ++type) {
    EXPECT_FALSE(next_state(SessionState::closed, static_cast<MessageType>(type)).has_value());
  }
}

TEST(StateMachine, names_peer_state_and_message_when_it_refuses) {
  try {
    require_next(SessionState::meshed, advance, "dem_server");
    FAIL();
  } catch (const ProtocolError& error) {
    const std::string text = error.what();
    for (const auto* part : {"dem_server", "advance", "meshed"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace fluxpact
