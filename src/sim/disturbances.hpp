#pragma once
/// \file
/// The disturbances of a scenario: plain data, with times in seconds after the start of the run, and
/// functions that evaluate them at a time.

#include "sim/random.hpp"
#include <sonopose/samples/samples.hpp>

#include <optional>
#include <vector>

namespace sonopose::sim {

/// No fix and no heading is emitted in [begin, begin + duration).
struct Outage {
  double begin_s = 0;
  double duration_s = 0;
};

/// Fixes emitted in [begin, begin + duration) are on a wrong, parallel track, as after a reflection. The
/// heading stays correct, since both beacons of the pair receive the reflection.
struct OutlierBurst {
  double begin_s = 0;
  double duration_s = 0;
  Vector3d offset_world_m = Vector3d::Zero();
};

/// At `at_s` the body moves to another place without its IMU measuring it.
struct Relocation {
  double at_s = 0;
  Vector3d by_world_m = Vector3d::Zero();
};

/// The gyro's bias grows linearly by this much over [begin, begin + duration), as when an IMU warms up.
struct GyroDrift {
  double begin_s = 0;
  double duration_s = 0;
  Vector3d by_body_radps = Vector3d::Zero();
};

/// A share of the fixes that is worse than the others and reports it.
struct PoorFixes {
  double share = 0;         ///< 0…1
  Range quality_percent{};  ///< reported, uniform
  double noise_factor = 1;  ///< standard deviation in units of the run's fix noise
};

/// Faults of the packets' transport to the host; shares are 0…1, and each packet has at most one fault.
struct PacketFaults {
  double dropped_share = 0;     ///< lost singly
  double lost_runs_share = 0;   ///< lost together with the next 2…5 packets
  double duplicated_share = 0;  ///< arrives twice, the copy directly after
  double late_share = 0;        ///< overtaken by later packets
  Range late_by_s{};            ///< in addition to the usual delay, uniform
};

/// All disturbances of one scenario; none by default.
struct Disturbances {
  std::vector<Outage> outages{};
  std::vector<OutlierBurst> outlier_bursts{};
  std::vector<Relocation> relocations{};
  std::optional<GyroDrift> gyro_drift{};
  std::vector<PoorFixes> poor_fixes{};  ///< for disjoint sets of fixes: the shares add up
  PacketFaults imu_packets{};
  PacketFaults position_packets{};  ///< one packet contains the fix and the heading
};

/// Throws std::invalid_argument that names the invalid field and its value.
void check(const Disturbances& disturbances);

/// Whether no fix is emitted at this time.
bool is_outage(const Disturbances& disturbances, double time_s);

/// The offset of the fixes' track.
Vector3d track_offset_world_m(const Disturbances& disturbances, double time_s);

/// The sum of the relocations until this time.
Vector3d relocated_by_world_m(const Disturbances& disturbances, double time_s);

/// The growth of the gyro's bias until this time.
Vector3d gyro_drift_body_radps(const Disturbances& disturbances, double time_s);

/// The kind of the next fix if it is a poor one, else null. Always draws one number.
const PoorFixes* draw_poor_fix(const Disturbances& disturbances, Random& random);

/// The fate of one packet.
struct PacketFate {
  int copies = 1;     ///< 0: lost
  double late_s = 0;  ///< in addition to the usual delay
};

/// The transport of one kind of packet from the beacon to the host.
class PacketChannel {
public:
  PacketChannel(const PacketFaults& faults, Random random);

  /// The fate of the next packet.
  PacketFate next();

private:
  PacketFaults faults_;
  Random random_;
  int still_to_lose_ = 0;  ///< of the current run of losses
};

}  // namespace sonopose::sim
