#pragma once
/// \file
/// An assembler that collects its events, and packets of beacon 7 to feed it.

#include "marvelmind/assembler.hpp"
#include "support/events.hpp"

#include <cstdint>
#include <vector>

namespace sonopose::marvelmind::testing {

inline constexpr TimeNs ms = 1'000'000;
inline constexpr TimeNs start_ns = 1'700'000'000'000'000'000;

/// An assembler with exact times, taken from the beacon's own clock: its uptime of 1000 ms is `start_ns`.
struct Fixture {
  explicit Fixture(TimeMapping mapping = TimeMapping::fixed) : assembler(mapping) {}

  Assembler assembler;
  std::vector<Event> events;

  void on(const Packet& packet, std::int64_t arrival_ms) {
    assembler.on(packet, start_ns + arrival_ms * ms, [this](const Event& event) { events.push_back(event); });
  }
  void flush(std::int64_t now_ms) {
    assembler.flush(start_ns + now_ms * ms, [this](const Event& event) { events.push_back(event); });
  }
  void finish() {
    assembler.finish([this](const Event& event) { events.push_back(event); });
  }
  const AssemblerCounters& counters() const { return assembler.beacon(7)->counters(); }

  template <typename Sample>
  std::vector<Sample> all() const {
    return test::samples_of<Sample>(events);
  }
};

inline RawImu imu_at(std::int64_t uptime_ms) {
  RawImu imu;
  imu.address = 7;
  imu.time = {TimeBase::uptime_ms, 1000 + uptime_ms};
  imu.accel = {0, 0, 1000};
  imu.flags = imu_compass_not_available;
  return imu;
}

inline Position position_at(std::int64_t uptime_ms, std::uint16_t time_passed_ms = 68) {
  Position position;
  position.address = 7;
  position.time = {TimeBase::uptime_ms, 1000 + uptime_ms};
  position.flags = position_time_in_ms;
  position.xyz_mm = {1000, -2000, 300};
  position.angle.word = 900;
  position.time_passed_ms = time_passed_ms;
  return position;
}

inline Position in_real_time(Position position) {
  constexpr std::int64_t wake_up_unix_ms = 1'600'000'000'000;
  position.time = {TimeBase::unix_ms, wake_up_unix_ms + position.time.ticks};
  return position;
}

inline RawImu in_real_time(RawImu imu) {
  imu.time = {TimeBase::unix_ms, 1'600'000'000'000 + imu.time.ticks};
  return imu;
}

inline Position in_centimetres(Position position) {
  position.in_cm = true;
  return position;
}

}  // namespace sonopose::marvelmind::testing
