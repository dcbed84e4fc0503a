#pragma once
/// \file
/// Bytes of beacons with their transmission times.

#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

namespace sonopose::test {

using Bytes = std::vector<std::uint8_t>;

Bytes read_bytes(const std::filesystem::path& file);

/// A frame and its transmission time relative to the first frame.
struct TimedFrame {
  TimeNs sent_after_ns = 0;
  Bytes bytes;
};

/// Splits `bytes` into frames. Throws std::invalid_argument unless all of them are whole and valid.
std::vector<TimedFrame> timed_frames(std::span<const std::uint8_t> bytes);

/// The frames as UDP datagrams with the same content.
std::vector<TimedFrame> timed_datagrams(std::span<const std::uint8_t> bytes);

/// Passes the frames to `send` at their times, starting now. A late sender catches up.
void send_in_time(std::span<const TimedFrame> frames,
                  const std::function<void(std::span<const std::uint8_t>)>& send);

}  // namespace sonopose::test
