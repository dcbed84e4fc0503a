#include "support/beacon_bytes.hpp"

#include "marvelmind/assembler.hpp"
#include "marvelmind/decoder.hpp"
#include "marvelmind/encoder.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

namespace sonopose::test {
namespace {

using marvelmind::Frame;
using marvelmind::Packet;

Bytes copy_of(const Frame& frame) {
  return {frame.bytes().begin(), frame.bytes().end()};
}

template <class Encode>
std::vector<TimedFrame> timed(std::span<const std::uint8_t> bytes, const Encode& encode) {
  std::vector<TimedFrame> frames;
  marvelmind::Decoder decoder;
  marvelmind::Assembler clock(marvelmind::TimeMapping::fixed);
  decoder.feed(bytes, [&](const Packet& packet) {
    constexpr TimeNs origin_ns = 1'000'000'000;
    frames.push_back({clock.replay_arrival_ns(packet, origin_ns) - origin_ns, copy_of(encode(packet))});
  });
  return frames;
}

}  // namespace

Bytes read_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<TimedFrame> timed_frames(std::span<const std::uint8_t> bytes) {
  auto frames = timed(bytes, marvelmind::encode);
  Bytes together;
  for (const auto& frame : frames) together.insert(together.end(), frame.bytes.begin(), frame.bytes.end());
  if (!std::equal(together.begin(), together.end(), bytes.begin(), bytes.end())) {
    throw std::invalid_argument("not whole good frames alone");
  }
  return frames;
}

std::vector<TimedFrame> timed_datagrams(std::span<const std::uint8_t> bytes) {
  return timed(bytes, marvelmind::encode_datagram);
}

void send_in_time(std::span<const TimedFrame> frames,
                  const std::function<void(std::span<const std::uint8_t>)>& send) {
  const auto began = std::chrono::steady_clock::now();
  for (const TimedFrame& frame : frames) {
    std::this_thread::sleep_until(began + std::chrono::nanoseconds(frame.sent_after_ns));
    send(frame.bytes);
  }
}

}  // namespace sonopose::test
