/// Serialized bytes of every message, compared with a manual layout.

#include "ros2/messages/raw_cdr.hpp"
#include "support/ros2_fields.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cstring>

namespace sonopose::cdr_test {

using namespace sonopose::test;

/// Serializes fields in little-endian XCDR1. A number is aligned to its size, relative to the end of the
/// encapsulation header. A string is its length with the terminating zero, its characters and the zero. A
/// sequence is its length and its elements.
class Layout {
public:
  template <class Number>
  void number(Number value) {
    while ((bytes_.size() - header_size) % sizeof(value) != 0) bytes_.push_back(0);
    std::array<std::uint8_t, sizeof(value)> raw{};
    std::memcpy(raw.data(), &value, sizeof(value));  // this machine is little-endian
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
  }
  void text(const char* value) {
    number(static_cast<std::uint32_t>(std::strlen(value) + 1));
    bytes_.insert(bytes_.end(), value, value + std::strlen(value) + 1);
  }
  template <class Sequence>
  void length(const Sequence& sequence) {
    number(sequence._length);
  }

  [[nodiscard]] const Bytes& bytes() const { return bytes_; }

private:
  static constexpr std::size_t header_size = 4;
  Bytes bytes_{0x00, 0x01, 0x00, 0x00};  // CDR, little-endian, no options
};

/// Pads the bytes to words, as sent. The header's last two bits count the padding bytes (DDS-XTypes 1.3,
/// 7.6.3.1.2); ROS 2 ignores them.
Bytes padded(Bytes bytes) {
  while (bytes.size() % 4 != 0) {
    bytes.push_back(0);
    ++bytes[3];
  }
  return bytes;
}

/// First difference; empty if equal. (Catch would take minutes to print all bytes.)
std::string difference(const Bytes& actual, const Bytes& expected) {
  for (std::size_t i = 0; i < std::min(actual.size(), expected.size()); ++i) {
    if (actual[i] == expected[i]) continue;
    return "byte " + std::to_string(i) + " is " + std::to_string(actual[i]) + ", not " +
           std::to_string(expected[i]);
  }
  if (actual.size() == expected.size()) return "";
  return std::to_string(actual.size()) + " bytes, not " + std::to_string(expected.size());
}

template <class Message>
void check(const std::vector<std::uint32_t>& lengths = {1}) {
  Filled<Message> filled{Filler(lengths)};
  Layout expected;
  visit(expected, filled.message);
  RawTopic topic(dds::TopicTraits<Message>::descriptor());
  CHECK(difference(topic.bytes_of(&filled.message), padded(expected.bytes())) == "");
  topic.read(expected.bytes(), filled.message,
             [&](const Message& read) { CHECK((described(read) == described(filled.message))); });
}

TEST_CASE("Every message is serialized as in ROS 2, and deserialized") {
  check<ros2::PointStamped>();
  check<ros2::PoseWithCovarianceStamped>();
  check<ros2::Imu>();
  check<ros2::MagneticField>();
  check<ros2::Odometry>();
  for (const std::uint32_t length : {0U, 1U, 7U, 500U}) {
    CAPTURE(length);
    check<ros2::Path>({length});
    check<ros2::TFMessage>({length});
  }
  for (const auto& lengths : {std::vector<std::uint32_t>{0}, {3, 0, 1, 5}, {40, 9, 0}}) {
    check<ros2::DiagnosticArray>(lengths);
    check<ros2::ParticipantEntitiesInfo>(lengths);
    check<ros2::HumbleParticipantEntitiesInfo>(lengths);
  }
}

TEST_CASE("A point, byte by byte") {
  const Bytes expected{
      0x00, 0x01, 0x00, 0x00,                                // CDR, little-endian, no options
      0x15, 0xcd, 0x5b, 0x07,                                // header.stamp.sec: 123 456 789
      0xff, 0xc9, 0x9a, 0x3b,                                // header.stamp.nanosec: 999 999 999
      0x05, 0x00, 0x00, 0x00, 'h',  'a',  'l',  'l',  0x00,  // header.frame_id: 5 bytes with the zero
      0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,              // padding to 8
      0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xf0, 0x3f,        // point.x: 1
      0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x04, 0xc0,        // point.y: -2.5
      0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80,        // point.z: -0
  };
  char hall[] = "hall";
  const ros2::PointStamped point{.header = {{123'456'789, 999'999'999}, hall}, .point = {1.0, -2.5, -0.0}};
  RawTopic topic(dds::TopicTraits<ros2::PointStamped>::descriptor());
  CHECK(difference(topic.bytes_of(&point), expected) == "");
}

TEST_CASE("Diagnostics, byte by byte") {
  const Bytes expected{
      0x00, 0x01, 0x00, 0x01,                               // CDR, little-endian; one padding byte
      0xfe, 0xff, 0xff, 0xff,                               // header.stamp.sec: -2
      0x01, 0x00, 0x00, 0x00,                               // header.stamp.nanosec: 1
      0x01, 0x00, 0x00, 0x00, 0x00,                         // header.frame_id: empty, only the zero
      0x00, 0x00, 0x00,                                     // padding to 4
      0x01, 0x00, 0x00, 0x00,                               // status: one
      0x02,                                                 // level: ERROR
      0x00, 0x00, 0x00,                                     // padding to 4
      0x06, 0x00, 0x00, 0x00, 'n',  ':', ' ', 'i', 'n', 0,  // name
      0x00, 0x00,                                           // padding to 4
      0x03, 0x00, 0x00, 0x00, 'n',  'o', 0,                 // message
      0x00,                                                 // padding to 4
      0x02, 0x00, 0x00, 0x00, '7',  0,                      // hardware_id
      0x00, 0x00,                                           // padding to 4
      0x01, 0x00, 0x00, 0x00,                               // values: one
      0x02, 0x00, 0x00, 0x00, 'k',  0,                      // key
      0x00, 0x00,                                           // padding to 4
      0x03, 0x00, 0x00, 0x00, '4',  '2', 0,                 // value
      0x00,                                                 // padding
  };
  char empty[] = "", name[] = "n: in", message[] = "no", hardware[] = "7", key[] = "k", value[] = "42";
  ros2::KeyValue pair{key, value};
  ros2::DiagnosticStatus status{2, name, message, hardware, {1, 1, &pair, false}};
  const ros2::DiagnosticArray array{{{-2, 1}, empty}, {1, 1, &status, false}};
  RawTopic topic(dds::TopicTraits<ros2::DiagnosticArray>::descriptor());
  CHECK(difference(topic.bytes_of(&array), expected) == "");
}

}  // namespace sonopose::cdr_test
