#pragma once
/// \file
/// Bytes of beacons, with their transmission times.

#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

namespace sonopose::test {

using Bytes = std::vector<std::uint8_t>;

Bytes read_bytes(const std::filesystem::path& file);

/// One frame and its transmission time, relative to the first frame.
struct TimedFrame {
  TimeNs sent_after_ns = 0;
  Bytes bytes;
};

/// The frames in `bytes`. Throws std::invalid_argument if `bytes` contains anything but whole valid frames.
std::vector<TimedFrame> timed_frames(std::span<const std::uint8_t> bytes);

/// Each frame as a UDP datagram with the same content.
std::vector<TimedFrame> timed_datagrams(std::span<const std::uint8_t> bytes);

/// Passes the frames to `send` at their times, starting now. A delayed sender catches up.
void send_in_time(std::span<const TimedFrame> frames,
                  const std::function<void(std::span<const std::uint8_t>)>& send);

}  // namespace sonopose::test
