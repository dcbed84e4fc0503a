#pragma once
/// \file
/// Recognises what arrives instead of a beacon's frames.

#include <cstdint>
#include <span>
#include <string>

namespace sonopose::marvelmind {

/// Names the text, protocol or kind of file of bytes that have no valid frame, such as "NMEA sentences
/// ($GPRMC, $GPGGA)"; empty if it is none of those known. The name has printable ASCII characters only. Some
/// hundred bytes suffice.
std::string foreign_protocol(std::span<const std::uint8_t> bytes);

}  // namespace sonopose::marvelmind
