#pragma once
/// \file
/// Converts wire units ↔ SI units, with one pure function per type and direction. Values for the wire are
/// rounded to its steps and clamped to its range.

#include "marvelmind/packet.hpp"
#include <sonopose/samples/samples.hpp>

#include <numbers>
#include <optional>

namespace sonopose::marvelmind {

inline constexpr double accel_mps2_per_lsb = 1e-3 * standard_gravity_mps2;
inline constexpr double gyro_radps_per_lsb = 0.0175 * std::numbers::pi / 180;
inline constexpr double tesla_per_gauss = 1e-4;
inline constexpr double compass_xy_t_per_lsb = tesla_per_gauss / 1100;
inline constexpr double compass_z_t_per_lsb = tesla_per_gauss / 980;

/// Leaves the magnetic field empty if the compass is flagged as not available or reads zero on every axis.
ImuSample to_imu_sample(const RawImu& imu, TimeNs sensor_time_ns);

/// Leaves the quality empty, since it has its own packet. Sets the delay if the beacon measured it.
UltrasonicFix to_fix(const Position& position, TimeNs emission_time_ns, TimeNs received_time_ns);

/// Marks the heading as invalid if the beacon says "not applicable" or more than 360°.
PairHeading to_heading(const Position& position, TimeNs emission_time_ns, TimeNs received_time_ns);

/// Leaves the position empty if the map has none.
sonopose::StationaryBeacon to_stationary_beacon(const StationaryBeacon& beacon, TimeNs received_time_ns);

/// `time`: time of the sample in the beacon's clock.
RawImu to_raw_imu(const ImuSample& sample, const Stamp& time);

/// `emission`: time of the fix in the beacon's clock. A null or invalid heading becomes "not applicable".
/// Time passed is the measured delay, or zero (unknown).
Position to_position(const UltrasonicFix& fix, const PairHeading* heading, const Stamp& emission);

/// Returns the quality packet of a fix; empty if its quality is unknown.
std::optional<Quality> to_quality(const UltrasonicFix& fix);

}  // namespace sonopose::marvelmind
