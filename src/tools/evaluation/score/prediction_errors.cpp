#include "evaluation/score/prediction_errors.hpp"

#include <sonopose/estimation/aiding/delay.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/statistics/quantile.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace sonopose::evaluation {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr TimeNs remembered_ns = 3'000'000'000;  // longer than any delay of a fix
constexpr double max_gap_s = 0.1;      // limit between poses, and from the last one to a measurement
constexpr double min_speed_mps = 0.1;  // lower speeds give the track no direction

SignedErrors signed_errors_of(const std::vector<double>& errors) {
  if (errors.empty()) return {unknown, unknown};
  double sum = 0.0;
  double squares = 0.0;
  for (const double error : errors) {
    sum += error;
    squares += error * error;
  }
  const auto count = static_cast<double>(errors.size());
  return {sum / count, std::sqrt(squares / count)};
}

/// Returns NaN if there are no values.
double quantile(const std::vector<double>& values, double share) {
  return values.empty() ? unknown : statistics::quantile(values, share);
}

/// Returns Σ eₖ·eₖ₋₁ / Σ eₖ², for numbers or vectors; NaN if there are fewer than two.
template <class Error, class Dot>
double lag_one_of(const std::vector<Error>& errors, const Dot& dot) {
  if (errors.size() < 2) return unknown;
  double squares = dot(errors.front(), errors.front());
  double products = 0.0;
  for (std::size_t i = 1; i < errors.size(); ++i) {
    squares += dot(errors[i], errors[i]);
    products += dot(errors[i], errors[i - 1]);
  }
  return squares > 0.0 ? products / squares : unknown;
}

PredictedQuantity quantity_of(const std::vector<double>& errors) {
  std::vector<double> sizes;
  for (const double error : errors) sizes.push_back(std::abs(error));
  return {errors.size(), signed_errors_of(errors), quantile(sizes, 0.5), quantile(sizes, 0.95),
          lag_one_of(errors, [](double a, double b) { return a * b; })};
}

/// Returns the mean of squares per degree of freedom, and the band in which it is expected. Each square has
/// `freedom_of_each` degrees. Empty if there are no squares.
std::optional<NormalisedInnovations> normalised(const std::vector<double>& squares, double freedom_of_each) {
  if (squares.empty()) return std::nullopt;
  double sum = 0.0;
  for (const double square : squares) sum += square;
  const double freedom = freedom_of_each * static_cast<double>(squares.size());
  const double half_width = 1.96 * std::sqrt(2.0 / freedom);
  return NormalisedInnovations{squares.size(), sum / freedom, 1.0 - half_width, 1.0 + half_width};
}

bool is_trusted(const FixReport& report) {
  return (report.flags & fix_used) != 0 && (report.flags & fix_outlier) == 0;
}

}  // namespace

double cost_of(const PredictionScore& score, const PredictionScore& reference) {
  std::unordered_map<TimeNs, double> squares_m2;
  for (const FixError& fix : score.fixes) squares_m2[fix.emission_time_ns] = fix.error_world_m.squaredNorm();
  double sum_m2 = 0.0;
  std::size_t count = 0;
  for (const FixError& fix : reference.fixes) {
    const auto found = squares_m2.find(fix.emission_time_ns);
    if (!fix.trusted || found == squares_m2.end()) continue;
    sum_m2 += found->second;
    ++count;
  }
  return count == 0 ? unknown : std::sqrt(sum_m2 / static_cast<double>(count));
}

PredictionErrors::PredictionErrors(TimeNs from_ns, const settings::Settings& settings,
                                   std::span<const recording::WheelSpeed> wheel_speeds)
    : from_ns_(from_ns),
      mount_offset_rad_(settings.heading.mount_offset_deg * geometry::radians_per_degree),
      delay_(settings.delay),
      wheel_speeds_(wheel_speeds) {}

void PredictionErrors::add(const Event& event, const std::optional<ScalarEstimate>& heading_noise_rad) {
  if (const auto* fix = std::get_if<UltrasonicFix>(&event)) compare(*fix);
  if (const auto* heading = std::get_if<PairHeading>(&event)) compare(*heading, heading_noise_rad);
}

void PredictionErrors::add(const Event& event, const estimation::AnyEstimator& estimator) {
  add(event,
      std::holds_alternative<PairHeading>(event) ? estimator.estimate().heading_noise_rad : std::nullopt);
}

void PredictionErrors::add(const estimation::EventResult& result) {
  if (const auto* pose = std::get_if<FusedPose>(&result)) keep(*pose);
  if (const auto* report = std::get_if<FixReport>(&result)) keep(*report);
}

/// Interpolates between two poses; shortly after the last one, extrapolates by its velocity.
std::optional<PredictionErrors::Predicted> PredictionErrors::at(TimeNs time_ns) const {
  if (poses_.empty()) return std::nullopt;
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), time_ns,
                                      [](const Predicted& pose, TimeNs time) { return pose.time_ns < time; });
  if (after == poses_.end()) {
    Predicted last = poses_.back();
    const double since_s = seconds_between(last.time_ns, time_ns);
    if (since_s > max_gap_s) return std::nullopt;
    last.position_world_m += since_s * last.velocity_world_mps;
    return last;
  }
  if (after->time_ns == time_ns) return *after;
  if (after == poses_.begin()) return std::nullopt;
  const Predicted& before = *std::prev(after);
  const double span_s = seconds_between(before.time_ns, after->time_ns);
  if (span_s > max_gap_s) return std::nullopt;
  const double share = seconds_between(before.time_ns, time_ns) / span_s;
  return Predicted{
      time_ns, before.position_world_m + share * (after->position_world_m - before.position_world_m),
      before.velocity_world_mps + share * (after->velocity_world_mps - before.velocity_world_mps),
      before.q_body_to_world.slerp(share, after->q_body_to_world), after->yaw_std_rad};
}

void PredictionErrors::keep(const FusedPose& pose) {
  if ((pose.status & status_initialising) != 0) return;
  // A stamp that goes back shows that the previous ones were wrong.
  while (!poses_.empty() && poses_.back().time_ns >= pose.time_ns) poses_.pop_back();
  poses_.push_back({pose.time_ns, pose.position_world_m, pose.velocity_world_mps, pose.q_body_to_world,
                    yaw_std_rad(pose)});
  while (poses_.front().time_ns < pose.time_ns - remembered_ns) poses_.pop_front();
  compare_wheel_speeds(pose.time_ns);
}

void PredictionErrors::compare_wheel_speeds(TimeNs until_ns) {
  for (; !wheel_speeds_.empty() && wheel_speeds_.front().time_ns <= until_ns;
       wheel_speeds_ = wheel_speeds_.subspan(1)) {
    const recording::WheelSpeed& wheel = wheel_speeds_.front();
    const auto predicted = at(wheel.time_ns);
    if (wheel.time_ns < from_ns_ || !predicted) continue;
    wheel_speed_mps_.push_back(std::abs(wheel.speed_mps) - predicted->velocity_world_mps.head<2>().norm());
  }
}

void PredictionErrors::compare(const UltrasonicFix& fix) {
  if (fix.emission_time_ns < from_ns_ || !fix.position_world_m.allFinite()) return;
  const auto predicted = at(estimation::aiding::measured_at(delay_, fix));
  if (!predicted) {
    ++without_;
    return;
  }
  const Vector3d predicted_world_m =
      predicted->position_world_m + predicted->q_body_to_world * fix.point_body_m;
  fixes_.push_back(
      {fix.emission_time_ns, fix.position_world_m - predicted_world_m, predicted->velocity_world_mps});
}

void PredictionErrors::compare(const PairHeading& heading, const std::optional<ScalarEstimate>& noise_rad) {
  if (!heading.valid || heading.emission_time_ns < from_ns_) return;
  const auto predicted = at(estimation::aiding::measured_at(delay_, heading));
  if (!predicted) return;
  const double mount_rad = (heading.flags & heading_flag_of_body) != 0 ? 0.0 : mount_offset_rad_;
  const double error_rad = geometry::wrap_angle(heading.heading_world_rad - mount_rad -
                                                geometry::yaw_of(predicted->q_body_to_world));
  heading_rad_.push_back(error_rad);
  if (!noise_rad) return;
  const double normalised_error = error_rad / std::hypot(predicted->yaw_std_rad, noise_rad->value);
  if (!std::isfinite(normalised_error)) return;
  squared_heading_innovations_.push_back(normalised_error * normalised_error);
}

void PredictionErrors::keep(const FixReport& report) {
  if (report.emission_time_ns < from_ns_) return;
  ++reports_;
  if ((report.flags & fix_outlier) != 0) ++gated_;
  if (!is_trusted(report)) return;
  if (!fixes_.empty() && fixes_.back().emission_time_ns == report.emission_time_ns) {
    fixes_.back().trusted = true;
  }
  innovations_world_m_.push_back(report.innovation_world_m);
  if (!report.innovation_covariance_m2) return;
  const Eigen::LLT<Eigen::Matrix3d> covariance(report.innovation_covariance_m2->matrix());
  if (covariance.info() != Eigen::Success) return;
  squared_innovations_.push_back(report.innovation_world_m.dot(covariance.solve(report.innovation_world_m)));
}

PredictionScore PredictionErrors::score() const {
  std::vector<double> distances_m;
  std::vector<double> along_m;
  std::vector<double> left_m;
  std::vector<double> up_m;
  for (const FixError& fix : fixes_) {
    distances_m.push_back(fix.error_world_m.norm());
    if (!fix.trusted) continue;
    up_m.push_back(fix.error_world_m.z());
    const Eigen::Vector2d velocity_mps = fix.velocity_world_mps.head<2>();
    if (velocity_mps.norm() < min_speed_mps) continue;
    const Eigen::Vector2d along = velocity_mps.normalized();
    along_m.push_back(along.dot(fix.error_world_m.head<2>()));
    left_m.push_back(along.x() * fix.error_world_m.y() - along.y() * fix.error_world_m.x());
  }
  const auto dot = [](const Vector3d& a, const Vector3d& b) { return a.dot(b); };
  return {
      .fixes = fixes_,
      .fixes_without = without_,
      .distance_m = error_summary_of(distances_m),
      .distance_p50_m = quantile(distances_m, 0.5),
      .along_m = signed_errors_of(along_m),
      .left_m = signed_errors_of(left_m),
      .up_m = signed_errors_of(up_m),
      .lag_one = lag_one_of(innovations_world_m_, dot),
      .gated_share = reports_ == 0 ? unknown : static_cast<double>(gated_) / static_cast<double>(reports_),
      .innovations = normalised(squared_innovations_, 3.0),
      .heading_rad = quantity_of(heading_rad_),
      .heading_innovations = normalised(squared_heading_innovations_, 1.0),
      .wheel_speed_mps = quantity_of(wheel_speed_mps_)};
}

}  // namespace sonopose::evaluation
