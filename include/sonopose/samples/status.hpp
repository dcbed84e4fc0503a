#pragma once
/// \file
/// What the bridge and the fusion tell of themselves, once a second and beacon.

#include <sonopose/samples/samples.hpp>

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
  double clock_offset_s = 0;               ///< host time − beacon time, as mapped
  double clock_jitter_s = 0;               ///< spread of the arrivals above the fitted clock
  std::uint64_t frames = 0;                ///< good frames decoded
  std::uint64_t crc_errors = 0;            ///< frames whose check sum was wrong
  std::uint64_t bytes_lost = 0;            ///< bytes skipped while looking for a frame
  std::uint64_t unknown_frames = 0;        ///< good frames of a kind that is not known
  std::uint64_t fixes_unavailable = 0;     ///< fixes that the hardware flagged "not available"
  std::uint64_t samples_rejected = 0;      ///< values that no sensor can give, kept back
  std::uint64_t clock_resets = 0;          ///< beacon restarts seen in its clock
  std::uint32_t other_bridges = 0;         ///< further bridges that publish the same address
  std::uint64_t imu_deadlines_missed = 0;  ///< deadline periods without a sample, since the first one
  std::uint64_t fix_deadlines_missed = 0;
  std::uint64_t heading_deadlines_missed = 0;
  // Of the whole bridge, and so the same for all of its beacons:
  std::uint64_t liveliness_lost = 0;       ///< a lease of its writers ran out
  std::uint64_t readers_incompatible = 0;  ///< readers whose QoS could not be met
  std::uint64_t samples_unwritten = 0;     ///< a slow reader left no room
};

/// Whose poses of a beacon the consumers get.
enum class FusionRole : std::uint32_t {
  sole,     ///< not in a standby pair
  warming,  ///< poses of strength 0, until the engine has settled
  serving,  ///< poses of the process's own strength
  stalled   ///< no pose for a deadline: the beacon was given up
};

/// What one engine has been given and has done. Counters count from the fusion's start.
struct FusionStatus {
  BeaconAddress address = 0;
  std::uint64_t fusion_id = 0;  ///< of the process, by chance
  TimeNs time_ns = 0;
  FusionRole role = FusionRole::sole;
  std::int32_t strength = 0;  ///< of the process's claim to its beacons
  bool imu_silent = false;    ///< no IMU sample for longer than its deadline
  std::uint64_t imu_samples = 0;
  std::uint64_t fixes_used = 0;
  std::uint64_t fixes_rejected = 0;
  std::uint64_t headings = 0;
  std::uint64_t events_lost = 0;        ///< gaps in the event sequence that never filled
  std::uint64_t events_duplicated = 0;  ///< an event sequence number came twice, or too late
  std::uint64_t samples_invalid = 0;    ///< not finite, absurd, or backward in time
  std::uint64_t imu_gaps = 0;           ///< silences too long to integrate over
  std::uint32_t reset_counter = 0;
  std::uint64_t imu_deadlines_missed = 0;  ///< deadline periods without a sample, since the first one
  std::uint64_t fix_deadlines_missed = 0;
  std::uint64_t heading_deadlines_missed = 0;
  std::uint64_t bridge_losses = 0;  ///< the bridge that served this beacon was no longer alive
  // Of the whole process, and so the same for all of its beacons:
  std::uint64_t pose_deadlines_missed = 0;
  std::uint64_t liveliness_lost = 0;   ///< a lease of its pose writers ran out
  std::uint64_t samples_lost = 0;      ///< input samples lost on the way
  std::uint64_t samples_rejected = 0;  ///< input samples refused for want of room
  std::uint64_t incompatible_qos = 0;  ///< readers and writers whose QoS does not go with its own
  std::uint64_t poses_unwritten = 0;   ///< poses and reports that a slow consumer left no room for
};

}  // namespace sonopose
