#pragma once
/// \file
/// What goes wrong in a scenario: plain data, times in seconds after the start of the run, and the functions
/// that say what holds at a time.

#include <sonopose/samples/samples.hpp>
#include "sim/random.hpp"

#include <optional>
#include <vector>

namespace sonopose::sim {

/// Nothing is emitted in [begin, begin + duration): no fix and no heading.
struct Outage {
  double begin_s = 0;
  double duration_s = 0;
};

/// Fixes emitted in [begin, begin + duration) lie on a wrong, parallel track, as after a reflection. The
/// heading is that of two beacons which both hear the reflection, so it stays right.
struct OutlierBurst {
  double begin_s = 0;
  double duration_s = 0;
  Vector3d offset_world_m = Vector3d::Zero();
};

/// From `at_s` on the body is elsewhere, without its IMU having felt the way.
struct Relocation {
  double at_s = 0;
  Vector3d by_world_m = Vector3d::Zero();
};

/// The gyro's bias grows by this much, evenly over [begin, begin + duration): an IMU that warms up.
struct GyroDrift {
  double begin_s = 0;
  double duration_s = 0;
  Vector3d by_body_radps = Vector3d::Zero();
};

/// A share of the fixes that is worse than the others and says so.
struct PoorFixes {
  double share = 0;         ///< 0…1
  Range quality_percent{};  ///< reported, uniform
  double noise_factor = 1;  ///< standard deviation in units of the run's fix noise
};

/// What the way to the host does to packets; shares are 0…1 and each packet has one fate at most.
struct PacketFaults {
  double dropped_share = 0;     ///< lost alone
  double lost_runs_share = 0;   ///< lost together with the next 2…5
  double duplicated_share = 0;  ///< comes twice, the copy right behind
  double late_share = 0;        ///< overtaken by those after it
  Range late_by_s{};            ///< on top of the usual delay, uniform
};

/// All that is wrong in one scenario; nothing by default.
struct Disturbances {
  std::vector<Outage> outages{};
  std::vector<OutlierBurst> outlier_bursts{};
  std::vector<Relocation> relocations{};
  std::optional<GyroDrift> gyro_drift{};
  std::vector<PoorFixes> poor_fixes{};  ///< each of its own fixes; the shares add up
  PacketFaults imu_packets{};
  PacketFaults position_packets{};  ///< a position packet carries the fix and the heading
};

/// Throws std::invalid_argument that names the field and its value.
void check(const Disturbances& disturbances);

/// Whether the ultrasound is silent.
bool is_outage(const Disturbances& disturbances, double time_s);

/// By how much the fixes' track is wrong, metres in the world.
Vector3d track_offset_world_m(const Disturbances& disturbances, double time_s);

/// By how much the body has been carried from its path until now, metres in the world.
Vector3d relocated_by_world_m(const Disturbances& disturbances, double time_s);

/// How much the gyro's bias has grown until now, in the body.
Vector3d gyro_drift_body_radps(const Disturbances& disturbances, double time_s);

/// The kind of poor fix that the next one is, if it is one. One number is drawn in any case.
const PoorFixes* draw_poor_fix(const Disturbances& disturbances, Random& random);

/// What becomes of one packet.
struct PacketFate {
  int copies = 1;     ///< 0: lost
  double late_s = 0;  ///< on top of the usual delay
};

/// The way of one kind of packet from the beacon to the host.
class PacketChannel {
public:
  PacketChannel(const PacketFaults& faults, Random random);

  /// The fate of the next packet.
  PacketFate next();

private:
  PacketFaults faults_;
  Random random_;
  int still_to_lose_ = 0;  ///< of a run that is being lost
};

}  // namespace sonopose::sim
