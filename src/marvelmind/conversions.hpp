#pragma once
/// \file
/// The wire's units ↔ the native's SI units: one pure function a kind and direction. What goes to the wire is
/// rounded to its steps and held inside its range.

#include <sonopose/samples/samples.hpp>
#include "marvelmind/packet.hpp"

#include <numbers>
#include <optional>

namespace sonopose::marvelmind {

inline constexpr double standard_gravity_mps2 = 9.80665;
inline constexpr double accel_mps2_per_lsb = 1e-3 * standard_gravity_mps2;
inline constexpr double gyro_radps_per_lsb = 0.0175 * std::numbers::pi / 180;
inline constexpr double tesla_per_gauss = 1e-4;
inline constexpr double compass_xy_t_per_lsb = tesla_per_gauss / 1100;
inline constexpr double compass_z_t_per_lsb = tesla_per_gauss / 980;

/// The magnetic field is empty where the compass is flagged not available, or gives zero on every axis.
ImuSample to_imu_sample(const RawImu& imu, TimeNs sensor_time_ns);

/// Without its quality, which comes in a packet of its own. The delay is measured where the beacon says one.
UltrasonicFix to_fix(const Position& position, TimeNs emission_time_ns, TimeNs received_time_ns);

/// Not valid where the beacon says "not applicable", or more than 360°.
PairHeading to_heading(const Position& position, TimeNs emission_time_ns, TimeNs received_time_ns);

/// `time`: the sample's, in the beacon's clock.
RawImu to_raw_imu(const ImuSample& sample, const Stamp& time);

/// `emission`: the fix's, in the beacon's clock. A heading that is null or not valid becomes "not
/// applicable". Time passed is the measured delay; zero, which says nothing, where there is none.
Position to_position(const UltrasonicFix& fix, const PairHeading* heading, const Stamp& emission);

/// The quality packet of a fix; none where its quality is not known.
std::optional<Quality> to_quality(const UltrasonicFix& fix);

}  // namespace sonopose::marvelmind
