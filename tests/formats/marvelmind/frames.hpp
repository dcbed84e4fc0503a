#pragma once
/// \file
/// Frames made without the code under test: bytes from the format's table, a bitwise checksum.

#include "marvelmind/decoder.hpp"

#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

namespace sonopose::marvelmind::testing {

using Bytes = std::vector<std::uint8_t>;

/// CRC-16/MODBUS by definition, one bit at a time.
inline std::uint16_t bitwise_crc16(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0xFFFF;
  for (const unsigned byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? (crc >> 1U) ^ 0xA001U : crc >> 1U;
  }
  return static_cast<std::uint16_t>(crc);
}

/// Appends the checksum to `bytes`, low byte first.
inline Bytes with_crc(Bytes bytes) {
  const unsigned crc = bitwise_crc16(bytes);
  bytes.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(crc >> 8U));
  return bytes;
}

inline Bytes operator+(Bytes left, const Bytes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

/// Decodes in chunks of `chunk` bytes up to the end of the stream.
inline std::vector<Packet> decode_all(Decoder& decoder, std::span<const std::uint8_t> bytes,
                                      std::size_t chunk = SIZE_MAX) {
  std::vector<Packet> packets;
  const auto collect = [&packets](const Packet& packet) { packets.push_back(packet); };
  while (!bytes.empty()) {
    const std::size_t taken = std::min(chunk, bytes.size());
    decoder.feed(bytes.first(taken), collect);
    bytes = bytes.subspan(taken);
  }
  decoder.finish(collect);
  return packets;
}

inline std::vector<Packet> decode_all(std::span<const std::uint8_t> bytes) {
  Decoder decoder;
  return decode_all(decoder, bytes);
}

// Golden frames, written byte by byte from the table.

/// 0x0001: uptime 65536 in 1/64 s, (1.23, -4.56, 0.07) m, address 5, yaw 90.0°, 70 ms passed.
inline Bytes position_cm_frame() {
  return with_crc({0xFF, 0x47, 0x01, 0x00, 16,            //
                   0x00, 0x00, 0x01, 0x00,                // 0x00010000
                   0x7B, 0x00, 0x38, 0xFE, 0x07, 0x00,    // 123, -456, 7 cm
                   0x00, 0x05, 0x84, 0x03, 0x46, 0x00});  // flags, 5, 900, 70
}

/// 0x0011: uptime 0xFFFFFFFE ms, (1.000, -2.000, 0.300) m, button 1, address 7, 359.9°, pair's centre, 68 ms.
inline Bytes position_mm_frame() {
  return with_crc({0xFF, 0x47, 0x11, 0x00, 22,                                              //
                   0xFE, 0xFF, 0xFF, 0xFF,                                                  //
                   0xE8, 0x03, 0x00, 0x00, 0x30, 0xF8, 0xFF, 0xFF, 0x2C, 0x01, 0x00, 0x00,  //
                   0x06, 0x07, 0x0F, 0x1E, 0x44, 0x00});                                    // 3599 | bit 12
}

/// 0x0081: unix 1700000000123 ms, (-0.001, 70.000, 0) m, other hedge, address 9, angle not applicable, 255
/// ms; with the speed block (100, -200, 1) mm/s.
inline Bytes position_real_time_frame() {
  return with_crc({0xFF, 0x47, 0x81, 0x00, 33,                                              //
                   0x7B, 0x68, 0xE5, 0xCF, 0x8B, 0x01, 0x00, 0x00,                          // 0x018BCFE5687B
                   0xFF, 0xFF, 0xFF, 0xFF, 0x70, 0x11, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00,  //
                   0x42, 0x09, 0x00, 0x20, 0xFF, 0x00,                                      //
                   0x01, 0x64, 0x00, 0x38, 0xFF, 0x01, 0x00});
}

/// 0x0002: beacons 2 at (1.00, 2.00, 3.00) m and 3 at (-1.00, 0, 0) m.
inline Bytes stationary_cm_frame() {
  return with_crc({0xFF, 0x47, 0x02, 0x00, 17,   2,                 //
                   0x02, 0x64, 0x00, 0xC8, 0x00, 0x2C, 0x01, 0x00,  //
                   0x03, 0x9C, 0xFF, 0x00, 0x00, 0x00, 0x00, 0x00});
}

/// 0x0012: beacon 2 at (1.000, 2.000, -0.001) m, beacon 4 without a location.
inline Bytes stationary_mm_frame() {
  return with_crc({0xFF, 0x47, 0x12, 0x00, 29,   2,                                                     //
                   0x02, 0xE8, 0x03, 0x00, 0x00, 0xD0, 0x07, 0x00, 0x00, 0xFF, 0xFF, 0xFF, 0xFF, 0x00,  //
                   0x04, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01});
}

/// 0x0003: accel (1, -2, 1000) mg, gyro (1, -1, 100) LSB, compass (1100, -1100, 980) LSB, address 7,
/// uptime 305419896 ms; the compass is not available.
inline Bytes raw_imu_frame() {
  return with_crc({0xFF, 0x47, 0x03, 0x00, 32,          //
                   0x01, 0x00, 0xFE, 0xFF, 0xE8, 0x03,  //
                   0x01, 0x00, 0xFF, 0xFF, 0x64, 0x00,  //
                   0x4C, 0x04, 0xB4, 0xFB, 0xD4, 0x03,  //
                   0x07, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA,  // reserved bytes are ignored
                   0x78, 0x56, 0x34, 0x12, 0x04, 0xAA, 0xAA, 0xAA});
}

/// 0x0083: as above with unix 1700000000123 ms and everything available.
inline Bytes raw_imu_real_time_frame() {
  return with_crc({0xFF, 0x47, 0x83, 0x00, 36,          //
                   0x01, 0x00, 0xFE, 0xFF, 0xE8, 0x03,  //
                   0x01, 0x00, 0xFF, 0xFF, 0x64, 0x00,  //
                   0x4C, 0x04, 0xB4, 0xFB, 0xD4, 0x03,  //
                   0x07, 0x00, 0x00, 0x00, 0x00, 0x00,  //
                   0x7B, 0x68, 0xE5, 0xCF, 0x8B, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00});
}

/// 0x0006: 3870 mV, -71 dBm, address 7.
inline Bytes telemetry_frame() {
  return with_crc({0xFF, 0x47, 0x06, 0x00, 16, 0x1E, 0x0F, 0xB9, 0x07, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
}

/// 0x0007: address 7, 90 %, zone 2.
inline Bytes quality_frame() {
  return with_crc({0xFF, 0x47, 0x07, 0x00, 16, 0x07, 0x5A, 0x02, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
}

inline std::vector<Bytes> all_golden_frames() {
  return {position_cm_frame(),       position_mm_frame(),   position_real_time_frame(),
          stationary_cm_frame(),     stationary_mm_frame(), raw_imu_frame(),
          raw_imu_real_time_frame(), telemetry_frame(),     quality_frame()};
}

/// Returns a frame of each kind that is known and not used, with the least payload of its datasheet.
inline std::vector<Bytes> unused_frames() {
  const auto frame = [](Bytes header, std::size_t payload) {
    header.push_back(static_cast<std::uint8_t>(payload));
    return with_crc(header + Bytes(payload, 0));
  };
  return {frame({0xFF, 0x47, 0x04, 0x00}, 32),   // raw distances,
          frame({0xFF, 0x47, 0x84, 0x00}, 36),   // with unix time
          frame({0xFF, 0x47, 0x05, 0x00}, 42),   // the beacon's own fusion,
          frame({0xFF, 0x47, 0x85, 0x00}, 46),   // with unix time
          frame({0xFF, 0x4A, 0x01, 0x02}, 12),   // a waypoint
          frame({0xFF, 0x4A, 0x80, 0x02}, 11)};  // user data of 3 bytes
}

}  // namespace sonopose::marvelmind::testing
