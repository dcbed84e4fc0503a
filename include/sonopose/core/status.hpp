#pragma once
/// \file
/// What the bridge and the fusion tell of themselves, once a second and beacon.

#include <sonopose/core/samples.hpp>

#include <cstdint>
#include <optional>

namespace sonopose {

/// The state of one beacon and of the line to it, as the bridge sees it. Counters count from its start.
struct BeaconStatus {
  BeaconAddress address = 0;
  TimeNs time_ns = 0;
  std::optional<double> battery_v;
  std::optional<double> rssi_dbm;
  double imu_rate_hz = 0;  ///< over the last second
  double fix_rate_hz = 0;
  double heading_rate_hz = 0;
  double clock_offset_s = 0;            ///< host time − beacon time, as mapped
  double clock_jitter_s = 0;            ///< spread of the arrivals above the fitted clock
  std::uint64_t frames = 0;             ///< good frames decoded
  std::uint64_t crc_errors = 0;         ///< frames whose check sum was wrong
  std::uint64_t bytes_lost = 0;         ///< bytes skipped while looking for a frame
  std::uint64_t unknown_frames = 0;     ///< good frames of a kind that is not known
  std::uint64_t fixes_unavailable = 0;  ///< fixes that the hardware flagged "not available"
  std::uint64_t samples_rejected = 0;   ///< values that no sensor can give, kept back
  std::uint64_t clock_resets = 0;       ///< beacon restarts seen in its clock
  std::uint32_t other_bridges = 0;      ///< further bridges that publish the same address
};

/// What one engine has been given and has done. Counters count from the fusion's start.
struct FusionStatus {
  BeaconAddress address = 0;
  TimeNs time_ns = 0;
  std::uint64_t imu_samples = 0;
  std::uint64_t fixes_used = 0;
  std::uint64_t fixes_rejected = 0;
  std::uint64_t headings = 0;
  std::uint64_t events_lost = 0;        ///< gaps in the event sequence that never filled
  std::uint64_t events_duplicated = 0;  ///< an event sequence number came twice, or too late
  std::uint64_t samples_invalid = 0;    ///< not finite, absurd, or backward in time
  std::uint64_t imu_gaps = 0;           ///< silences too long to integrate over
  std::uint32_t reset_counter = 0;
};

}  // namespace sonopose
