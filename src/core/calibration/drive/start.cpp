#include "calibration/drive/start.hpp"

#include "calibration/drive/pieces.hpp"
#include <sonopose/statistics/quantile.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

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

/// −2 log L of so many residuals.
struct Likelihood {
  double minus_2_log_l = 0;
  std::size_t residuals = 0;

  Likelihood& operator+=(const Likelihood& other) {
    minus_2_log_l += other.minus_2_log_l;
    residuals += other.residuals;
    return *this;
  }
  bool operator<(const Likelihood& other) const { return minus_2_log_l < other.minus_2_log_l; }
};

/// Likelihood of every `stride`th angle, which is the mount or, for a log without headings, the yaw at the
/// start. The others get none.
std::array<Likelihood, mounts> coarse_likelihoods(const Measurements& log, double delay_s, int stride = 1) {
  std::array<Likelihood, mounts> all;
  all.fill({.minus_2_log_l = std::numeric_limits<double>::infinity()});
  for (int angle = 0; angle < mounts; angle += stride) {
    Parameters parameters = coarse_parameters();
    parameters.delay_s = delay_s;
    parameters.mount_rad = parameters.start_yaw_rad = angle_of(angle);
    const Pass pass = forward_pass(log, parameters, {.soft_gate = soft_gate});
    all[static_cast<std::size_t>(angle)] = {pass.minus_2_log_l, pass.residuals.size()};
  }
  return all;
}

/// Most probable mount, or yaws at the start, at one delay.
struct Candidate {
  Start start;
  Likelihood likelihood;
};

Candidate best_at(const std::vector<Measurements>& logs, double delay_s, int stride = 1) {
  Candidate best;
  best.start = {coarse_parameters(), std::vector<double>(logs.size(), 0.0)};
  best.start.parameters.delay_s = delay_s;
  std::array<Likelihood, mounts> sums{};  // sums over the logs with headings
  for (std::size_t log = 0; log < logs.size(); ++log) {
    const auto each = coarse_likelihoods(logs[log], delay_s, stride);
    if (logs[log].has_heading()) {
      for (std::size_t mount = 0; mount < sums.size(); ++mount) sums.at(mount) += each.at(mount);
    } else {
      const auto best_yaw = std::min_element(each.begin(), each.end());
      best.start.start_yaw_rad[log] = angle_of(best_yaw - each.begin());
      best.likelihood += *best_yaw;
    }
  }
  const auto best_mount = std::min_element(sums.begin(), sums.end());
  best.start.parameters.mount_rad = angle_of(best_mount - sums.begin());
  best.likelihood += *best_mount;
  return best;
}

/// Flag of the fix or heading of a residual.
bool& used_flag(Measurements& log, const Residual& residual) {
  return residual.is_heading ? log.headings[residual.index].used : log.fixes[residual.index].used;
}

}  // namespace

double best_start_yaw_rad(const Measurements& log, double delay_s) {
  const auto each = coarse_likelihoods(log, delay_s);
  return angle_of(std::min_element(each.begin(), each.end()) - each.begin());
}

Start grid_search(const std::vector<Measurements>& logs) {
  std::optional<Candidate> best;
  for (int delay = -delays_to_each_side; delay <= delays_to_each_side; ++delay) {
    const Candidate candidate = best_at(logs, delay_step_s * delay);
    if (!best || candidate.likelihood < best->likelihood) best = candidate;
  }
  return best->start;
}

double coarse_delay_s(const std::vector<Measurements>& logs, const std::function<void(int step)>& observer) {
  // The search that follows covers less than a step to each side, and all mounts.
  constexpr double step_s = 0.2;
  const int steps_to_each_side = static_cast<int>(std::lround(max_clock_offset_s / step_s));
  constexpr int stride = 2;
  double best_s = 0;
  double best_mean = std::numeric_limits<double>::infinity();
  for (int step = 0; step <= 2 * steps_to_each_side; ++step) {
    observer(step);
    // The nearest first: a periodic motion looks the same after a period.
    const double delay_s = step_s * (step % 2 == 0 ? -step / 2 : (step + 1) / 2);
    std::vector<Measurements> pieces;
    for (const Measurements& log : logs) append_pieces(set_back(log, delay_s), pieces);
    const Likelihood found = best_at(pieces, 0.0, stride).likelihood;
    if (found.residuals == 0) continue;
    // Other fixes fall into the silences of the IMU, so the numbers of residuals differ.
    const double mean = found.minus_2_log_l / static_cast<double>(found.residuals);
    if (!(mean < best_mean)) continue;
    best_mean = mean;
    best_s = delay_s;
  }
  return best_s;
}

void reject_outliers(std::vector<Measurements>& logs, const Start& start) {
  constexpr double max_squared_norm = 25.0;  // largest squared norm
  for (std::size_t log = 0; log < logs.size(); ++log) {
    Parameters parameters = start.parameters;
    parameters.start_yaw_rad = start.start_yaw_rad[log];
    const Pass pass = forward_pass(logs[log], parameters, {.soft_gate = soft_gate});
    for (const Residual& residual : pass.residuals) {
      if (residual.squared_norm < max_squared_norm) continue;
      used_flag(logs[log], residual) = false;
    }
  }
}

bool reject_tail(std::vector<Measurements>& logs, const std::vector<Pass>& passes) {
  constexpr double max_squared_norm = 25.0;               // of the usual one, which outliers do not change
  constexpr double min_limit = 9.0;                       // a body that mostly stands still has small ones
  constexpr std::size_t max_share = 5;                    // more than a fifth are no outliers
  constexpr std::array<double, 2> medians{2.366, 0.455};  // of chi-squared: of fixes, of headings
  std::array<std::vector<double>, 2> squared_norms;
  for (const Pass& pass : passes) {
    for (const Residual& residual : pass.residuals) {
      squared_norms.at(residual.is_heading ? 1 : 0).push_back(residual.squared_norm);
    }
  }
  std::array<double, 2> limits{};
  for (std::size_t kind = 0; kind < limits.size(); ++kind) {
    const std::vector<double>& all = squared_norms.at(kind);
    double& limit = limits.at(kind);
    limit = std::max(min_limit, max_squared_norm * statistics::quantile(all, 0.5) / medians.at(kind));
    const auto count = std::ranges::count_if(all, [limit](double each) { return each >= limit; });
    if (max_share * static_cast<std::size_t>(count) > all.size()) {
      limit = std::numeric_limits<double>::infinity();
    }
  }
  bool is_any = false;
  for (std::size_t log = 0; log < logs.size(); ++log) {
    const std::vector<Heading> headings = logs[log].headings;
    bool is_any_heading = false;
    for (const Residual& residual : passes[log].residuals) {
      if (residual.squared_norm < limits.at(residual.is_heading ? 1 : 0)) continue;
      used_flag(logs[log], residual) = false;
      (residual.is_heading ? is_any_heading : is_any) = true;
    }
    if (!logs[log].has_heading()) {  // without any, its yaw is another unknown
      logs[log].headings = headings;
      is_any_heading = false;
    }
    is_any = is_any || is_any_heading;
  }
  return is_any;
}

}  // namespace sonopose::calibration::drive::detail
