// Headers survive the wire; bytes that are no header are refused with a reason, cheaply.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <msgpack.hpp>

#include "proto/base/errors.hpp"
#include "proto/message/message.hpp"

namespace fluxpact {
namespace {

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

Header sample() {
  Header header;
  header.type = MessageType::advance;
  header.session = "0123456789abcdef";
  header.sequence = 7;
  header.step = 12;
  header.attempt = 1;
  header.body = {{"start", 0.1 + 0.2},
                 {"count", std::int64_t{-5}},
                 {"name", std::string("bed")},
                 {"gives", std::vector<std::string>{"a", "b"}}};
  header.arrays = {{"voidage", Dtype::f64, {1536}},
                   {"velocity", Dtype::f64, {1536, 3}},
                   {"owner", Dtype::i32, {0}}};
  return header;
}

TEST(Codec, returns_what_was_encoded) {
  const Header sent = sample();
  const Header got = decode_header(bytes_of(encode_header(sent)));
  EXPECT_EQ(got.type, sent.type);
  EXPECT_EQ(got.session, sent.session);
  EXPECT_EQ(got.sequence, sent.sequence);
  EXPECT_EQ(got.step, sent.step);
  EXPECT_EQ(got.attempt, sent.attempt);
  EXPECT_EQ(got.body, sent.body);
  ASSERT_EQ(got.arrays.size(), sent.arrays.size());
  for (std::size_t i = 0; i < got.arrays.size(); ++i) {
    EXPECT_EQ(got.arrays[i].name, sent.arrays[i].name);
    EXPECT_EQ(got.arrays[i].dtype, sent.arrays[i].dtype);
    EXPECT_EQ(got.arrays[i].shape, sent.arrays[i].shape);
  }
}

RC_GTEST_PROP(Codec, returns_any_number_bit_for_bit, (std::int64_t whole, std::uint64_t bits)) {
  Header sent = sample();
  const auto real = std::bit_cast<double>(bits);
  sent.body = {{"whole", whole}, {"real", real}};
  const Header got = decode_header(bytes_of(encode_header(sent)));
  RC_ASSERT(std::get<std::int64_t>(got.body.at("whole")) == whole);
  RC_ASSERT(std::bit_cast<std::uint64_t>(std::get<double>(got.body.at("real"))) == bits);
}

RC_GTEST_PROP(Codec, refuses_or_reads_any_bytes_but_never_fails_otherwise,
              (const std::string& noise)) {
  try {
    decode_header(bytes_of(noise));
  } catch (const ProtocolError&) {
  }
}

RC_GTEST_PROP(Codec, refuses_or_reads_a_damaged_header_but_never_fails_otherwise,
              (std::uint16_t place, char value)) {
  std::string bytes = encode_header(sample());
  bytes[place % bytes.size()] = value;
  try {
    decode_header(bytes_of(bytes));
  } catch (const ProtocolError&) {
  }
}

TEST(Codec, refuses_every_truncation_and_trailing_bytes) {
  const std::string whole = encode_header(sample());
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(decode_header(bytes_of(whole.substr(0, size))), ProtocolError);
  EXPECT_THROW(decode_header(bytes_of(whole + "x")), ProtocolError);
}

TEST(Codec, refuses_claims_of_size_before_it_allocates) {
  EXPECT_THROW(decode_header(bytes_of(std::string("\xdd\xff\xff\xff\xff", 5))),
               ProtocolError);  // a list of 2^32-1
  EXPECT_THROW(decode_header(bytes_of(std::string("\xdf\x02\xfa\xf0\x80", 5))),
               ProtocolError);  // a map of 50 million
  EXPECT_THROW(decode_header(bytes_of(std::string(100000, '\x91'))),
               ProtocolError);  // lists in lists
}

TEST(Codec, names_an_unknown_type) {
  std::string bytes = encode_header(sample());
  bytes.replace(bytes.find("advance"), 7, "advanse");
  try {
    decode_header(bytes_of(bytes));
    FAIL();
  } catch (const ProtocolError& error) {
    EXPECT_NE(std::string(error.what()).find("advanse"), std::string::npos);
  }
}

Message message_with(std::span<const double> values) {
  Message message;
  message.header = sample();
  message.header.arrays.clear();
  add_array(message, {"voidage", 1, values});
  return message;
}

TEST(Frames, must_have_the_size_that_their_shape_says) {
  const std::vector<double> values{1, 2, 3};
  Message message = message_with(values);
  EXPECT_NO_THROW(check_frames(message));
  message.header.arrays[0].shape = {4};
  EXPECT_THROW(check_frames(message), ProtocolError);
  message.header.arrays[0].shape = {3};
  message.frames.emplace_back();
  EXPECT_THROW(check_frames(message), ProtocolError);
}

TEST(Frames, are_read_by_name_and_shape) {
  const std::vector<double> values{1, 2, 3};
  const Message message = message_with(values);
  const Fields fields = fields_of(message);
  EXPECT_EQ(fields.scalars("voidage", 3)[2], 3);
  EXPECT_EQ(fields.number("start"), 0.1 + 0.2);
  EXPECT_THROW(fields.scalars("voidage", 4), ProtocolError);
  EXPECT_THROW(fields.vectors("voidage", 1), ProtocolError);
  EXPECT_THROW(fields.scalars("pressure", 3), ProtocolError);
  EXPECT_THROW(integer(message.header, "start"), ProtocolError);
  EXPECT_THROW(text(message.header, "missing"), ProtocolError);
}

TEST(Frames, are_shared_not_copied_when_they_go_on) {
  const std::vector<double> values(10000, 1.5);
  Message from = message_with(values);
  Message to;
  share_array(to, from, "voidage");
  EXPECT_EQ(to.frames[0].data(), static_cast<const void*>(values.data()));
  EXPECT_EQ(to.header.arrays[0].shape, from.header.arrays[0].shape);
}

}  // namespace
}  // namespace fluxpact
