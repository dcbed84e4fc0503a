#pragma once
/// \file
/// Bytes as beacons send them, with the times at which they send them.

#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

namespace sonopose::test {

using Bytes = std::vector<std::uint8_t>;

Bytes read_bytes(const std::filesystem::path& file);

/// One frame, and when its beacon sends it, counted from the first one.
struct TimedFrame {
  TimeNs sent_after_ns = 0;
  Bytes bytes;
};

/// The frames in `bytes`, which must consist of whole good frames alone; throws std::invalid_argument where
/// they do not.
std::vector<TimedFrame> timed_frames(std::span<const std::uint8_t> bytes);

/// Each frame as the UDP datagram with the same content.
std::vector<TimedFrame> timed_datagrams(std::span<const std::uint8_t> bytes);

/// Hands the frames to `send` at their times, from now on. What is due is sent; a sender that was held up
/// catches up.
void send_in_time(std::span<const TimedFrame> frames,
                  const std::function<void(std::span<const std::uint8_t>)>& send);

}  // namespace sonopose::test
