#include "mavlink/frame.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace sonopose::mavlink {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint8_t start_v1 = 0xFE;
constexpr std::uint8_t start_v2 = 0xFD;
constexpr std::size_t header_v1 = 6;
constexpr std::size_t header_v2 = 10;
constexpr std::size_t crc_size = 2;
constexpr std::size_t signature_size = 13;
constexpr std::uint8_t signed_flag = 1;

struct Seed {
  std::uint32_t message_id;
  std::uint8_t crc_extra;
};
constexpr std::array seeds{Seed{heartbeat_id, 50}, Seed{vision_position_estimate_id, 158},
                           Seed{timesync_id, 34}, Seed{odometry_id, 91}};

/// CRC-16/MCRF4XX.
std::uint16_t crc_of(Bytes bytes, std::uint8_t seed) {
  std::uint32_t crc = 0xFFFF;
  const auto add = [&crc](std::uint8_t byte) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? (crc >> 1U) ^ 0x8408U : crc >> 1U;
  };
  std::for_each(bytes.begin(), bytes.end(), add);
  add(seed);
  return static_cast<std::uint16_t>(crc);
}

/// Layout of the frame that begins at the first byte.
struct Layout {
  std::size_t header = 0;
  std::size_t payload = 0;
  std::size_t total = 0;
};

/// Empty while its header is incomplete.
std::optional<Layout> layout_of(Bytes bytes) {
  const bool is_v2 = bytes[0] == start_v2;
  const std::size_t header = is_v2 ? header_v2 : header_v1;
  if (bytes.size() < header) return std::nullopt;
  const std::size_t signature = is_v2 && (bytes[2] & signed_flag) != 0 ? signature_size : 0;
  return Layout{header, bytes[1], header + bytes[1] + crc_size + signature};
}

Frame frame_at(Bytes bytes, const Layout& layout) {
  Frame frame;
  if (layout.header == header_v2) {
    frame.sender = {bytes[5], bytes[6]};
    frame.message_id = bytes[7] | std::uint32_t{bytes[8]} << 8U | std::uint32_t{bytes[9]} << 16U;
  } else {
    frame.sender = {bytes[3], bytes[4]};
    frame.message_id = bytes[5];
  }
  frame.size = layout.payload;
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(layout.header), layout.payload,
              frame.payload.begin());
  return frame;
}

}  // namespace

std::optional<std::uint8_t> checksum_seed(std::uint32_t message_id) {
  const auto* const found = std::find_if(seeds.begin(), seeds.end(),
                                         [&](const Seed& seed) { return seed.message_id == message_id; });
  return found == seeds.end() ? std::nullopt : std::optional(found->crc_extra);
}

std::vector<std::uint8_t> encode(const Frame& frame, std::uint8_t sequence) {
  const auto seed = checksum_seed(frame.message_id);
  if (!seed) throw std::invalid_argument("no MAVLink message " + std::to_string(frame.message_id));
  std::size_t size = std::min(frame.size, max_payload);
  while (size > 1 && frame.payload.at(size - 1) == 0) --size;  // as version 2 requires
  const auto id = frame.message_id;
  std::vector<std::uint8_t> bytes{start_v2,
                                  static_cast<std::uint8_t>(size),
                                  0,
                                  0,
                                  sequence,
                                  frame.sender.system,
                                  frame.sender.component,
                                  static_cast<std::uint8_t>(id),
                                  static_cast<std::uint8_t>(id >> 8U),
                                  static_cast<std::uint8_t>(id >> 16U)};
  bytes.insert(bytes.end(), frame.payload.begin(), frame.payload.begin() + static_cast<std::ptrdiff_t>(size));
  const std::uint16_t crc = crc_of(Bytes(bytes).subspan(1), *seed);
  bytes.push_back(static_cast<std::uint8_t>(crc));
  bytes.push_back(static_cast<std::uint8_t>(crc >> 8U));
  return bytes;
}

void Decoder::feed(Bytes bytes, const std::function<void(const Frame&)>& on_frame) {
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  const std::size_t taken = take(pending_, on_frame);
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(taken));
}

void Decoder::restart() {
  counters_.skipped += pending_.size();
  pending_.clear();
}

/// Returns how many bytes are done with.
std::size_t Decoder::take(Bytes bytes, const std::function<void(const Frame&)>& on_frame) {
  std::size_t at = 0;
  while (at < bytes.size()) {
    const Bytes rest = bytes.subspan(at);
    if (rest[0] != start_v1 && rest[0] != start_v2) {
      ++counters_.skipped;
      ++at;
      continue;
    }
    const auto layout = layout_of(rest);
    if (!layout || rest.size() < layout->total) break;
    const Frame frame = frame_at(rest, *layout);
    const std::size_t covered = layout->header + layout->payload;
    const auto seed = checksum_seed(frame.message_id);
    const auto sent = static_cast<std::uint16_t>(rest[covered] | std::uint32_t{rest[covered + 1]} << 8U);
    if (seed && crc_of(rest.subspan(1, covered - 1), *seed) != sent) {
      ++counters_.damaged;
      ++at;  // the start may be a byte of another frame
      continue;
    }
    at += layout->total;
    ++(seed ? counters_.frames : counters_.unknown);
    if (seed) on_frame(frame);
  }
  return at;
}

}  // namespace sonopose::mavlink
