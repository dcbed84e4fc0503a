#pragma once
/// \file
/// Parses one payload into one packet, by the offsets in packet.hpp.

#include "marvelmind/packet.hpp"

#include <cstdint>
#include <span>

namespace sonopose::marvelmind {

enum class ParseResult : std::uint8_t { ok, unused, unknown, malformed };

/// Returns true if a frame can have this type.
constexpr bool is_frame_type(std::uint8_t type) {
  return type == stream_type || type == user_device_type;
}

/// Parses `payload` into `packet`, which is unspecified unless the result is ok.
ParseResult parse_payload(std::uint8_t type, std::uint16_t code, std::span<const std::uint8_t> payload,
                          Packet& packet);

}  // namespace sonopose::marvelmind
