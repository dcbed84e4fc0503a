#pragma once
/// \file
/// CRC-16/MODBUS: polynomial 0x8005 reflected (0xA001), initial value 0xFFFF, no final xor. It covers all
/// preceding bytes and is sent low byte first, so the CRC of a whole good frame is 0.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sonopose::marvelmind {

namespace detail {

constexpr std::array<std::uint16_t, 256> make_crc16_table() {
  std::array<std::uint16_t, 256> table{};
  for (std::size_t byte = 0; byte < table.size(); ++byte) {
    auto remainder = static_cast<std::uint16_t>(byte);
    for (int bit = 0; bit < 8; ++bit) {
      const bool carry = (remainder & 1U) != 0;
      remainder = static_cast<std::uint16_t>(remainder >> 1U);
      if (carry) remainder ^= 0xA001U;
    }
    table[byte] = remainder;
  }
  return table;
}

inline constexpr std::array<std::uint16_t, 256> crc16_table = make_crc16_table();

}  // namespace detail

/// Returns the checksum of `bytes`.
constexpr std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  std::uint16_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>((crc >> 8U) ^ detail::crc16_table[(crc ^ byte) & 0xFFU]);
  }
  return crc;
}

}  // namespace sonopose::marvelmind
