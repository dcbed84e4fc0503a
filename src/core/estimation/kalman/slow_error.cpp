#include <sonopose/estimation/kalman/slow_error.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {

void SlowErrorDetector::add(TimeNs time_ns, const Vector3d& innovation_world_m,
                            const Eigen::Matrix3d& innovation_covariance_m2,
                            const Eigen::Matrix3d& fix_covariance_m2, bool moves) {
  constexpr double mean_memory_s = 0.3;
  constexpr double power_memory_s = 5.0;
  constexpr double max_interval_s = 1.0;
  constexpr double max_m2 = 1e6;  // of a fix that says anything
  const double dt_s = std::max(0.0, seconds_between(seen_ns, time_ns));
  seen_ns = time_ns;
  if (dt_s > max_interval_s) {  // the innovation shows what happened meanwhile
    mean_world_m.setZero();
    mean_m2 = 0.0;
    const double kept = moves ? std::exp(-dt_s / power_memory_s) : 1.0;
    power_m2 *= kept;
    power_m4 *= kept * kept;
    return;
  }
  const auto gain = [dt_s](double memory_s) { return 1.0 - std::exp(-dt_s / memory_s); };
  const auto square = [](double value) { return value * value; };
  const Eigen::Matrix3d information = fix_covariance_m2.llt().solve(Eigen::Matrix3d::Identity());
  const double weight = information.trace();
  const double innovation_m2 = (information * innovation_covariance_m2).trace() / weight;
  if (!(innovation_m2 < max_m2)) return;
  if (moves) {
    const double product_m2 = innovation_world_m.dot(information * mean_world_m) / weight;
    const double by = gain(power_memory_s);
    power_m2 += by * (product_m2 - power_m2);
    power_m4 = square(1.0 - by) * power_m4 + square(by) * innovation_m2 * mean_m2 / 3.0;
  }
  const double by = gain(mean_memory_s);
  mean_world_m += by * (innovation_world_m - mean_world_m);
  mean_m2 = square(1.0 - by) * mean_m2 + square(by) * innovation_m2;
}

double SlowErrorDetector::variance_m2(double accel_mps2_rthz, double gyro_radps_rthz) const {
  constexpr double shown_share = 1.0 / 3.0;  // of the error, in the innovations
  constexpr double chance_stds = 2.0;
  constexpr double by_accel_s3 = 0.2;  // power by noise of the IMU, over its spectral density
  constexpr double by_gyro_m2ps = 60.0;
  const double explained_m2 = chance_stds * std::sqrt(power_m4) +
                              by_accel_s3 * accel_mps2_rthz * accel_mps2_rthz +
                              by_gyro_m2ps * gyro_radps_rthz * gyro_radps_rthz;
  return std::max(0.0, power_m2 - explained_m2) / (shown_share * shown_share);
}

}  // namespace sonopose::estimation::kalman
