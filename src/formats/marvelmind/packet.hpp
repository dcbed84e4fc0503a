#pragma once
/// \file
/// The packets of a Marvelmind mobile beacon ("hedge"): the datasheet of the wire format, one struct per
/// kind that is used.
///
///     FF | type u8 | code u16 | N u8 | payload[N] | CRC u16          all numbers little-endian
///
/// Offsets (in brackets) count from the start of the payload. Both firmware generations share a struct: up to
/// 7.1 packets carry the beacon's uptime (codes 0x00xx), later ones unix time (codes 0x008x). Values are in
/// wire units; `assembler.hpp` converts them to SI samples.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>

namespace sonopose::marvelmind {

inline constexpr std::uint8_t frame_start = 0xFF;
inline constexpr std::uint8_t stream_type = 0x47;       ///< type of packets streamed by the beacon
inline constexpr std::uint8_t user_device_type = 0x4A;  ///< type of packets for the user's device

/// Nanoseconds per unit of a stamp.
inline constexpr std::int64_t ns_per_ms = 1'000'000;
inline constexpr std::int64_t ns_per_64th = 15'625'000;  ///< 1/64 s

inline constexpr std::size_t header_size = 5;
inline constexpr std::size_t crc_size = 2;
inline constexpr std::size_t max_payload_size = 255;
inline constexpr std::size_t max_frame_size = header_size + max_payload_size + crc_size;

/// The beacon's clock that a stamp refers to.
enum class TimeBase : std::uint8_t {
  uptime_ms,     ///< u32 ms since the beacon woke up; wraps after 49.7 days
  uptime_64ths,  ///< u32 in 1/64 s: positions of firmware before 5.20 (position flag bit 1 clear)
  unix_ms        ///< i64 ms, synchronised by the modem; may be local time written as unix time
};

/// A moment in one of the beacon's clocks.
struct Stamp {
  TimeBase base = TimeBase::uptime_ms;
  std::int64_t ticks = 0;

  bool operator==(const Stamp&) const = default;
};

using Vector3i16 = std::array<std::int16_t, 3>;
using Vector3i32 = std::array<std::int32_t, 3>;

/// Bits of `Position::flags`. Bits 3 and 4 carry user data.
enum PositionFlag : std::uint8_t {
  position_not_available = 1U << 0U,
  position_time_in_ms = 1U << 1U,  ///< otherwise 1/64 s; has no meaning with unix time
  position_user_button_1 = 1U << 2U,
  position_user_button_2 = 1U << 5U,
  position_other_hedge = 1U << 6U,     ///< data of another hedge
  position_out_of_geofence = 1U << 7U  ///< 0x0011 and 0x0081 only
};

/// The angle word of a position: the direction of two paired beacons.
struct PairAngle {
  static constexpr std::uint16_t yaw_mask = 0x0FFF;  ///< decidegrees 0…3600, counter-clockwise from +X
  static constexpr std::uint16_t pair_centre = 1U << 12U;     ///< coordinates are the pair's centre
  static constexpr std::uint16_t not_applicable = 1U << 13U;  ///< reserved over UDP: cleared there
  static constexpr std::uint16_t max_yaw_decideg = 3600;

  std::uint16_t word = 0;

  constexpr std::uint16_t yaw_decideg() const { return word & yaw_mask; }
  constexpr bool is_pair_centre() const { return (word & pair_centre) != 0; }
  constexpr bool is_applicable() const { return (word & not_applicable) == 0; }
  bool operator==(const PairAngle&) const = default;
};

/// 0x0001 (N = 16, cm), 0x0011 (N = 22, mm) and 0x0081 (N = 26, mm, unix time), each optionally
/// followed by 7 bytes of speed. The time is the moment of the ultrasound's *emission*.
struct Position {
  static constexpr std::uint16_t code_cm = 0x0001;
  static constexpr std::uint16_t code_mm = 0x0011;
  static constexpr std::uint16_t code_real_time = 0x0081;

  //                                                              0x0001        0x0011   0x0081
  Stamp time;                            ///< emission              [0] u32       [0] u32  [0] i64
  bool in_cm = false;                    ///< sent as 0x0001: whole centimetres
  Vector3i32 xyz_mm{};                   ///< map frame             [4] i16 cm    [4] i32  [8] i32
  std::uint8_t flags = 0;                ///< bits of PositionFlag  [10]          [16]     [20]
  std::uint8_t address = 0;              ///< 0 over UDP            [11]          [17]     [21]
  PairAngle angle;                       ///< angle of the pair     [12] u16      [18]     [22]
  std::uint16_t time_passed_ms = 0;      ///< emission → sent       [14] u16      [20]     [24]
  std::optional<Vector3i16> speed_mmps;  ///< u8 = 1, 3 × i16     [16]          [22]     [26]

  bool is_available() const { return (flags & position_not_available) == 0; }
  bool operator==(const Position&) const = default;
};

/// The position of one stationary beacon of the map.
struct StationaryBeacon {
  std::uint8_t address = 0;
  Vector3i32 xyz_mm{};
  bool location_available = true;  ///< 0x0012 only

  bool operator==(const StationaryBeacon&) const = default;
};

/// 0x0002 (N = 1 + 8n: address, 3 × i16 cm, u8 0) and 0x0012 (N = 1 + 14n: address, 3 × i32 mm, u8 with bit 0
/// = location not available). Every 10 s while the map is frozen.
struct StationaryBeacons {
  static constexpr std::uint16_t code_cm = 0x0002;
  static constexpr std::uint16_t code_mm = 0x0012;
  static constexpr std::size_t item_size_cm = 8;
  static constexpr std::size_t item_size_mm = 14;
  static constexpr std::size_t max_items_cm = (max_payload_size - 1) / item_size_cm;
  static constexpr std::size_t max_items_mm = (max_payload_size - 1) / item_size_mm;

  bool in_cm = false;
  std::uint8_t count = 0;  ///< [0] u8
  std::array<StationaryBeacon, max_items_cm> items{};

  std::span<const StationaryBeacon> beacons() const {
    return std::span(items).first(std::min<std::size_t>(count, items.size()));
  }
  bool operator==(const StationaryBeacons&) const = default;
};

/// Bits of `RawImu::flags`.
enum ImuFlag : std::uint8_t {
  imu_accel_not_available = 1U << 0U,
  imu_gyro_not_available = 1U << 1U,
  imu_compass_not_available = 1U << 2U
};

/// 0x0003 (N = 32) and 0x0083 (N = 36, unix time).
struct RawImu {
  static constexpr std::uint16_t code = 0x0003;
  static constexpr std::uint16_t code_real_time = 0x0083;

  //                                                               0x0003    0x0083
  Vector3i16 accel{};        ///< 1 mg/LSB                         [0] i16   [0]
  Vector3i16 gyro{};         ///< 0.0175 deg/s per LSB             [6] i16   [6]
  Vector3i16 compass{};      ///< x, y 1100, z 980 LSB/gauss       [12] i16  [12]
  std::uint8_t address = 0;  ///< 19–23 reserved                   [18]      [18]
  Stamp time;                ///< measured                         [24] u32  [24] i64
  std::uint8_t flags = 0;    ///< bits of ImuFlag, 3 reserved      [28]      [32]

  bool operator==(const RawImu&) const = default;
};

/// 0x0006 (N = 16).
struct Telemetry {
  static constexpr std::uint16_t code = 0x0006;

  std::uint16_t battery_mv = 0;  ///< [0] u16
  std::int8_t rssi_dbm = 0;      ///< [2] i8
  std::uint8_t address = 0;      ///< [3], 12 reserved

  bool operator==(const Telemetry&) const = default;
};

/// 0x0007 (N = 16). Has no time: it belongs to the latest position of its address.
struct Quality {
  static constexpr std::uint16_t code = 0x0007;

  std::uint8_t address = 0;          ///< [0]
  std::uint8_t quality_percent = 0;  ///< [1] 0…100
  std::uint8_t geofence_zone = 0;    ///< [2] 0 = none, 13 reserved

  bool operator==(const Quality&) const = default;
};

using Packet = std::variant<Position, RawImu, Quality, Telemetry, StationaryBeacons>;

/// A kind of packet that is known and not used, so that its frames are no sign of a wrong line.
struct UnusedKind {
  std::uint8_t type;
  std::uint16_t code;
  std::size_t min_size;  ///< least size of the payload
  const char* name;
};

inline constexpr std::array<UnusedKind, 6> unused_kinds{{
    {stream_type, 0x0004, 32, "raw distances"},
    {stream_type, 0x0084, 36, "raw distances"},
    {stream_type, 0x0005, 42, "the beacon's own fusion"},
    {stream_type, 0x0085, 46, "the beacon's own fusion"},
    {user_device_type, 0x0201, 12, "waypoints"},
    {user_device_type, 0x0280, 8, "user data"},
}};

/// Returns the unused kind of a frame; null if it is another kind.
constexpr const UnusedKind* find_unused_kind(std::uint8_t type, std::uint16_t code) {
  for (const UnusedKind& kind : unused_kinds) {
    if (kind.type == type && kind.code == code) return &kind;
  }
  return nullptr;
}

/// Returns the beacon of a packet; empty for packets of no single beacon.
inline std::optional<std::uint8_t> address_of(const Packet& packet) {
  return std::visit(
      [](const auto& body) -> std::optional<std::uint8_t> {
        if constexpr (requires { body.address; }) return body.address;
        return std::nullopt;
      },
      packet);
}

}  // namespace sonopose::marvelmind
