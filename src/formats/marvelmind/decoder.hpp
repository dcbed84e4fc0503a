#pragma once
/// \file
/// Decodes bytes into packets, for the byte stream of a serial line and for UDP datagrams.

#include "marvelmind/packet.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace sonopose::marvelmind {

/// Counters since the decoder's construction.
struct DecoderCounters {
  std::uint64_t frames = 0;            ///< valid frames of known kinds
  std::uint64_t unused_frames = 0;     ///< those of them that are of an `UnusedKind`
  std::string_view first_unused{};     ///< name of the first of these kinds
  std::uint64_t crc_errors = 0;        ///< frames, or false starts, with a wrong checksum
  std::uint64_t bytes_lost = 0;        ///< bytes skipped in search of a frame
  std::uint64_t unknown_frames = 0;    ///< frames with valid checksum and unknown kind
  std::uint64_t malformed_frames = 0;  ///< frames with valid checksum, too short for their kind
  std::uint64_t nmea_datagrams = 0;    ///< ignored `$GP…` datagrams (UDP only)

  bool operator==(const DecoderCounters&) const = default;
};

/// Finds the frames in a byte stream that arrives in pieces of any size. Does not allocate. After garbage it
/// continues at the next byte that can start a frame, even within the bytes consumed by a false start. No
/// valid frame is therefore lost to bad bytes before it. Accepts payloads that are longer than their kind
/// needs.
class Decoder {
public:
  /// Calls `on_packet(const Packet&)` for every packet that `bytes` completes, in order. The packet is valid
  /// until the callback returns.
  template <typename OnPacket>
  void feed(std::span<const std::uint8_t> bytes, OnPacket&& on_packet) {
    while (!bytes.empty()) {
      bytes = bytes.subspan(fill(bytes));
      while (const Packet* packet = next_packet()) on_packet(*packet);
    }
  }

  /// Ends the stream: decodes the bytes after the false start of an incomplete frame. The remaining bytes
  /// count as lost.
  template <typename OnPacket>
  void finish(OnPacket&& on_packet) {
    while (lose_first_byte()) {
      while (const Packet* packet = next_packet()) on_packet(*packet);
    }
  }

  const DecoderCounters& counters() const { return counters_; }

private:
  std::size_t fill(std::span<const std::uint8_t> bytes);
  const Packet* next_packet();
  bool lose_first_byte();
  std::span<const std::uint8_t> pending() const { return std::span(buffer_).subspan(begin_, end_ - begin_); }
  void lose(std::size_t count);

  static constexpr std::size_t buffer_size = 4096;
  static_assert(buffer_size > 2 * max_frame_size);

  std::array<std::uint8_t, buffer_size> buffer_{};
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  Packet packet_;
  DecoderCounters counters_;
};

/// Decodes UDP datagrams, one frame each. Byte 0 is the beacon's address instead of the frame start, and
/// fills the packet's empty address slot. It is 0xFF if the packet contains its beacon's address. The CRC is
/// optional, so bytes after the payload are ignored. Bit 13 of a position's angle word is reserved and
/// cleared.
class DatagramDecoder {
public:
  template <typename OnPacket>
  void feed(std::span<const std::uint8_t> datagram, OnPacket&& on_packet) {
    if (const Packet* packet = decode(datagram)) on_packet(*packet);
  }

  /// Returns the packet of one datagram, valid until the next call; null if there is none (see the counters).
  const Packet* decode(std::span<const std::uint8_t> datagram);

  const DecoderCounters& counters() const { return counters_; }

private:
  Packet packet_;
  DecoderCounters counters_;
};

}  // namespace sonopose::marvelmind
