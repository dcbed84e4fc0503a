#include "calibration/fit/turns.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <cmath>

namespace sonopose::calibration::fit::detail {

std::vector<Turn> turns_between(std::span<const ImuSample> imu, std::span<const StillInterval> intervals,
                                const AccelerometerSettings& accelerometer) {
  constexpr double max_duration_s = 30.0;  // limit beyond which the offset's error counts
  constexpr double min_angle_rad = 0.3;
  const Affine model = model_of(accelerometer);
  const double max_gap_s = 5.0 * usual_period_s(imu);
  std::vector<Turn> turns;
  for (std::size_t i = 1; i < intervals.size(); ++i) {
    const std::size_t begin = intervals[i - 1].end - 1;
    const Turn turn{imu.subspan(begin, intervals[i].begin + 1 - begin),
                    model(intervals[i - 1].mean_force_mps2).normalized(),
                    model(intervals[i].mean_force_mps2).normalized()};
    const double took_s = seconds_between(turn.imu.front().sensor_time_ns, turn.imu.back().sensor_time_ns);
    bool usable = took_s <= max_duration_s && turn.up_before.dot(turn.up_after) < std::cos(min_angle_rad);
    for (std::size_t k = 1; k < turn.imu.size() && usable; ++k) {
      const double dt_s = seconds_between(turn.imu[k - 1].sensor_time_ns, turn.imu[k].sensor_time_ns);
      usable = dt_s > 0.0 && dt_s <= max_gap_s && turn.imu[k].angular_velocity_body_radps.allFinite();
    }
    if (usable) turns.push_back(turn);
  }
  return turns;
}

Eigen::VectorXd residuals_of(const std::vector<Turn>& turns, const GyroscopeSettings& settings) {
  const Affine model = model_of(settings);
  Eigen::VectorXd residuals(3 * static_cast<Eigen::Index>(turns.size()));
  for (std::size_t i = 0; i < turns.size(); ++i) {
    Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
    const auto& imu = turns[i].imu;
    Vector3d before_radps = model(imu.front().angular_velocity_body_radps);
    for (std::size_t k = 1; k < imu.size(); ++k) {
      const double dt_s = seconds_between(imu[k - 1].sensor_time_ns, imu[k].sensor_time_ns);
      const Vector3d rate_radps = model(imu[k].angular_velocity_body_radps);
      turned = turned * geometry::rotation_by(0.5 * dt_s * (before_radps + rate_radps));
      before_radps = rate_radps;
    }
    residuals.segment<3>(3 * static_cast<Eigen::Index>(i)) =
        turned.normalized().conjugate() * turns[i].up_before - turns[i].up_after;
  }
  return residuals;
}

}  // namespace sonopose::calibration::fit::detail
