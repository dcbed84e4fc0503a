#include "motion/fit/segment_fit.hpp"

#include "motion/fit/integral.hpp"
#include <sonopose/geometry/cross_matrix.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace sonopose::motion::fit::detail {
namespace {

constexpr int at_position = 0;
constexpr int at_velocity = 3;
constexpr int at_attitude = 6;  // a rotation about world axes
constexpr int at_gyro_bias = 9;
constexpr int at_accel_bias = 12;
constexpr int at_lever_arm = 15;
constexpr int at_delay = 18;
constexpr int at_mount = 19;
constexpr int at_map_scale = 20;
constexpr int unknowns = 21;
using Unknowns = Eigen::Matrix<double, unknowns, 1>;
using Normal = Eigen::Matrix<double, unknowns, unknowns>;
using Row = Eigen::Matrix<double, 3, unknowns>;
using Stacked = Eigen::Matrix<double, Eigen::Dynamic, unknowns>;

// Standard deviations before any measurement, for an uncalibrated MEMS sensor and a usual installation.
constexpr double gyro_bias_std_radps = 0.015;
constexpr double accel_bias_std_mps2 = 0.1;
constexpr double lever_arm_std_m = 0.1;
constexpr double map_scale_std = 0.3;
/// Least noise of good fixes; it also covers the noise of the integrated IMU.
constexpr double min_noise_m = 0.02;
/// Least noise of a heading of a pair.
constexpr double min_heading_noise_rad = 1.5 * geometry::radians_per_degree;
/// Cauchy weight: a residual of this many standard deviations has half the weight.
constexpr double tuning = 2.4;
constexpr double normal_median = 0.6745;  // median of |x| for a standard normal x

struct Estimate {
  Vector3d position_world_m = Vector3d::Zero();
  Vector3d velocity_world_mps = Vector3d::Zero();
  Eigen::Quaterniond q_start_to_world = Eigen::Quaterniond::Identity();
  Vector3d gyro_bias_radps = Vector3d::Zero();
  Vector3d accel_bias_mps2 = Vector3d::Zero();
  Vector3d lever_arm_body_m = Vector3d::Zero();
  double delay_s = 0;
  double mount_rad = 0;
  double map_scale = 1;  ///< distance by the fixes over that by the IMU
};

/// Negative logarithm of a Cauchy distribution of a residual in standard deviations; near zero that of a
/// normal one.
double cost_of(double squared) {
  return 0.5 * tuning * tuning * std::log1p(squared / (tuning * tuning));
}

double cauchy_weight(double squared) {
  return 1.0 / (1.0 + squared / (tuning * tuning));
}

/// Median of some values, which it reorders.
double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Standard deviation of white noise with which a mean would be as uncertain as with these residuals. Errors
/// that persist, as those of a compass near iron, count less than as many independent ones.
double persistent_noise_of(const std::vector<double>& residuals) {
  double squares = 0;
  double products = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    squares += residuals[i] * residuals[i];
    if (i > 0) products += residuals[i] * residuals[i - 1];
  }
  if (!(squares > 0.0)) return 0.0;
  const double correlation = std::clamp(products / squares, 0.0, 0.99);
  return std::sqrt(squares / static_cast<double>(residuals.size()) * (1.0 + correlation) /
                   (1.0 - correlation));
}

class Solver {
public:
  Solver(const Segment& segment, Vector3d signs, const Freedom& freedom)
      : segment_(segment), freedom_(freedom), integral_(segment.imu, std::move(signs)) {}

  /// A solver that keeps the mount and takes the yaw of the start from the headings.
  Solver(const Segment& segment, double mount_rad)
      : segment_(segment), known_mount_rad_(mount_rad), integral_(segment.imu, Vector3d::Ones()) {}

  /// Estimate after some steps from a level start with this yaw, with its cost.
  std::optional<std::pair<double, Estimate>> begin(double yaw_rad, int steps) {
    start(yaw_rad);
    if (!iterate(steps)) return std::nullopt;
    return std::pair(cost(), estimate_);
  }

  /// Iterates from an estimate until it no longer changes.
  std::optional<SegmentFit> finish(const Estimate& from) {
    constexpr int max_steps = 40;
    estimate_ = from;
    integral_.set_biases(estimate_.gyro_bias_radps, estimate_.accel_bias_mps2);
    evaluate();
    if (!iterate(max_steps)) return std::nullopt;
    return result();
  }

private:
  /// Returns false if it fails.
  bool iterate(int max_steps) {
    constexpr double small = 1e-5;  // m, m/s, rad …
    double change = 1.0;
    for (int step = 0; step < max_steps && change > small; ++step) {
      change = improve();
      if (!std::isfinite(change)) return false;
    }
    return true;
  }

  void start(double yaw_rad) {
    estimate_ = {};
    integral_.set_biases(estimate_.gyro_bias_radps, estimate_.accel_bias_mps2);
    estimate_.q_start_to_world = geometry::level_with(integral_.at_end().velocity_mps, yaw_rad);
    start_position_and_velocity();
    evaluate();
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const double angle_rad : heading_residuals_) {
      sum += Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
    }
    const double turn_rad = std::atan2(sum.y(), sum.x());
    if (known_mount_rad_) {
      estimate_.mount_rad = *known_mount_rad_;
      estimate_.q_start_to_world =
          geometry::rotation_about_z(turn_rad - *known_mount_rad_) * estimate_.q_start_to_world;
    } else {
      estimate_.mount_rad = turn_rad;
    }
    evaluate();
  }

  /// Starts from the line through the fixes, by medians of slopes and offsets, which outliers do not move.
  void start_position_and_velocity() {
    const std::size_t half = segment_.fixes.size() / 2;
    std::vector<double> values;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      values.clear();
      for (std::size_t i = half; i < segment_.fixes.size(); ++i) {
        const Position& before = segment_.fixes[i - half];
        values.push_back((segment_.fixes[i].position_world_m(axis) - before.position_world_m(axis)) /
                         seconds_between(before.time_ns, segment_.fixes[i].time_ns));
      }
      const double slope_mps = median_of(values);
      values.clear();
      for (const Position& fix : segment_.fixes) {
        values.push_back(fix.position_world_m(axis) - slope_mps * time_of(fix.time_ns));
      }
      estimate_.velocity_world_mps(axis) = slope_mps;
      estimate_.position_world_m(axis) = median_of(values);
    }
  }

  [[nodiscard]] double time_of(TimeNs measured_ns) const {
    return seconds_between(segment_.imu.front().time_ns, measured_ns) - estimate_.delay_s;
  }

  void evaluate() {
    evaluate_fixes();
    evaluate_headings();
  }

  /// Evaluates residuals, derivatives and the noise of the fixes at the estimate.
  void evaluate_fixes() {
    const Vector3d gravity(0, 0, -standard_gravity_mps2);
    const Eigen::Matrix3d to_world = estimate_.q_start_to_world.toRotationMatrix();
    const double scale = estimate_.map_scale;
    rows_.clear();
    residuals_.clear();
    for (const Position& fix : segment_.fixes) {
      const double time_s = time_of(fix.time_ns);
      const IntegralState state = integral_.at(time_s);
      const Eigen::Matrix3d body_to_world = to_world * state.q_body_to_start.toRotationMatrix();
      const Vector3d moved = to_world * state.position_m;
      const Vector3d arm = body_to_world * estimate_.lever_arm_body_m;
      const Vector3d velocity =
          estimate_.velocity_world_mps +
          scale * (time_s * gravity + to_world * state.velocity_mps -
                   body_to_world * state.rate_body_radps.cross(estimate_.lever_arm_body_m));
      const Vector3d by_imu = 0.5 * time_s * time_s * gravity + moved - arm;
      residuals_.emplace_back(fix.position_world_m - estimate_.position_world_m -
                              time_s * estimate_.velocity_world_mps - scale * by_imu);
      Row row = Row::Zero();
      row.block<3, 3>(0, at_position).setIdentity();
      row.block<3, 3>(0, at_velocity) = time_s * Eigen::Matrix3d::Identity();
      row.block<3, 3>(0, at_attitude) = scale * geometry::cross_matrix(arm - moved);
      row.block<3, 3>(0, at_gyro_bias) = scale * to_world * state.position_by_gyro;
      row.block<3, 3>(0, at_accel_bias) = scale * to_world * state.position_by_accel;
      row.block<3, 3>(0, at_lever_arm) = -scale * body_to_world;
      row.col(at_delay) = -velocity;
      if (freedom_.is_map_scaled) row.col(at_map_scale) = by_imu;
      rows_.push_back(row);
    }
    std::vector<double> sizes;
    for (const Vector3d& residual : residuals_) {
      for (const double component : residual) sizes.push_back(std::abs(component));
    }
    noise_m_ = std::max(min_noise_m, median_of(sizes) / normal_median);
  }

  /// Evaluates residuals and derivatives of the headings at the estimate.
  void evaluate_headings() {
    heading_rows_.clear();
    heading_residuals_.clear();
    for (const Direction& heading : segment_.headings) {
      const IntegralState state = integral_.at(time_of(heading.time_ns));
      const Eigen::Quaterniond q_body_to_world = estimate_.q_start_to_world * state.q_body_to_start;
      const double predicted_rad =
          geometry::yaw_of(q_body_to_world * geometry::rotation_about_z(estimate_.mount_rad));
      heading_residuals_.push_back(geometry::wrap_angle(heading.heading_world_rad - predicted_rad));
      const Eigen::Matrix3d body_to_world = q_body_to_world.toRotationMatrix();
      Eigen::Matrix<double, 1, unknowns> row = Eigen::Matrix<double, 1, unknowns>::Zero();
      row(at_attitude + 2) = 1.0;
      row.segment<3>(at_gyro_bias) = body_to_world.row(2) * state.attitude_by_gyro;
      row(at_delay) = -body_to_world.row(2).dot(state.rate_body_radps);
      row(at_mount) = known_mount_rad_ ? 0.0 : 1.0;
      heading_rows_.push_back(row);
    }
    heading_noise_rad_ = std::max(min_heading_noise_rad, persistent_noise_of(heading_residuals_));
  }

  [[nodiscard]] double squared(const Vector3d& residual) const {
    return residual.squaredNorm() / (noise_m_ * noise_m_);
  }
  [[nodiscard]] double squared(double heading_residual_rad) const {
    return heading_residual_rad * heading_residual_rad / (heading_noise_rad_ * heading_noise_rad_);
  }

  /// Makes a Gauss–Newton step. Returns its largest change; not finite if it fails.
  double improve() {
    Stacked rows(static_cast<Eigen::Index>(3 * rows_.size() + heading_rows_.size()), unknowns);
    Eigen::VectorXd residuals(rows.rows());
    Eigen::Index next = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i, next += 3) {
      const double w = std::sqrt(cauchy_weight(squared(residuals_[i]))) / noise_m_;
      rows.middleRows<3>(next) = w * rows_[i];
      residuals.segment<3>(next) = w * residuals_[i];
    }
    for (std::size_t i = 0; i < heading_rows_.size(); ++i, ++next) {
      const double w = std::sqrt(cauchy_weight(squared(heading_residuals_[i]))) / heading_noise_rad_;
      rows.row(next) = w * heading_rows_[i];
      residuals(next) = w * heading_residuals_[i];
    }
    Normal normal = Normal::Zero();
    normal.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
    Unknowns right = rows.transpose() * residuals;
    const auto expect = [&](int at, const auto& value, double std) {
      for (Eigen::Index i = 0; i < value.size(); ++i) {
        normal(at + i, at + i) += 1.0 / (std * std);
        right(at + i) -= value(i) / (std * std);
      }
    };
    expect(at_gyro_bias, estimate_.gyro_bias_radps, gyro_bias_std_radps);
    expect(at_accel_bias, estimate_.accel_bias_mps2, accel_bias_std_mps2);
    expect(at_lever_arm, estimate_.lever_arm_body_m, lever_arm_std_m);
    expect(at_delay, Eigen::Matrix<double, 1, 1>(estimate_.delay_s), freedom_.delay_std_s);
    expect(at_map_scale, Eigen::Matrix<double, 1, 1>(estimate_.map_scale - 1.0), map_scale_std);
    normal.diagonal().array() += 1e-9;
    factor_.compute(normal);
    Unknowns change = factor_.solve(right);
    if (!change.allFinite()) return std::numeric_limits<double>::quiet_NaN();
    constexpr double max_turn_rad = 0.5;  // the model is not linear in the attitude
    const double turn_rad = change.segment<3>(at_attitude).norm();
    if (turn_rad > max_turn_rad) change *= max_turn_rad / turn_rad;
    apply(change);
    return change.cwiseAbs().maxCoeff();
  }

  void apply(const Unknowns& change) {
    constexpr double max_delay_s = 0.3;
    constexpr double min_map_scale = 0.2;
    constexpr double max_map_scale = 5.0;
    estimate_.position_world_m += change.segment<3>(at_position);
    estimate_.velocity_world_mps += change.segment<3>(at_velocity);
    const Vector3d turn = change.segment<3>(at_attitude);
    estimate_.q_start_to_world = (geometry::rotation_by(turn) * estimate_.q_start_to_world).normalized();
    estimate_.gyro_bias_radps += change.segment<3>(at_gyro_bias);
    estimate_.accel_bias_mps2 += change.segment<3>(at_accel_bias);
    estimate_.lever_arm_body_m += change.segment<3>(at_lever_arm);
    estimate_.delay_s = std::clamp(estimate_.delay_s + change(at_delay), -max_delay_s, max_delay_s);
    estimate_.mount_rad = geometry::wrap_angle(estimate_.mount_rad + change(at_mount));
    estimate_.map_scale =
        std::clamp(estimate_.map_scale + change(at_map_scale), min_map_scale, max_map_scale);
    integral_.set_biases(estimate_.gyro_bias_radps, estimate_.accel_bias_mps2);
    evaluate();
  }

  [[nodiscard]] double cost() const {
    double cost = 0;
    for (const Vector3d& residual : residuals_) {
      cost += cost_of(residual.squaredNorm() / (min_noise_m * min_noise_m));
    }
    // The least noise, as for the fixes: costs of different fits can only be compared with a common noise.
    for (const double residual : heading_residuals_) {
      cost += cost_of(residual * residual / (min_heading_noise_rad * min_heading_noise_rad));
    }
    const double scale_error = (estimate_.map_scale - 1.0) / map_scale_std;
    return cost + 0.5 * ((estimate_.gyro_bias_radps / gyro_bias_std_radps).squaredNorm() +
                         (estimate_.accel_bias_mps2 / accel_bias_std_mps2).squaredNorm() +
                         (estimate_.lever_arm_body_m / lever_arm_std_m).squaredNorm() +
                         std::pow(estimate_.delay_s / freedom_.delay_std_s, 2) + scale_error * scale_error);
  }

  [[nodiscard]] SegmentFit result() const {
    SegmentFit fit;
    fit.cost = cost();
    double squares = 0;
    for (const double residual : heading_residuals_) squares += residual * residual;
    const Normal covariance = factor_.solve(Normal::Identity());
    fit.residual_m = noise_m_;
    fit.delay_s = estimate_.delay_s;
    fit.delay_std_s = std::sqrt(covariance(at_delay, at_delay));
    fit.mount_rad = estimate_.mount_rad;
    fit.mount_std_rad = std::sqrt(covariance(at_mount, at_mount));
    fit.map_scale = estimate_.map_scale;
    fit.map_scale_std = std::sqrt(covariance(at_map_scale, at_map_scale));
    if (!heading_residuals_.empty()) {
      fit.heading_spread_rad = std::sqrt(squares / static_cast<double>(heading_residuals_.size()));
    }
    fit.upright = geometry::up_in_body(estimate_.q_start_to_world).z() > 0.5;
    fit.deviations_m = residuals_;
    return fit;
  }

  const Segment& segment_;
  Freedom freedom_;
  std::optional<double> known_mount_rad_;
  Integral integral_;
  Estimate estimate_;
  std::vector<Row> rows_;
  std::vector<Vector3d> residuals_;
  std::vector<Eigen::Matrix<double, 1, unknowns>> heading_rows_;
  std::vector<double> heading_residuals_;
  double noise_m_ = min_noise_m;
  double heading_noise_rad_ = min_heading_noise_rad;
  Eigen::LDLT<Normal> factor_;  ///< factorisation of the latest step
};

}  // namespace

std::optional<SegmentFit> fit_segment(const Segment& segment, const Vector3d& signs, const Freedom& freedom) {
  // All starts begin; the best ones continue.
  constexpr int starts = 12;
  constexpr int first_steps = 8;
  constexpr std::size_t finalists = 4;
  Solver solver(segment, signs, freedom);
  std::vector<std::pair<double, Estimate>> begun;
  for (int start = 0; start < starts; ++start) {
    if (auto each = solver.begin(2.0 * std::numbers::pi * start / starts, first_steps)) {
      begun.push_back(*std::move(each));
    }
  }
  std::sort(begun.begin(), begun.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  begun.resize(std::min(begun.size(), finalists));
  std::optional<SegmentFit> best;
  for (const auto& [cost, estimate] : begun) {
    auto fit = solver.finish(estimate);
    if (fit && (!best || fit->cost < best->cost)) best = std::move(fit);
  }
  return best;
}

std::optional<SegmentFit> fit_segment_with_mount(const Segment& segment, double mount_rad) {
  Solver solver(segment, mount_rad);
  const auto begun = solver.begin(0.0, 0);
  return begun ? solver.finish(begun->second) : std::nullopt;
}

}  // namespace sonopose::motion::fit::detail
