#include "calibration/drive/start.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numbers>

namespace sonopose::calibration::drive::detail {
namespace {

constexpr int mounts = 24;
constexpr int delays_to_each_side = 3;
constexpr double delay_step_s = 0.05;
constexpr double soft_gate = 9.0;  // above it a measurement counts with a larger noise

Parameters coarse_parameters() {
  return {.fix_horizontal_m = 0.05,
          .fix_vertical_m = 0.05,
          .heading_rad = 0.1,
          .accel_mps2_rthz = 0.02,
          .gyro_radps_rthz = 2e-3};
}

double angle_of(std::ptrdiff_t mount) {
  return static_cast<double>(mount) * 2.0 * std::numbers::pi / mounts;
}

/// −2 log L for an angle, which is the mount or, for a log without headings, the yaw at the start.
double coarse_minus_2_log_l(const Measurements& log, double angle_rad, double delay_s) {
  Parameters parameters = coarse_parameters();
  parameters.delay_s = delay_s;
  parameters.mount_rad = parameters.start_yaw_rad = angle_rad;
  return forward_pass(log, parameters, {.soft_gate = soft_gate}).minus_2_log_l;
}

}  // namespace

StartYaw best_start_yaw(const Measurements& log, double delay_s) {
  StartYaw best{0.0, std::numeric_limits<double>::infinity()};
  for (int direction = 0; direction < mounts; ++direction) {
    const double yaw_rad = angle_of(direction);
    const double minus_2_log_l = coarse_minus_2_log_l(log, yaw_rad, delay_s);
    if (minus_2_log_l < best.minus_2_log_l) best = {yaw_rad, minus_2_log_l};
  }
  return best;
}

Start grid_search(const std::vector<Measurements>& logs) {
  Start best;
  double min_of_all = std::numeric_limits<double>::infinity();
  for (int delay = -delays_to_each_side; delay <= delays_to_each_side; ++delay) {
    const double delay_s = delay_step_s * delay;
    std::array<double, mounts> sums{};  // sums over the logs with headings
    std::vector<double> best_yaw_rad(logs.size(), 0.0);
    double others = 0;
    for (std::size_t log = 0; log < logs.size(); ++log) {
      if (!logs[log].has_heading()) {
        const StartYaw best_of_log = best_start_yaw(logs[log], delay_s);
        best_yaw_rad[log] = best_of_log.yaw_rad;
        others += best_of_log.minus_2_log_l;
        continue;
      }
      for (int mount = 0; mount < mounts; ++mount) {
        sums[static_cast<std::size_t>(mount)] += coarse_minus_2_log_l(logs[log], angle_of(mount), delay_s);
      }
    }
    const auto best_mount = std::min_element(sums.begin(), sums.end());
    if (!(*best_mount + others < min_of_all)) continue;
    min_of_all = *best_mount + others;
    best = {coarse_parameters(), best_yaw_rad};
    best.parameters.delay_s = delay_s;
    best.parameters.mount_rad = angle_of(best_mount - sums.begin());
  }
  return best;
}

void reject_outliers(std::vector<Measurements>& logs, const Start& start) {
  constexpr double max_squared_norm = 25.0;  // largest squared norm
  for (std::size_t log = 0; log < logs.size(); ++log) {
    Parameters parameters = start.parameters;
    parameters.start_yaw_rad = start.start_yaw_rad[log];
    const Pass pass = forward_pass(logs[log], parameters, {.soft_gate = soft_gate});
    for (const Residual& residual : pass.residuals) {
      if (residual.squared_norm < max_squared_norm) continue;
      if (residual.is_heading) {
        logs[log].headings[residual.index].used = false;
      } else {
        logs[log].fixes[residual.index].used = false;
      }
    }
  }
}

}  // namespace sonopose::calibration::drive::detail
