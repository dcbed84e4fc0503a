#pragma once
/// \file
/// The native types. Every edge of the system (wire, log folder, simulator, DDS, ROS 2) converts to and from
/// them once. Units are SI; times are integer nanoseconds since the Unix epoch in the host's clock. The name
/// of a vector contains its frame (`body`: the IMU's axes, `world`: the beacons' map, Z up).

#ifdef DDSCXX_SONOPOSE_HPP
#error "sonopose.hpp has classes of the same names as these native samples: include one of the two"
#endif
#define DDSCXX_SONOPOSE_HPP_EXCLUDED

#include <sonopose/samples/covariance.hpp>
#include <sonopose/samples/time.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

namespace sonopose {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Address of the beacon (or other sensor head) that a sample comes from; key of the native topics.
using BeaconAddress = std::uint16_t;

/// Every beacon, in a command; never the address of a sample.
inline constexpr BeaconAddress all_beacons = 0xFFFF;

/// Vertical specific force at rest, in the simulator and in the fusion.
inline constexpr double standard_gravity_mps2 = 9.80665;

/// Meaning of the values of an IMU sample.
enum class ImuMeaning : std::uint32_t {
  unknown,
  instant,         ///< the moment `sensor_time_ns`
  mean_since_last  ///< mean over the interval from the previous sample
};

/// Words for ImuMeaning in options and files, in the order of its values.
inline constexpr std::array<std::string_view, 3> imu_meaning_words{"unknown", "instant", "mean"};

/// Event number of a sample whose producer is not the bridge of its beacon, such as an odometer's. It is used
/// when it arrives.
inline constexpr std::uint64_t unnumbered = 0;

// The types that sonopose.idl has too are in an inline namespace: for the linker, their names differ from
// those of the classes in sonopose.hpp.
inline namespace native {

/// One inertial measurement.
struct ImuSample {
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;  ///< event number over all streams of the beacon, given by the bridge
  TimeNs sensor_time_ns = 0;   ///< time of measurement
  TimeNs bridge_time_ns = 0;  ///< time of publication by the bridge; for latency alone, never for integration
  Vector3d angular_velocity_body_radps = Vector3d::Zero();
  Vector3d specific_force_body_mps2 = Vector3d::Zero();  ///< +9.81 on z if at rest and level
  std::optional<Vector3d> magnetic_field_body_t;         ///< tesla
  ImuMeaning meaning = ImuMeaning::unknown;

  bool operator==(const ImuSample&) const = default;
};

}  // namespace native

/// Flags of the positioning system for a position; bits of `UltrasonicFix::flags`.
enum UltrasonicFlag : std::uint32_t {
  ultrasonic_flag_user_button_1 = 1U << 0U,
  ultrasonic_flag_user_button_2 = 1U << 1U,
  ultrasonic_flag_other_hedge = 1U << 2U,        ///< the data belong to another mobile beacon
  ultrasonic_flag_out_of_geofence = 1U << 3U,    ///< the beacon is outside its geofence
  ultrasonic_flag_pair_centre = 1U << 4U,        ///< the coordinates are the centre of a beacon pair
  ultrasonic_flag_second_resolution = 1U << 5U,  ///< stamped in 1/64 s by old firmware
  ultrasonic_flag_set_pose = 1U << 6U            ///< the user's word: the estimate starts again here
};

inline namespace native {

/// One position from the ultrasonic system. A position that it flags as not available never becomes a fix.
struct UltrasonicFix {
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;
  TimeNs emission_time_ns = 0;  ///< moment of the ultrasound emission: where the beacon *was*
  TimeNs received_time_ns = 0;  ///< time of receipt by the host; no causal user has the fix earlier
  Vector3d position_world_m = Vector3d::Zero();
  std::optional<Covariance<3>> covariance_world_m2;  ///< empty if the source does not know it
  std::optional<double> quality_percent;             ///< 0…100; empty if the hardware does not report it
  std::optional<double> measured_delay_s;            ///< emission → receipt, if the hardware measured it
  std::uint32_t flags = 0;                           ///< bits of UltrasonicFlag
  Vector3d point_body_m = Vector3d::Zero();          ///< located point, seen from the tracked one

  bool operator==(const UltrasonicFix&) const = default;
};

}  // namespace native

/// Bits of `PairHeading::flags`.
enum HeadingFlag : std::uint32_t {
  heading_flag_of_body = 1U << 0U,  ///< direction of the body's x axis: no mount offset applies
  heading_flag_set_pose =
      1U << 1U  ///< the user's word, with a fix with ultrasonic_flag_set_pose just after it
};

inline namespace native {

/// Direction of the axis of two paired beacons in the map, before any mount offset, or of the body.
struct PairHeading {
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;
  TimeNs emission_time_ns = 0;
  TimeNs received_time_ns = 0;
  double heading_world_rad = 0;  ///< counter-clockwise from world +X
  bool valid = false;            ///< false: the hardware reports that the orientation is unknown
  double std_rad = -1;           ///< one standard deviation; negative: unknown
  std::uint32_t flags = 0;       ///< bits of HeadingFlag

  bool operator==(const PairHeading&) const = default;
};

}  // namespace native

/// Axes that a TwistSample measured; bits of `TwistSample::axes`.
enum TwistAxis : std::uint32_t {
  twist_velocity_x = 1U << 0U,
  twist_velocity_y = 1U << 1U,
  twist_velocity_z = 1U << 2U,
  twist_angular_velocity_x = 1U << 3U,
  twist_angular_velocity_y = 1U << 4U,
  twist_angular_velocity_z = 1U << 5U
};

inline namespace native {

/// A measured velocity of a point of the body (kalman.twist.point_x_m, point_y_m), such as wheel odometry, in
/// the axes of the pose's body. The Kalman engine uses its linear part (docs/kalman.md).
struct TwistSample {
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;
  TimeNs emission_time_ns = 0;  ///< time of measurement
  TimeNs received_time_ns = 0;  ///< time of receipt by the host
  Vector3d velocity_body_mps = Vector3d::Zero();
  Vector3d velocity_std_mps = Vector3d::Constant(-1);  ///< per body axis; negative: unknown
  Vector3d angular_velocity_body_radps = Vector3d::Zero();
  Vector3d angular_velocity_std_radps = Vector3d::Constant(-1);  ///< per body axis; negative: unknown
  std::uint32_t axes = 0;                                        ///< bits of TwistAxis

  bool operator==(const TwistSample&) const = default;
};

/// A stationary beacon of the positioning system.
struct StationaryBeacon {
  BeaconAddress address = 0;                 ///< address of the stationary beacon
  TimeNs time_ns = 0;                        ///< receipt of its position by the host
  std::optional<Vector3d> position_world_m;  ///< empty if unknown

  bool operator==(const StationaryBeacon&) const = default;
};

}  // namespace native

/// An input of the engine.
using Event = std::variant<ImuSample, UltrasonicFix, PairHeading, TwistSample>;

inline BeaconAddress address_of(const Event& event) {
  return std::visit([](const auto& sample) { return sample.address; }, event);
}

inline std::uint64_t sequence_of(const Event& event) {
  return std::visit([](const auto& sample) { return sample.sequence; }, event);
}

/// Earliest time at which a causal user has the event: the stamp of an IMU sample, the receipt of any
/// other.
inline TimeNs available_at_ns(const ImuSample& sample) {
  return sample.sensor_time_ns;
}
template <class Received>
requires requires(const Received& sample) {
  sample.received_time_ns;
}
TimeNs available_at_ns(const Received& sample) {
  return sample.received_time_ns;
}
inline TimeNs available_at_ns(const Event& event) {
  return std::visit([](const auto& sample) { return available_at_ns(sample); }, event);
}

inline namespace native {

/// A true state, if known (simulator, motion capture).
struct TruthSample {
  BeaconAddress address = 0;
  TimeNs time_ns = 0;
  Vector3d position_world_m = Vector3d::Zero();
  Quaterniond q_body_to_world = Quaterniond::Identity();
  Vector3d velocity_world_mps = Vector3d::Zero();

  bool operator==(const TruthSample&) const = default;
};

}  // namespace native

}  // namespace sonopose
