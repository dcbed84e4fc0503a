#include "calibration/drive/likelihood.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::calibration::drive::detail {
namespace {

using namespace estimation::kalman;

constexpr double square(double x) {
  return x * x;
}

/// Time after which the filter has found velocity and tilt.
constexpr double settling_s = 2.5;
/// Deviation before any measurement: mobile beacons and their IMU are near each other on one vehicle.
constexpr double lever_arm_std_m = 0.2;

/// One filter on its way through a piece of a log.
class PieceFilter {
public:
  PieceFilter(const Measurements& piece, const Parameters& parameters, const PassOptions& options)
      : piece_(piece),
        parameters_(parameters),
        options_(options),
        noise_{.accel_mps2_rthz = parameters.accel_mps2_rthz, .gyro_radps_rthz = parameters.gyro_radps_rthz},
        counted_from_ns_(piece.imu.front().time_ns + to_ns(margin_s + settling_s)) {
    fix_covariance_m2_ = Vector3d(square(parameters.fix_horizontal_m), square(parameters.fix_horizontal_m),
                                  square(parameters.fix_vertical_m))
                             .asDiagonal();
  }

  /// A piece may begin in a curve, where the accelerometer shows a wrong tilt. The corrections of the first
  /// seconds show the right one, from which the filter starts again.
  Pass run() {
    constexpr int tilt_rounds = 2;
    Vector3d up_body = mean_force_at_start();
    for (int round = 0; round < tilt_rounds; ++round) {
      start(up_body);
      add_before(counted_from_ns_);
      up_body = geometry::up_in_body((turned_world_ * start_attitude_).normalized());
    }
    start(up_body);
    add_before(std::numeric_limits<TimeNs>::max());
    pass_.lever_arm = {filter_.lever_arm_body_m, filter_.covariance.block<3, 3>(at_lever_arm, at_lever_arm)};
    return std::move(pass_);
  }

private:
  [[nodiscard]] Vector3d mean_force_at_start() const {
    constexpr double levelling_s = 0.5;
    Vector3d force = Vector3d::Zero();
    for (const ImuMeasurement& imu : piece_.imu) {
      if (seconds_between(piece_.imu.front().time_ns, imu.time_ns) > levelling_s) break;
      force += imu.force_body_mps2;
    }
    return force;
  }

  /// Starts with this tilt, at the first fix, in the direction of the first heading.
  void start(const Vector3d& up_body) {
    filter_ = Filter{};
    turned_world_.setIdentity();
    next_ = 1;
    fix_ = piece_.fixes.begin();
    heading_ = piece_.headings.begin();
    double yaw_rad = parameters_.start_yaw_rad;
    double yaw_std_rad = 1e-3;
    if (const auto* heading = first_used(piece_.headings)) {
      yaw_rad = heading->heading_world_rad - parameters_.mount_rad;
      yaw_std_rad = 3.0 * parameters_.heading_rad + 0.05;
    }
    filter_.q_body_to_world = start_attitude_ = geometry::level_with(up_body, yaw_rad);
    filter_.lever_arm_body_m = options_.lever_arm_m;
    if (const auto* fix = first_used(piece_.fixes)) {
      filter_.position_world_m = fix->position_world_m + filter_.q_body_to_world * filter_.lever_arm_body_m;
    }
    auto variances = filter_.covariance.diagonal();
    variances.segment<3>(at_position).setConstant(square(0.5));
    variances.segment<3>(at_velocity).setConstant(square(3.0));
    variances.segment<3>(at_attitude).setConstant(square(0.05));
    variances.segment<3>(at_gyro_bias).setConstant(square(start_gyro_bias_std_radps));
    variances.segment<3>(at_accel_bias).setConstant(square(start_accel_bias_std_mps2));
    variances.segment<3>(at_lever_arm).setConstant(square(lever_arm_std_m));
    filter_.add_yaw_variance(square(yaw_std_rad));
    time_ns_ = piece_.imu.front().time_ns;
  }

  /// Adds the fixes and headings that are stamped before this.
  void add_before(TimeNs end_ns) {
    constexpr TimeNs never_ns = std::numeric_limits<TimeNs>::max();
    while (true) {
      const TimeNs fix_ns = fix_ == piece_.fixes.end() ? never_ns : fix_->time_ns;
      const TimeNs heading_ns = heading_ == piece_.headings.end() ? never_ns : heading_->time_ns;
      if (std::min(fix_ns, heading_ns) >= end_ns) return;
      if (fix_ns <= heading_ns) {
        if (fix_->used) add(*fix_);
        ++fix_;
      } else {
        if (heading_->used) add(*heading_);
        ++heading_;
      }
    }
  }

  template <class Measurement>
  static const Measurement* first_used(const std::vector<Measurement>& all) {
    const auto first =
        std::find_if(all.begin(), all.end(), [](const Measurement& each) { return each.used; });
    return first == all.end() ? nullptr : &*first;
  }

  /// Integrates to a time between two samples, so that the likelihood is a smooth function of the delay.
  void integrate_to(TimeNs until_ns) {
    while (time_ns_ < until_ns && next_ < piece_.imu.size()) {
      const ImuMeasurement& before = piece_.imu[next_ - 1];
      const ImuMeasurement& after = piece_.imu[next_];
      const TimeNs end_ns = std::min(after.time_ns, until_ns);
      const double dt_s = seconds_between(time_ns_, end_ns);
      const double span_s = seconds_between(before.time_ns, after.time_ns);
      if (after.is_mean) {
        filter_.predict(after.rate_body_radps, after.force_body_mps2, dt_s);
      } else {
        const double share = (seconds_between(before.time_ns, time_ns_) + 0.5 * dt_s) / span_s;
        filter_.predict(before.rate_body_radps + share * (after.rate_body_radps - before.rate_body_radps),
                        before.force_body_mps2 + share * (after.force_body_mps2 - before.force_body_mps2),
                        dt_s);
      }
      time_ns_ = end_ns;
      if (end_ns == after.time_ns) ++next_;
    }
    filter_.propagate(noise_);
  }

  void add(const Fix& fix) {
    integrate_to(fix.time_ns - to_ns(parameters_.delay_s));
    Innovation innovation = filter_.fix_innovation(fix.position_world_m, fix_covariance_m2_, 0.0);
    Eigen::Matrix3d more_m2 = Eigen::Matrix3d::Zero();
    if (options_.soft_gate > 0.0 && innovation.squared_norm > options_.soft_gate) {
      more_m2 = (innovation.squared_norm / options_.soft_gate - 1.0) * innovation.covariance_m2;
    }
    Residual residual{.value = innovation.value_world_m,
                      .covariance = innovation.covariance_m2 + more_m2,
                      .index = static_cast<std::size_t>(&fix - piece_.fixes.data()),
                      .squared_norm = innovation.squared_norm};
    corrected([&] { filter_.correct_fix(innovation, more_m2); });
    const Eigen::LLT<Eigen::Matrix3d> factor(residual.covariance);
    residual.minus_2_log_l = 2.0 * factor.matrixLLT().diagonal().array().log().sum() +
                             factor.matrixL().solve(residual.value).squaredNorm();
    add_residual(residual, fix.time_ns);
  }

  void add(const Heading& heading) {
    integrate_to(heading.time_ns - to_ns(parameters_.delay_s));
    const double variance = square(parameters_.heading_rad);
    const auto innovation =
        filter_.heading_innovation(heading.heading_world_rad, parameters_.mount_rad, variance, 0.0);
    const double squared = square(innovation.value_rad) / innovation.variance_rad2;
    double more = 0.0;
    if (options_.soft_gate > 0.0 && squared > options_.soft_gate) {
      more = (squared / options_.soft_gate - 1.0) * innovation.variance_rad2;
    }
    Residual residual{.value = Vector3d(innovation.value_rad, 0.0, 0.0),
                      .covariance = Eigen::Matrix3d::Identity(),
                      .is_heading = true,
                      .index = static_cast<std::size_t>(&heading - piece_.headings.data()),
                      .squared_norm = squared};
    residual.covariance(0, 0) = innovation.variance_rad2 + more;
    residual.minus_2_log_l =
        std::log(residual.covariance(0, 0)) + square(innovation.value_rad) / residual.covariance(0, 0);
    if (innovation.observable) {
      corrected([&] {
        filter_.correct_heading(heading.heading_world_rad, parameters_.mount_rad, variance + more, 0.0);
      });
    }
    add_residual(residual, heading.time_ns);
  }

  /// Makes a correction and sums up by how much the corrections have turned the attitude.
  template <class Correction>
  void corrected(const Correction& correction) {
    const Eigen::Quaterniond before = filter_.q_body_to_world;
    correction();
    turned_world_ = filter_.q_body_to_world * before.conjugate() * turned_world_;
  }

  void add_residual(const Residual& residual, TimeNs stamp_ns) {
    if (stamp_ns < counted_from_ns_) return;
    pass_.residuals.push_back(residual);
    pass_.minus_2_log_l += residual.minus_2_log_l;
  }

  const Measurements& piece_;
  const Parameters& parameters_;
  const PassOptions& options_;
  ProcessNoise noise_;
  TimeNs counted_from_ns_;
  Eigen::Matrix3d fix_covariance_m2_;
  Filter filter_;
  Eigen::Quaterniond start_attitude_ = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond turned_world_ = Eigen::Quaterniond::Identity();
  TimeNs time_ns_ = 0;
  std::size_t next_ = 1;  ///< index of the next sample
  std::vector<Fix>::const_iterator fix_;
  std::vector<Heading>::const_iterator heading_;
  Pass pass_;
};

}  // namespace

bool Measurements::has_heading() const {
  return std::any_of(headings.begin(), headings.end(), [](const Heading& heading) { return heading.used; });
}

Pass forward_pass(const Measurements& piece, const Parameters& parameters, const PassOptions& options) {
  return PieceFilter(piece, parameters, options).run();
}

}  // namespace sonopose::calibration::drive::detail
