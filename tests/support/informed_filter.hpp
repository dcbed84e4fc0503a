#pragma once
/// \file
/// A plain Kalman filter that knows what no engine knows: the initial state and the noise of the sensors. It
/// rejects nothing and serves as a reference for runs without wrong measurements.

#include "sim/simulator.hpp"
#include <sonopose/estimation/kalman/filter.hpp>

#include <cmath>
#include <deque>
#include <optional>

namespace sonopose::test {

class InformedFilter {
public:
  using Filter = estimation::kalman::Filter;

  /// Starts from the state `start`. `sensors.fix_noise_m` must be a single value.
  InformedFilter(const sim::SensorSettings& sensors, const TruthSample& start) : sensors_(sensors) {
    filter_.position_world_m = start.position_world_m;
    filter_.velocity_world_mps = start.velocity_world_mps;
    filter_.q_body_to_world = start.q_body_to_world;
    auto variances = filter_.covariance.diagonal();
    variances.segment<3>(estimation::kalman::at_position).setConstant(1e-4);
    variances.segment<3>(estimation::kalman::at_velocity).setConstant(1e-4);
    variances.segment<3>(estimation::kalman::at_attitude).setConstant(1e-4);
    variances.segment<3>(estimation::kalman::at_gyro_bias).setConstant(std::pow(sensors.gyro_bias_radps, 2));
    variances.segment<3>(estimation::kalman::at_accel_bias).setConstant(std::pow(sensors.accel_bias_mps2, 2));
    const double step_s = 1.0 / sensors.imu_rate_hz;
    noise_ = {.accel_mps2_rthz = sensors.accel_noise_mps2 * std::sqrt(step_s),
              .gyro_radps_rthz = sensors.gyro_noise_radps * std::sqrt(step_s),
              .accel_bias_mps2_rts = sensors.accel_bias_walk_mps2_rts,
              .gyro_bias_radps_rts = sensors.gyro_bias_walk_radps_rts};
  }

  /// Position of the tracked point at this sample.
  Vector3d predict(const ImuSample& imu) {
    step(imu);
    moments_.push_back({imu, filter_});
    while (seconds_between(moments_.front().imu.sensor_time_ns, imu.sensor_time_ns) > 2.0) {
      moments_.pop_front();
    }
    return filter_.tracked_position_world_m();
  }

  void correct(const UltrasonicFix& fix) {
    const double noise_m = sensors_.fix_noise_m.max;
    repeat_after(fix.emission_time_ns, [&](double ahead_s) {
      filter_.correct_fix(filter_.fix_innovation(fix.position_world_m,
                                                 noise_m * noise_m * Eigen::Matrix3d::Identity(), ahead_s));
    });
  }

  void correct(const PairHeading& heading) {
    const double noise_rad = sensors_.heading_noise_rad;
    repeat_after(heading.emission_time_ns, [&](double ahead_s) {
      filter_.correct_heading(heading.heading_world_rad, sensors_.pair_mount_offset_rad,
                              noise_rad * noise_rad, ahead_s);
    });
  }

private:
  struct Moment {
    ImuSample imu;
    Filter after;
  };

  void step(const ImuSample& imu) {
    if (last_) {
      filter_.predict(0.5 * (last_->angular_velocity_body_radps + imu.angular_velocity_body_radps),
                      0.5 * (last_->specific_force_body_mps2 + imu.specific_force_body_mps2),
                      seconds_between(last_->sensor_time_ns, imu.sensor_time_ns));
      filter_.propagate(noise_);
    }
    last_ = imu;
  }

  /// Rewinds to the latest sample before that time, calls `correct(ahead_s)` and replays the later samples.
  void repeat_after(TimeNs time_ns, const auto& correct) {
    std::size_t from = moments_.size();
    while (from > 0 && moments_[from - 1].imu.sensor_time_ns > time_ns) --from;
    if (from == 0) return;
    filter_ = moments_[from - 1].after;
    last_ = moments_[from - 1].imu;
    correct(seconds_between(last_->sensor_time_ns, time_ns));
    moments_[from - 1].after = filter_;
    for (std::size_t i = from; i < moments_.size(); ++i) {
      step(moments_[i].imu);
      moments_[i].after = filter_;
    }
  }

  sim::SensorSettings sensors_;
  estimation::kalman::ProcessNoise noise_;
  Filter filter_;
  std::optional<ImuSample> last_;
  std::deque<Moment> moments_;
};

}  // namespace sonopose::test
