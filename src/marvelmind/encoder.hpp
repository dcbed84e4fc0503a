#pragma once
/// \file
/// Packets → bytes, as a beacon sends them. The inverse of decoder.hpp, byte for byte.

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

/// The frame of `packet` in a byte stream, with its CRC. Its code follows from the packet's time base and
/// `in_cm`. Centimetres saturate at ±327.67 m; a position's flag bit 1 follows from its time base.
Frame encode(const Packet& packet);

/// The same as a UDP datagram: the beacon's address as byte 0 (0xFF for stationary beacons, raw distances and
/// packets without an address), the address slot inside positions and their angle bit 13 cleared, no CRC.
Frame encode_datagram(const Packet& packet);

}  // namespace sonopose::marvelmind
