#pragma once
/// \file
/// Disturbances of a scenario: plain data, with times in seconds after the start of the run, and functions
/// that evaluate them at a time.

#include "sim/random.hpp"
#include "sim/trajectory.hpp"
#include <sonopose/samples/samples.hpp>

#include <optional>
#include <vector>

namespace sonopose::sim {

/// Silence of a sensor in [begin, begin + duration).
struct Outage {
  double begin_s = 0;
  double duration_s = 0;
};

/// Slip of the wheels in [begin, begin + duration): they turn by the share `by` faster than the vehicle
/// moves.
struct WheelSlip {
  double begin_s = 0;
  double duration_s = 0;
  double by = 0;
};

/// Omission of every other fix in [begin, begin + duration), with its heading.
struct HalvedFixRate {
  double begin_s = 0;
  double duration_s = 0;
};

/// A vertical plane.
struct Wall {
  Vector3d point_world_m = Vector3d::Zero();  ///< on the plane
  Vector3d normal_world = Vector3d::UnitX();  ///< horizontal unit vector
};

/// Wrong track of the fixes emitted in [begin, begin + duration), as after a reflection: parallel to the true
/// one, drifting away from it, or mirrored. The heading stays correct, since both beacons of the pair receive
/// the reflection.
struct OutlierBurst {
  double begin_s = 0;
  double duration_s = 0;
  Vector3d offset_world_m = Vector3d::Zero();   ///< offset at `begin_s`
  Vector3d drift_world_mps = Vector3d::Zero();  ///< growth of the offset
  std::optional<Wall> mirror{};                 ///< mirrors the true track, in addition to the offset
};

/// Move of the body to another place at `at_s`, which its IMU does not measure. Equivalently, the map of the
/// fixes moves: it turns about a vertical axis, then it shifts.
struct Relocation {
  double at_s = 0;
  Vector3d by_world_m = Vector3d::Zero();
  double turn_rad = 0;
  Vector3d pivot_world_m = Vector3d::Zero();  ///< pivot of the turn
};

/// Error of the heading that rises smoothly to `peak_rad` and falls again over [begin, begin + duration), as
/// when the pair passes iron.
struct HeadingError {
  double begin_s = 0;
  double duration_s = 0;
  double peak_rad = 0;
  bool is_step = false;  ///< true: it is `peak_rad` all the time, as when the beacons of the pair are swapped
};

/// Fixes that are worse than usual in [begin, begin + duration).
struct FixFault {
  double begin_s = 0;
  double duration_s = 0;
  double noise_m = 0;    ///< standard deviation of additional white noise, per axis
  bool repeats = false;  ///< true: the last position before it is sent again and again
};

/// Linear growth of the gyroscope's bias over [begin, begin + duration), as when an IMU warms up.
struct GyroDrift {
  double begin_s = 0;
  double duration_s = 0;
  Vector3d by_body_radps = Vector3d::Zero();
};

/// Readings of the IMU that differ from the motion in [begin, begin + duration). Simultaneous faults all
/// apply, one after the other.
struct ImuFault {
  double begin_s = 0;
  double duration_s = 0;
  Vector3d accel_offset_body_mps2 = Vector3d::Zero();  ///< a shock, or a step of the bias
  Vector3d gyro_offset_body_radps = Vector3d::Zero();
  Vector3d accel_factor = Vector3d::Ones();   ///< factor of the specific force, per axis
  Vector3d gyro_factor = Vector3d::Ones();    ///< 0: the axis is dead; −1: inverted
  Vector3d turned_by_rad = Vector3d::Zero();  ///< rotation vector of the IMU in the body, as of a loose mount
  double vibration_mps2 = 0;                  ///< standard deviation of a white acceleration, per axis
  double vibration_radps = 0;                 ///< standard deviation of a white rate, per axis
};

/// Error of the fixes that depends on their place, as with a wrong speed of sound: a sine wave of the
/// position in every coordinate.
struct BiasField {
  Vector3d amplitude_world_m = Vector3d::Zero();
  Vector3d wave_radpm = Vector3d::Zero();  ///< wave vector, world
  double phase_rad = 0;
};

/// A stationary beacon that is in the wrong place on the map. Fixes are the least-squares solution of the
/// ranges to all beacons, to first order in the error of the map. Their error depends on the place of the
/// mobile beacon, which must not be in the plane of the stationary ones.
struct MisplacedBeacon {
  std::vector<Vector3d> beacons_world_m{};  ///< true places; at least three, not on one line
  std::size_t misplaced = 0;                ///< index of the wrong one
  Vector3d map_error_m = Vector3d::Zero();  ///< place on the map minus the true one
};

/// A share of the fixes that is worse than the others.
struct PoorFixes {
  double share = 0;                           ///< 0…1
  std::optional<Range> quality_percent{};     ///< reported, uniform; empty: that of the other fixes
  double noise_factor = 1;                    ///< standard deviation in units of the run's fix noise
  Range offset_m{};                           ///< distance from the true place in a random direction, uniform
  std::optional<Vector3d> default_world_m{};  ///< position reported instead, exactly
};

/// Faults in the transport of packets to the host. Shares are 0…1; each packet has at most one fault.
struct PacketFaults {
  double dropped_share = 0;     ///< packets lost singly
  double lost_runs_share = 0;   ///< packets lost together with the next 2…5
  double duplicated_share = 0;  ///< packets that arrive twice, the copy directly after
  double late_share = 0;        ///< packets overtaken by later ones
  Range late_by_s{};            ///< delay in addition to the usual one, uniform
};

/// All disturbances of one scenario; none by default.
struct Disturbances {
  std::vector<Outage> outages{};  ///< outages of fixes and headings
  std::vector<Outage> imu_outages{};
  std::vector<HalvedFixRate> halved_fix_rates{};
  std::vector<WheelSlip> wheel_slips{};
  std::vector<OutlierBurst> outlier_bursts{};
  std::vector<Relocation> relocations{};
  std::vector<HeadingError> heading_errors{};
  std::optional<GyroDrift> gyro_drift{};
  std::vector<ImuFault> imu_faults{};
  std::optional<BiasField> bias_field{};
  std::optional<MisplacedBeacon> misplaced_beacon{};
  std::vector<FixFault> fix_faults{};
  std::vector<PoorFixes> poor_fixes{};  ///< for disjoint sets of fixes: the shares add up
  PacketFaults imu_packets{};
  PacketFaults position_packets{};  ///< one packet contains the fix and the heading
};

/// Throws std::invalid_argument, naming the invalid field and its value.
void check(const Disturbances& disturbances);

/// True if one of the outages holds at this time.
bool is_outage(const std::vector<Outage>& outages, double time_s);

/// True if the emission of this number is omitted because the fix rate is halved.
bool is_left_out(const Disturbances& disturbances, double time_s, std::uint64_t emission);

/// Changes the sample to what the IMU with its faults measures. Draws only while it vibrates.
void apply_imu_faults(const Disturbances& disturbances, double time_s, Random& random, ImuSample& sample);

/// Offset of the fixes' track from the true position.
Vector3d track_offset_world_m(const Disturbances& disturbances, double time_s,
                              const Vector3d& position_world_m);

/// Motion after the relocations until this time, one after the other.
Motion relocated(const Disturbances& disturbances, double time_s, const Motion& motion);

/// Sum of the slips.
double wheel_slip(const Disturbances& disturbances, double time_s);

/// Sum of the heading's errors.
double heading_error_rad(const Disturbances& disturbances, double time_s);

/// Growth of the gyroscope's bias until this time.
Vector3d gyro_drift_body_radps(const Disturbances& disturbances, double time_s);

/// Noise of the fix by the faults at this time. Draws only while one has noise.
Vector3d draw_fault_noise_world_m(const Disturbances& disturbances, double time_s, Random& random);

/// True if a fault repeats the last position at this time.
bool repeats_position(const Disturbances& disturbances, double time_s);

/// Kind of the next fix if it is a poor one, otherwise null. Always draws one number.
const PoorFixes* draw_poor_fix(const Disturbances& disturbances, Random& random);

/// Error of a poor fix of this kind, in addition to its noise. Draws only if the kind has an offset.
Vector3d draw_offset_world_m(const PoorFixes& kind, Random& random);

/// Poor reception: a quarter of the fixes is bad, a fifth is mediocre.
std::vector<PoorFixes> poor_reception();

/// Fate of one packet.
struct PacketFate {
  int copies = 1;     ///< 0: lost
  double late_s = 0;  ///< delay in addition to the usual one
};

/// Transport of one kind of packet from the beacon to the host.
class PacketChannel {
public:
  PacketChannel(const PacketFaults& faults, Random random);

  /// Fate of the next packet.
  PacketFate next();

private:
  PacketFaults faults_;
  Random random_;
  int still_to_lose_ = 0;  ///< remainder of the current run of losses
};

}  // namespace sonopose::sim
