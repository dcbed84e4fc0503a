#pragma once
/// \file
/// The native: the samples that every edge of the system (wire, log folder, simulator, DDS, ROS 2) converts
/// to and from, once. SI units; times are integer nanoseconds since the Unix epoch in the host's clock;
/// vectors say in their names in which frame they stand (`body`: the IMU's axes, `world`: the beacons' map, Z
/// up).

#include <sonopose/samples/time.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <optional>
#include <variant>

namespace sonopose {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Which beacon (or other sensor head) a sample comes from; the key of every native topic.
using BeaconAddress = std::uint16_t;

/// Names every beacon at once where a command allows it; never the address of a sample.
inline constexpr BeaconAddress all_beacons = 0xFFFF;

/// What an accelerometer at rest reads along the vertical; the one value for simulation and fusion.
inline constexpr double standard_gravity_mps2 = 9.80665;

/// One inertial measurement.
struct ImuSample {
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;  ///< event number over the beacon's three streams, given by the bridge
  TimeNs sensor_time_ns = 0;   ///< when it was measured
  TimeNs bridge_time_ns = 0;   ///< when the bridge published it; for latency alone, never for integration
  Vector3d angular_velocity_body_radps = Vector3d::Zero();
  Vector3d specific_force_body_mps2 = Vector3d::Zero();  ///< +9.81 on z at rest, level
  std::optional<Vector3d> magnetic_field_body_t;         ///< tesla

  bool operator==(const ImuSample&) const = default;
};

/// What the positioning system said of a fix, besides the position; bits of `UltrasonicFix::flags`.
enum UltrasonicFlag : std::uint32_t {
  ultrasonic_flag_user_button_1 = 1U << 0U,
  ultrasonic_flag_user_button_2 = 1U << 1U,
  ultrasonic_flag_other_hedge = 1U << 2U,       ///< the data are of another mobile beacon
  ultrasonic_flag_out_of_geofence = 1U << 3U,   ///< the beacon stands outside its geofence
  ultrasonic_flag_pair_centre = 1U << 4U,       ///< the coordinates are the centre of a beacon pair
  ultrasonic_flag_second_resolution = 1U << 5U  ///< stamped in 1/64 s by old firmware
};

/// One position from the ultrasonic system. Fixes that it flags as not available are never made into one.
struct UltrasonicFix {
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;
  TimeNs emission_time_ns = 0;  ///< moment of the ultrasound emission: where the beacon *was*
  TimeNs received_time_ns = 0;  ///< when the fix reached the host; a causal user has it only from then on
  Vector3d position_world_m = Vector3d::Zero();
  std::optional<double> quality_percent;   ///< 0…100; empty where the hardware does not report it
  std::optional<double> measured_delay_s;  ///< emission → receipt, where the hardware measured it
  std::uint32_t flags = 0;                 ///< bits of UltrasonicFlag

  bool operator==(const UltrasonicFix&) const = default;
};

/// Direction of the axis of two paired beacons in the map, before any mount offset.
struct PairHeading {
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;
  TimeNs emission_time_ns = 0;
  TimeNs received_time_ns = 0;
  double heading_world_rad = 0;  ///< counter-clockwise from world +X
  bool valid = false;            ///< false: the hardware says that it knows no orientation

  bool operator==(const PairHeading&) const = default;
};

/// Anything that the engine takes, in the order of arrival.
using Event = std::variant<ImuSample, UltrasonicFix, PairHeading>;

inline BeaconAddress address_of(const Event& event) {
  return std::visit([](const auto& sample) { return sample.address; }, event);
}

inline std::uint64_t sequence_of(const Event& event) {
  return std::visit([](const auto& sample) { return sample.sequence; }, event);
}

/// From when on a causal user may use the event: an IMU sample at once, a fix or heading at its receipt.
inline TimeNs available_at_ns(const Event& event) {
  struct Visitor {
    TimeNs operator()(const ImuSample& sample) const { return sample.sensor_time_ns; }
    TimeNs operator()(const UltrasonicFix& fix) const { return fix.received_time_ns; }
    TimeNs operator()(const PairHeading& heading) const { return heading.received_time_ns; }
  };
  return std::visit(Visitor{}, event);
}

/// A true state, where it is known (simulator, motion capture).
struct TruthSample {
  BeaconAddress address = 0;
  TimeNs time_ns = 0;
  Vector3d position_world_m = Vector3d::Zero();
  Quaterniond q_body_to_world = Quaterniond::Identity();
  Vector3d velocity_world_mps = Vector3d::Zero();
};

}  // namespace sonopose
