#include <sonopose/estimation/kalman/slow_error.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace sonopose::estimation::kalman {

void SlowErrorDetector::add(TimeNs time_ns, const Vector3d& innovation_world_m,
                            const Eigen::Matrix3d& fix_covariance_m2, bool moves) {
  constexpr double mean_memory_s = 0.3;
  constexpr double power_memory_s = 5.0;
  constexpr double max_interval_s = 1.0;
  const double dt_s = std::clamp(seconds_between(seen_ns, time_ns), 0.0, max_interval_s);
  const auto gain = [dt_s](double memory_s) { return 1.0 - std::exp(-dt_s / memory_s); };
  const Eigen::Matrix3d information = fix_covariance_m2.inverse();
  noise_m2 = 3.0 / information.trace();
  if (moves) {
    const double product_m2 = innovation_world_m.dot(information * mean_world_m) / information.trace();
    power_m2 += gain(power_memory_s) * (product_m2 - power_m2);
  }
  mean_world_m += gain(mean_memory_s) * (innovation_world_m - mean_world_m);
  seen_ns = time_ns;
}

double SlowErrorDetector::variance_m2(double accel_mps2_rthz, double gyro_radps_rthz) const {
  constexpr double shown_share = 1.0 / 3.0;  // of the error, in the innovations
  constexpr double by_chance = 0.05;         // power of white noise, over its variance
  constexpr double by_accel_s3 = 0.2;        // power by noise of the IMU, over its spectral density
  constexpr double by_gyro_m2ps = 60.0;
  const double explained_m2 = by_chance * noise_m2 + by_accel_s3 * accel_mps2_rthz * accel_mps2_rthz +
                              by_gyro_m2ps * gyro_radps_rthz * gyro_radps_rthz;
  return std::max(0.0, power_m2 - explained_m2) / (shown_share * shown_share);
}

}  // namespace sonopose::estimation::kalman
