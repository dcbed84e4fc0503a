#pragma once
/// \file
/// Views of beacons shared by the tests of their outputs.

#include "observation/beacon_observer.hpp"

#include <cmath>
#include <limits>

namespace sonopose::test {

inline constexpr TimeNs views_now_ns = 1'700'000'000'123'456'789;

/// A beacon with a good pose, turned 90° to the left; all values are known.
inline observation::BeaconView good_view() {
  observation::BeaconView view;
  view.address = 7;
  view.window_s = 1.0;
  view.poses = 100;
  view.pose_rate_hz = 100.0;
  view.latency = {0.00012, 0.00034};
  view.pose.position_world_m = {1.5, -2.25, 0.75};
  view.pose.velocity_world_mps = {3.0, 4.0, 0.0};
  view.pose.q_body_to_world = Quaterniond(std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5));
  view.pose.since_valid_fix_s = 0.05;
  view.pose.time_ns = views_now_ns - 1'000'000;
  view.pose.reset_counter = 2;
  view.bridge.emplace();
  view.bridge->battery_v = 3.9;
  view.bridge->imu_rate_hz = 99.5;
  view.bridge->fix_rate_hz = 12.0;
  view.bridge->crc_errors = 4;
  view.fusion.emplace();
  view.fusion->fixes_used = 110;
  view.fusion->fixes_down_weighted = 9;
  view.fusion->fixes_rejected = 6;
  view.fusion->fixes_late = 2;
  view.fusion->events_lost = 17;
  view.fusion->imu_deadlines_missed = 3;
  view.fusions = {*view.fusion};
  view.deadlines_missed = 8;
  view.losses = 2;
  view.predicted = 5;
  view.segments = {{{0.001, 0.002}, {0.00005, 0.00011}, {0.00001, 0.00002}, {0.00006, 0.00021}}};
  view.worst = observation::PoseTrace{.sequence = 812,
                                      .sensor_ns = views_now_ns - 3'000'000,
                                      .bridge_ns = views_now_ns - 2'000'000,
                                      .fusion_in_ns = views_now_ns - 1'500'000,
                                      .fusion_out_ns = views_now_ns - 1'250'000,
                                      .here_ns = views_now_ns};
  view.position_error_rms_m = 0.021;
  view.position_error_max_m = 0.055;
  return view;
}

/// Estimate of a fusion that estimates everything but the delay.
inline Estimate estimate() {
  Estimate estimate;
  estimate.gyro_bias_body_radps = {Vector3d(0.001, -0.002, 0.0305), Vector3d::Constant(0.0004)};
  estimate.accelerometer_bias_body_mps2 = {Vector3d(0.05, 0, 0), Vector3d::Constant(0.01)};
  estimate.lever_arm_body_m = {Vector3d(0.1, 0.02, -12.5), Vector3d(0.003, 10.25, 0.003)};
  estimate.fix_noise_m = {0.021, -1.0};
  estimate.heading_noise_rad = {0.0174532925199433, 0.00174532925199433};
  return estimate;
}

/// A beacon with a known address and no data.
inline observation::BeaconView silent_view() {
  observation::BeaconView view;
  view.address = 21;
  view.latency = observation::percentiles_of({});
  view.segments.fill(observation::percentiles_of({}));
  view.pose.since_valid_fix_s = std::numeric_limits<double>::infinity();
  return view;
}

}  // namespace sonopose::test
