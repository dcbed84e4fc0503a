#include "marvelmind/encoder.hpp"

#include "marvelmind/bytes.hpp"
#include "marvelmind/crc16.hpp"

#include <algorithm>
#include <limits>

namespace sonopose::marvelmind {

namespace {

/// A frame under construction: the header's code, and the payload.
struct Draft {
  std::uint16_t code = 0;
  ByteWriter payload;
};

std::int16_t mm_to_cm(std::int32_t mm) {
  using Limits = std::numeric_limits<std::int16_t>;
  const std::int32_t cm = (mm + (mm < 0 ? -5 : 5)) / 10;
  return static_cast<std::int16_t>(std::clamp<std::int32_t>(cm, Limits::min(), Limits::max()));
}

void write_as_cm(ByteWriter& out, const Vector3i32& xyz_mm) {
  for (const std::int32_t mm : xyz_mm) out.write(mm_to_cm(mm));
}

bool is_real_time(const Stamp& time) {
  return time.base == TimeBase::unix_ms;
}

void write_stamp(ByteWriter& out, const Stamp& time) {
  if (is_real_time(time)) {
    out.write(time.ticks);
  } else {
    out.write(static_cast<std::uint32_t>(time.ticks));  // wraps like the beacon's counter
  }
}

std::uint8_t flags_of(const Position& position) {
  const auto rest = static_cast<std::uint8_t>(position.flags & ~position_time_in_ms);
  switch (position.time.base) {
    case TimeBase::uptime_ms:
      return rest | position_time_in_ms;
    case TimeBase::uptime_64ths:
      return rest;
    case TimeBase::unix_ms:
      break;
  }
  return position.flags;
}

void write(const Position& position, Draft& draft) {
  const bool real_time = is_real_time(position.time);
  const bool in_cm = position.in_cm && !real_time;
  draft.code = real_time ? Position::code_real_time : in_cm ? Position::code_cm : Position::code_mm;
  ByteWriter& out = draft.payload;
  write_stamp(out, position.time);
  if (in_cm) {
    write_as_cm(out, position.xyz_mm);
  } else {
    out.write_array(position.xyz_mm);
  }
  out.write(flags_of(position));
  out.write(position.address);
  out.write(position.angle.word);
  out.write(position.time_passed_ms);
  if (position.speed_mmps) {
    out.write<std::uint8_t>(1);
    out.write_array(*position.speed_mmps);
  }
}

void write(const StationaryBeacons& beacons, Draft& draft) {
  draft.code = beacons.in_cm ? StationaryBeacons::code_cm : StationaryBeacons::code_mm;
  const std::size_t fits = beacons.in_cm ? StationaryBeacons::max_items_cm : StationaryBeacons::max_items_mm;
  const std::size_t count = std::min<std::size_t>(beacons.count, fits);
  ByteWriter& out = draft.payload;
  out.write(static_cast<std::uint8_t>(count));
  for (const StationaryBeacon& beacon : std::span(beacons.items).first(count)) {
    out.write(beacon.address);
    if (beacons.in_cm) {
      write_as_cm(out, beacon.xyz_mm);
      out.zeros(1);
    } else {
      out.write_array(beacon.xyz_mm);
      out.write<std::uint8_t>(beacon.location_available ? 0 : 1);
    }
  }
}

void write(const RawImu& imu, Draft& draft) {
  draft.code = is_real_time(imu.time) ? RawImu::code_real_time : RawImu::code;
  ByteWriter& out = draft.payload;
  out.write_array(imu.accel);
  out.write_array(imu.gyro);
  out.write_array(imu.compass);
  out.write(imu.address);
  out.zeros(5);
  write_stamp(out, imu.time);
  out.write(imu.flags);
  out.zeros(3);
}

void write(const Telemetry& telemetry, Draft& draft) {
  draft.code = Telemetry::code;
  draft.payload.write(telemetry.battery_mv);
  draft.payload.write(telemetry.rssi_dbm);
  draft.payload.write(telemetry.address);
  draft.payload.zeros(12);
}

void write(const Quality& quality, Draft& draft) {
  draft.code = Quality::code;
  draft.payload.write(quality.address);
  draft.payload.write(quality.quality_percent);
  draft.payload.write(quality.geofence_zone);
  draft.payload.zeros(13);
}

/// Writes header and payload into `bytes`, and returns their length.
std::size_t write_frame(const Packet& packet, std::uint8_t first_byte, std::span<std::uint8_t> bytes) {
  Draft draft{.payload = ByteWriter(bytes.subspan(header_size))};
  std::visit([&draft](const auto& body) { write(body, draft); }, packet);
  ByteWriter header(bytes);
  header.write(first_byte);
  header.write(stream_type);
  header.write(draft.code);
  header.write(static_cast<std::uint8_t>(draft.payload.position()));
  return header_size + draft.payload.position();
}

std::uint8_t sender_of(const Packet& packet) {
  return std::visit(
      [](const auto& body) {
        if constexpr (requires { body.address; }) {
          return body.address;
        } else {
          return frame_start;
        }
      },
      packet);
}

}  // namespace

Frame encode(const Packet& packet) {
  Frame frame;
  frame.size_ = write_frame(packet, frame_start, frame.bytes_);
  const std::uint16_t crc = crc16(frame.bytes());
  ByteWriter(std::span(frame.bytes_).subspan(frame.size_)).write(crc);
  frame.size_ += crc_size;
  return frame;
}

Frame encode_datagram(const Packet& packet) {
  Frame frame;
  if (const auto* position = std::get_if<Position>(&packet)) {
    Position anonymous = *position;
    anonymous.address = 0;
    anonymous.angle.word = static_cast<std::uint16_t>(anonymous.angle.word & ~PairAngle::not_applicable);
    frame.size_ = write_frame(anonymous, position->address, frame.bytes_);
  } else {
    frame.size_ = write_frame(packet, sender_of(packet), frame.bytes_);
  }
  return frame;
}

}  // namespace sonopose::marvelmind
