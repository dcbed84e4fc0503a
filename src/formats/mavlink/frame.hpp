#pragma once
/// \file
/// Frames of MAVLink 2, and those of version 1 that an autopilot may begin with. Source: mavlink.io,
/// "Packet Serialization" and "Message Checksums". There is no MAVLink library in Debian, so this is ours.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace sonopose::mavlink {

inline constexpr std::size_t max_payload = 255;

/// Ids of the messages that this program knows.
inline constexpr std::uint32_t heartbeat_id = 0;
inline constexpr std::uint32_t vision_position_estimate_id = 102;
inline constexpr std::uint32_t timesync_id = 111;
inline constexpr std::uint32_t odometry_id = 331;

/// Sender of a frame: a vehicle and one of its components.
struct Identity {
  std::uint8_t system = 1;
  std::uint8_t component = 1;

  bool operator==(const Identity&) const = default;
};

/// A frame without its checksum. The payload ends with zeros that are not transmitted.
struct Frame {
  std::uint32_t message_id = 0;
  Identity sender;
  std::array<std::uint8_t, max_payload> payload{};
  std::size_t size = 0;  ///< bytes of the payload
};

/// Seed of a message's checksum, CRC_EXTRA, which stands for its definition. Empty for messages that this
/// program does not know.
std::optional<std::uint8_t> checksum_seed(std::uint32_t message_id);

/// Bytes of a frame of version 2. Throws std::invalid_argument for an unknown message.
std::vector<std::uint8_t> encode(const Frame& frame, std::uint8_t sequence);

/// Finds frames in the bytes of a line. Frames of unknown messages are skipped: their checksums cannot be
/// verified.
class Decoder {
public:
  struct Counters {
    std::uint64_t frames = 0;   ///< known messages
    std::uint64_t unknown = 0;  ///< other messages
    std::uint64_t damaged = 0;  ///< with a wrong checksum
    std::uint64_t skipped = 0;  ///< bytes outside of frames
  };

  void feed(std::span<const std::uint8_t> bytes, const std::function<void(const Frame&)>& on_frame);

  /// Discards an incomplete frame, as at the end of a datagram: the next bytes are of another one.
  void restart();
  [[nodiscard]] const Counters& counters() const { return counters_; }

private:
  [[nodiscard]] std::size_t take(std::span<const std::uint8_t> bytes,
                                 const std::function<void(const Frame&)>& on_frame);

  std::vector<std::uint8_t> pending_;  ///< the beginning of a frame
  Counters counters_;
};

}  // namespace sonopose::mavlink
