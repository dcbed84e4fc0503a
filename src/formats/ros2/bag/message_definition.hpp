#pragma once
/// \file
/// The definition of a ROS 2 message in the syntax of .msg files, by which any message can be read.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::ros2::bag {

class MessageDefinition {
public:
  /// Parses a schema with the encoding `ros2msg`: the type, then each of its parts after a line of "=" and
  /// "MSG: pkg/Name". `type`: such as "sensor_msgs/msg/Imu". Empty if it is incomplete, or has a wstring.
  static std::optional<MessageDefinition> parse(std::string_view type, std::string_view text);

  /// Writes a message in XCDR1 as JSON like json::json_of. Empty if the bytes are not a whole message of this
  /// type.
  [[nodiscard]] std::string json_of(std::span<const std::byte> cdr) const;

  enum class Kind : std::uint8_t {
    boolean,
    int8,
    uint8,
    int16,
    uint16,
    int32,
    uint32,
    int64,
    uint64,
    float32,
    float64,
    string,
    part
  };
  enum class Repetition : std::uint8_t { one, array, sequence };

  struct Field {
    std::string name;
    Kind kind = Kind::boolean;
    std::size_t part = 0;  ///< index of the type, for Kind::part
    Repetition repetition = Repetition::one;
    std::size_t count = 1;  ///< length of an array
  };
  using Type = std::vector<Field>;

private:
  std::vector<Type> types_;  ///< the first one is that of the message
};

}  // namespace sonopose::ros2::bag
