#pragma once
/// \file
/// Statuses that bridge and fusion publish once a second.

#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace sonopose {

inline namespace native {

/// State of one beacon and its line, as seen by the bridge. Counters start with the bridge.
struct BeaconStatus {
  BeaconAddress address = 0;
  TimeNs time_ns = 0;
  std::optional<double> battery_v;
  std::optional<double> rssi_dbm;
  double imu_rate_hz = 0;  ///< rate over the last second
  double fix_rate_hz = 0;
  double heading_rate_hz = 0;
  double clock_offset_s = 0;               ///< host time − beacon time, as mapped
  double clock_jitter_s = 0;               ///< spread of the arrivals above the fitted clock
  std::uint64_t frames = 0;                ///< good frames decoded
  std::uint64_t crc_errors = 0;            ///< frames with a wrong checksum
  std::uint64_t bytes_lost = 0;            ///< bytes skipped in search of a frame
  std::uint64_t unknown_frames = 0;        ///< good frames of an unknown kind
  std::uint64_t fixes_unavailable = 0;     ///< fixes that the hardware flagged "not available"
  std::uint64_t samples_rejected = 0;      ///< samples with implausible values, not published
  std::uint64_t clock_resets = 0;          ///< restarts of the beacon's clock, and steps of the host's
  std::uint32_t other_bridges = 0;         ///< other bridges that publish the same address
  std::uint64_t imu_deadlines_missed = 0;  ///< deadline periods without a sample, since the first one
  std::uint64_t fix_deadlines_missed = 0;
  std::uint64_t heading_deadlines_missed = 0;
  // Common to all beacons of the bridge:
  std::uint64_t liveliness_lost = 0;       ///< expired leases of its writers
  std::uint64_t readers_incompatible = 0;  ///< readers with incompatible QoS
  std::uint64_t samples_unwritten = 0;     ///< samples not written because a slow reader blocked
  std::uint64_t samples_unrecorded = 0;    ///< samples missing in the recording: the disk is too slow or full

  bool operator==(const BeaconStatus&) const = default;
};

}  // namespace native

enum class LineState : std::uint32_t {
  closed,   ///< not opened yet, or closed
  waiting,  ///< waiting for the device or the peer to appear
  open,
  failed,    ///< cannot be opened or read: see `text`
  silent,    ///< open, but no bytes for 3 s
  no_frames  ///< open, but no valid frame for 3 s in the bytes received
};

inline namespace native {

/// One line of one bridge, which is its connection to beacons: a serial device or UDP socket, known before
/// any beacon address. Counters start with the bridge.
struct LineStatus {
  std::string name;             ///< such as "/dev/ttyACM0"; DDS cuts it at 128 bytes
  std::uint64_t bridge_id = 0;  ///< random id of the process: two bridges may use the same name
  TimeNs time_ns = 0;
  LineState state = LineState::closed;
  std::uint64_t bytes = 0;       ///< bytes received
  std::uint64_t frames = 0;      ///< frames decoded
  std::uint64_t crc_errors = 0;  ///< frames with a wrong checksum
  std::uint64_t bytes_lost = 0;  ///< bytes skipped in search of a frame
  /// Packets of a sender that is not accepted or not the beacon's, or of too many beacons.
  std::uint64_t packets_refused = 0;
  /// Reason why no frames arrive and what to check; empty if they arrive. DDS cuts it at 256 bytes.
  std::string text;

  bool operator==(const LineStatus&) const = default;
};

}  // namespace native

/// Role of a process, which decides which poses of a beacon consumers receive.
enum class FusionRole : std::uint32_t {
  sole,     ///< not in a standby pair
  warming,  ///< poses of strength 0, until the engine has settled
  serving,  ///< poses of the process's own strength
  stalled   ///< no pose for a deadline: the beacon was released
};

/// Greatest ownership strength of a fusion.
inline constexpr std::int32_t max_fusion_strength = 1'000'000;

inline namespace native {

/// Counters and role of one engine. Counters start with the fusion.
struct FusionStatus {
  BeaconAddress address = 0;
  std::uint64_t fusion_id = 0;  ///< random id of the process
  TimeNs time_ns = 0;
  FusionRole role = FusionRole::sole;
  std::int32_t strength = 0;  ///< ownership strength of the process
  bool imu_silent = false;    ///< no IMU sample for longer than its deadline
  bool overloaded = false;    ///< the process cannot keep up with its input and skips poses
  std::uint64_t imu_samples = 0;
  std::uint64_t fixes_used = 0;
  std::uint64_t fixes_down_weighted = 0;  ///< used fixes with less weight (is_down_weighted)
  std::uint64_t fixes_rejected = 0;
  std::uint64_t fixes_late = 0;  ///< rejected fixes with fix_too_late
  std::uint64_t headings = 0;
  std::uint64_t velocities_used = 0;
  std::uint64_t velocities_rejected = 0;  ///< contradict the estimate, as when wheels slip
  std::uint64_t velocities_unused = 0;    ///< as the engine or its settings demand, or before the first fix
  std::uint64_t events_lost = 0;          ///< gaps in the event sequence that were never filled
  std::uint64_t events_duplicated = 0;    ///< events with a repeated sequence number, or too late
  std::uint64_t samples_invalid = 0;      ///< not finite, impossible, out of order, or too late
  std::uint64_t imu_gaps = 0;             ///< gaps too long to integrate over
  std::uint32_t reset_counter = 0;
  std::uint64_t imu_deadlines_missed = 0;  ///< deadline periods without a sample, since the first one
  std::uint64_t fix_deadlines_missed = 0;
  std::uint64_t heading_deadlines_missed = 0;
  std::uint64_t bridge_losses = 0;  ///< number of times that the bridge of this beacon was lost
  std::uint64_t poses_late = 0;     ///< poses with status_late
  std::uint64_t poses_skipped = 0;  ///< poses not written: overloaded, or late while warming
  // Common to all beacons of the process:
  std::uint64_t pose_deadlines_missed = 0;
  std::uint64_t liveliness_lost = 0;   ///< expired leases of its pose writers
  std::uint64_t samples_lost = 0;      ///< input samples lost in transport
  std::uint64_t samples_rejected = 0;  ///< input samples rejected by full readers
  std::uint64_t incompatible_qos = 0;  ///< endpoints with incompatible QoS
  std::uint64_t poses_unwritten = 0;   ///< poses and reports not written because a slow reader blocked

  bool operator==(const FusionStatus&) const = default;
};

}  // namespace native

}  // namespace sonopose
