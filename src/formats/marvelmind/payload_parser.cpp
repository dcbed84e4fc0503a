#include "marvelmind/payload_parser.hpp"

#include "marvelmind/bytes.hpp"

namespace sonopose::marvelmind {

namespace {

using Payload = std::span<const std::uint8_t>;

constexpr std::int32_t mm_per_cm = 10;
constexpr std::size_t speed_size = 7;

Vector3i32 read_cm_as_mm(ByteReader& in) {
  const auto xyz_cm = in.read_array<std::int16_t, 3>();
  return {xyz_cm[0] * mm_per_cm, xyz_cm[1] * mm_per_cm, xyz_cm[2] * mm_per_cm};
}

Stamp read_unix_ms(ByteReader& in) {
  return {TimeBase::unix_ms, in.read<std::int64_t>()};
}

Stamp read_uptime_ms(ByteReader& in) {
  return {TimeBase::uptime_ms, in.read<std::uint32_t>()};
}

Stamp read_stamp(ByteReader& in, bool real_time) {
  return real_time ? read_unix_ms(in) : read_uptime_ms(in);
}

ParseResult parse_position(std::uint16_t code, Payload payload, Packet& packet) {
  const bool real_time = code == Position::code_real_time;
  const bool in_cm = code == Position::code_cm;
  const std::size_t size = real_time ? 26 : in_cm ? 16 : 22;
  if (payload.size() < size) return ParseResult::malformed;

  ByteReader in(payload);
  auto& out = packet.emplace<Position>();
  out.in_cm = in_cm;
  out.time = read_stamp(in, real_time);
  out.xyz_mm = in_cm ? read_cm_as_mm(in) : in.read_array<std::int32_t, 3>();
  out.flags = in.read<std::uint8_t>();
  out.address = in.read<std::uint8_t>();
  out.angle.word = in.read<std::uint16_t>();
  out.time_passed_ms = in.read<std::uint16_t>();
  if (!real_time && (out.flags & position_time_in_ms) == 0) out.time.base = TimeBase::uptime_64ths;
  if (in.remaining() >= speed_size && in.read<std::uint8_t>() == 1) {
    out.speed_mmps = in.read_array<std::int16_t, 3>();
  }
  return ParseResult::ok;
}

ParseResult parse_stationary_beacons(std::uint16_t code, Payload payload, Packet& packet) {
  if (payload.empty()) return ParseResult::malformed;
  const bool in_cm = code == StationaryBeacons::code_cm;
  const std::size_t item_size = in_cm ? StationaryBeacons::item_size_cm : StationaryBeacons::item_size_mm;
  ByteReader in(payload);
  const auto count = in.read<std::uint8_t>();
  if (in.remaining() < count * item_size) return ParseResult::malformed;

  auto& out = packet.emplace<StationaryBeacons>();
  out.in_cm = in_cm;
  out.count = count;
  for (StationaryBeacon& beacon : std::span(out.items).first(count)) {
    beacon.address = in.read<std::uint8_t>();
    beacon.xyz_mm = in_cm ? read_cm_as_mm(in) : in.read_array<std::int32_t, 3>();
    const bool not_available = (in.read<std::uint8_t>() & 1U) != 0;
    beacon.location_available = in_cm || !not_available;
  }
  return ParseResult::ok;
}

ParseResult parse_raw_imu(std::uint16_t code, Payload payload, Packet& packet) {
  const bool real_time = code == RawImu::code_real_time;
  if (payload.size() < (real_time ? 36U : 32U)) return ParseResult::malformed;
  ByteReader in(payload);
  auto& out = packet.emplace<RawImu>();
  out.accel = in.read_array<std::int16_t, 3>();
  out.gyro = in.read_array<std::int16_t, 3>();
  out.compass = in.read_array<std::int16_t, 3>();
  out.address = in.read<std::uint8_t>();
  in.skip(5);
  out.time = read_stamp(in, real_time);
  out.flags = in.read<std::uint8_t>();
  return ParseResult::ok;
}

ParseResult parse_telemetry(Payload payload, Packet& packet) {
  if (payload.size() < 16) return ParseResult::malformed;
  ByteReader in(payload);
  auto& out = packet.emplace<Telemetry>();
  out.battery_mv = in.read<std::uint16_t>();
  out.rssi_dbm = in.read<std::int8_t>();
  out.address = in.read<std::uint8_t>();
  return ParseResult::ok;
}

ParseResult parse_quality(Payload payload, Packet& packet) {
  if (payload.size() < 16) return ParseResult::malformed;
  packet.emplace<Quality>(Quality{payload[0], payload[1], payload[2]});
  return ParseResult::ok;
}

ParseResult check_unused(std::uint8_t type, std::uint16_t code, Payload payload) {
  const UnusedKind* const kind = find_unused_kind(type, code);
  if (kind == nullptr) return ParseResult::unknown;
  return payload.size() < kind->min_size ? ParseResult::malformed : ParseResult::unused;
}

}  // namespace

ParseResult parse_payload(std::uint8_t type, std::uint16_t code, Payload payload, Packet& packet) {
  if (type == user_device_type) return check_unused(type, code, payload);
  switch (code) {
    case RawImu::code:
    case RawImu::code_real_time:
      return parse_raw_imu(code, payload, packet);
    case Position::code_cm:
    case Position::code_mm:
    case Position::code_real_time:
      return parse_position(code, payload, packet);
    case Quality::code:
      return parse_quality(payload, packet);
    case Telemetry::code:
      return parse_telemetry(payload, packet);
    case StationaryBeacons::code_cm:
    case StationaryBeacons::code_mm:
      return parse_stationary_beacons(code, payload, packet);
    default:
      return check_unused(type, code, payload);
  }
}

}  // namespace sonopose::marvelmind
