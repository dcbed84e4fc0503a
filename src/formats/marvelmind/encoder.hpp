#pragma once
/// \file
/// Encodes packets into bytes, as a beacon sends them: the exact inverse of decoder.hpp.

#include "marvelmind/packet.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sonopose::marvelmind {

/// One encoded frame, stored in place.
class Frame {
public:
  std::span<const std::uint8_t> bytes() const { return std::span(bytes_).first(size_); }

private:
  friend Frame encode(const Packet& packet);
  friend Frame encode_datagram(const Packet& packet);

  std::array<std::uint8_t, max_frame_size> bytes_{};
  std::size_t size_ = 0;
};

/// Encodes a frame of a byte stream, with its CRC. Its code follows from the packet's time base and `in_cm`.
/// Centimetres saturate at ±327.67 m. A position's flag bit 1 follows from its time base.
Frame encode(const Packet& packet);

/// Encodes a UDP datagram. Byte 0 is the beacon's address, or 0xFF for stationary beacons, raw distances and
/// packets without an address. The address slot inside positions and their angle bit 13 are cleared. There is
/// no CRC.
Frame encode_datagram(const Packet& packet);

}  // namespace sonopose::marvelmind
