#include "marvelmind/decoder.hpp"

#include "marvelmind/bytes.hpp"
#include "marvelmind/crc16.hpp"
#include "marvelmind/payload_parser.hpp"

#include <algorithm>

namespace sonopose::marvelmind {

namespace {

std::uint16_t code_of(std::span<const std::uint8_t> frame) {
  return ByteReader(frame.subspan(2)).read<std::uint16_t>();
}

std::size_t payload_size_of(std::span<const std::uint8_t> frame) {
  return frame[4];
}

/// Parses the payload of a frame with a valid checksum, and counts it. Returns true if it is a packet.
bool parse(std::span<const std::uint8_t> frame, Packet& packet, DecoderCounters& counters) {
  const std::uint8_t type = frame[1];
  const std::uint16_t code = code_of(frame);
  const auto payload = frame.subspan(header_size, payload_size_of(frame));
  switch (parse_payload(type, code, payload, packet)) {
    case ParseResult::ok:
      ++counters.frames;
      return true;
    case ParseResult::unused:
      ++counters.frames;
      if (++counters.unused_frames == 1) counters.first_unused = find_unused_kind(type, code)->name;
      return false;
    case ParseResult::unknown:
      ++counters.unknown_frames;
      return false;
    case ParseResult::malformed:
      ++counters.malformed_frames;
      return false;
  }
  return false;
}

/// Copies the datagram's leading address into the packet's address slot if that is empty.
void complete_from_datagram(Packet& packet, std::uint8_t sender) {
  std::visit(
      [sender](auto& body) {
        if constexpr (requires { body.address; }) {
          if (body.address == 0 && sender != frame_start) body.address = sender;
        }
        if constexpr (requires { body.angle; }) {
          body.angle.word = static_cast<std::uint16_t>(body.angle.word & ~PairAngle::not_applicable);
        }
      },
      packet);
}

}  // namespace

std::size_t Decoder::fill(std::span<const std::uint8_t> bytes) {
  const auto rest = pending();
  std::copy(rest.begin(), rest.end(), buffer_.begin());  // ranges may overlap, since bytes move to the front
  end_ -= begin_;
  begin_ = 0;
  const std::size_t taken = std::min(bytes.size(), buffer_.size() - end_);
  std::copy_n(bytes.begin(), taken, buffer_.begin() + static_cast<std::ptrdiff_t>(end_));
  end_ += taken;
  return taken;
}

void Decoder::lose(std::size_t count) {
  begin_ += count;
  counters_.bytes_lost += count;
}

bool Decoder::lose_first_byte() {
  if (pending().empty()) return false;
  lose(1);
  return true;
}

const Packet* Decoder::next_packet() {
  for (;;) {
    const auto skipped = pending();
    lose(static_cast<std::size_t>(std::find(skipped.begin(), skipped.end(), frame_start) - skipped.begin()));

    const auto bytes = pending();
    if (bytes.size() >= 2 && !is_frame_type(bytes[1])) {
      lose(1);
      continue;
    }
    if (bytes.size() < header_size) return nullptr;
    const std::size_t frame_size = header_size + payload_size_of(bytes) + crc_size;
    if (bytes.size() < frame_size) return nullptr;

    const auto frame = bytes.first(frame_size);
    if (crc16(frame) != 0) {
      ++counters_.crc_errors;
      lose(1);  // a valid frame may begin within a false start
      continue;
    }
    begin_ += frame_size;
    if (parse(frame, packet_, counters_)) return &packet_;
  }
}

const Packet* DatagramDecoder::decode(std::span<const std::uint8_t> datagram) {
  constexpr std::array<std::uint8_t, 3> nmea{'$', 'G', 'P'};
  if (datagram.size() >= nmea.size() && std::equal(nmea.begin(), nmea.end(), datagram.begin())) {
    ++counters_.nmea_datagrams;
    return nullptr;
  }
  if (datagram.size() < header_size || !is_frame_type(datagram[1]) ||
      datagram.size() < header_size + payload_size_of(datagram)) {
    counters_.bytes_lost += datagram.size();
    return nullptr;
  }
  if (!parse(datagram, packet_, counters_)) return nullptr;
  complete_from_datagram(packet_, datagram.front());
  return &packet_;
}

}  // namespace sonopose::marvelmind
