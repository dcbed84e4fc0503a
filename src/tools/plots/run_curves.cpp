#include "plots/run_curves.hpp"

#include <sonopose/geometry/rotation.hpp>
#include <sonopose/settings/settings_table.hpp>
#include <sonopose/statistics/quantile.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

namespace sonopose::plots {
namespace {

/// Returns the larger of two errors; either may be NaN (unknown).
double worse(double a, double b) {
  return std::isnan(a) || b > a ? b : a;
}

void merge_moments(Moment& into, const Moment& next) {
  const Moment before = into;
  into = next;
  into.error_m = worse(before.error_m, next.error_m);
  into.last_fix_error_m = worse(before.last_fix_error_m, next.last_fix_error_m);
  into.yaw_std_rad = worse(before.yaw_std_rad, next.yaw_std_rad);
  if (before.position_covariance_m2.trace() > next.position_covariance_m2.trace()) {
    into.position_covariance_m2 = before.position_covariance_m2;
  }
  into.trust = std::min(before.trust, next.trust);
  into.status |= before.status;
}

void merge_fixes(FixMark& into, const FixMark& next) {
  constexpr std::uint32_t ranked_flags = fix_stuck_forced | fix_stale_recovered | fix_first;
  const auto rank = [](const FixMark& fix) {
    const bool is_known = !std::isnan(fix.innovation_m);
    return std::tuple{fix.verdict == FixVerdict::rejected, (fix.flags & ranked_flags) != 0,
                      is_known ? fix.innovation_m : 0.0};
  };
  const std::uint32_t seen_flags = into.seen_flags | next.seen_flags;
  if (rank(next) > rank(into)) into = next;
  into.seen_flags = seen_flags;
}

/// `engine`: its name; empty: that of the settings.
std::string text_of(const settings::Settings& settings, const std::string& engine) {
  std::string text = engine.empty() ? settings::to_text(settings::get(settings, "fusion.engine")) : engine;
  for (const settings::SettingInfo& info : settings::setting_table()) {
    const settings::SettingValue value = settings::get(settings, info.key);
    if (value == info.initial || info.key == "fusion.engine") continue;
    text += fmt::format(", {} = {}", info.key, settings::to_text(value));
  }
  return text;
}

bool has_several_tags(const recording::SensorLog& log) {
  const UltrasonicFix* first = nullptr;
  return std::ranges::any_of(log.events, [&first](const Event& event) {
    const auto* const fix = std::get_if<UltrasonicFix>(&event);
    if (fix != nullptr && first == nullptr) first = fix;
    return fix != nullptr && fix->point_body_m != first->point_body_m;
  });
}

void count(std::vector<std::size_t>& bins, double value_m, double half_width_m) {
  const auto bin = static_cast<int>(std::floor((value_m / half_width_m + 1.0) / 2.0 * Histogram::bins));
  ++bins[static_cast<std::size_t>(std::clamp(bin, 0, Histogram::bins - 1))];
}

}  // namespace

RunCurves::RunCurves(std::string name, const settings::Settings& settings, const std::string& engine,
                     const recording::SensorLog& log, const Detail& detail)
    : name_(std::move(name)),
      settings_text_(text_of(settings, engine)),
      mount_offset_rad_(settings.heading.mount_offset_deg * std::numbers::pi / 180.0),
      has_several_tags_(has_several_tags(log)),
      begin_ns_(log.events.empty() ? 0 : available_at_ns(log.events.front())),
      truth_(log.truth),
      moments_(detail.moments, merge_moments),
      path_(detail.path_points, [](PathPoint& into, const PathPoint& next) { into = next; }),
      fixes_(detail.fixes, merge_fixes) {}

void RunCurves::add(const FusedPose& pose) {
  constexpr double min_speed_mps = 0.1;
  const Vector3d horizontal{pose.velocity_world_mps.x(), pose.velocity_world_mps.y(), 0.0};
  if (horizontal.norm() > min_speed_mps) direction_world_ = horizontal.normalized();
  Moment moment;
  moment.time_s = seconds_between(begin_ns_, pose.time_ns);
  moment.position_world_m = pose.position_world_m;
  if (pose.pose_covariance.is_known(0)) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        moment.position_covariance_m2(row, column) = pose.pose_covariance.at(row, column);
      }
    }
  }
  moment.yaw_rad = geometry::yaw_of(pose.q_body_to_world);
  moment.yaw_std_rad = yaw_std_rad(pose);
  moment.speed_mps = pose.velocity_world_mps.norm();
  moment.trust = pose.trust;
  moment.status = pose.status;
  const FusedPose before = std::exchange(before_, pose);
  constexpr double min_silence_s = 0.25;
  const double before_s = seconds_between(begin_ns_, before.time_ns);
  if ((pose.status & status_imu_gap) != 0U && before.time_ns != 0 &&
      moment.time_s - before_s > min_silence_s) {
    silences_.push_back({before_s, moment.time_s});
  }
  if (const auto truth = truth_.at_or_since(before.time_ns, pose.time_ns)) {
    const FusedPose compared =
        truth->time_ns == pose.time_ns ? pose : evaluation::between(before, pose, truth->time_ns);
    moment.true_position_world_m = truth->position_world_m;
    moment.true_yaw_rad = geometry::yaw_of(truth->q_body_to_world);
    moment.true_speed_mps = truth->velocity_world_mps.norm();
    moment.error_m = (compared.position_world_m - truth->position_world_m).norm();
    if (const auto fix_world_m = baseline_.last_fix()) {
      moment.last_fix_error_m = (*fix_world_m - truth->position_world_m).norm();
    }
  }
  moments_.add(moment);
  PathPoint point{.time_s = moment.time_s};
  if (moment.is_placed()) point.position_world_m = moment.position_world_m;
  point.true_position_world_m = moment.true_position_world_m;
  path_.add(point);
}

void RunCurves::add(const FixReport& report) {
  UltrasonicFix fix;
  fix.emission_time_ns = report.emission_time_ns;
  fix.position_world_m = report.position_world_m;
  baseline_.on(fix);
  const Vector3d left_world = Vector3d::UnitZ().cross(direction_world_);
  FixMark mark{.time_s = seconds_between(begin_ns_, report.applied_time_ns),
               .position_world_m = report.position_world_m,
               .innovation_m = has_innovation(report) ? report.innovation_world_m.norm() : unknown,
               .along_m = has_innovation(report) ? report.innovation_world_m.dot(direction_world_) : unknown,
               .left_m = has_innovation(report) ? report.innovation_world_m.dot(left_world) : unknown,
               .weight = report.weight,
               .speed_mps = speed_since_last_used(report),
               .verdict = verdict_of(report),
               .flags = report.flags,
               .seen_flags = report.flags};
  if (report.innovation_covariance_m2) {
    const Eigen::Matrix3d covariance_m2 = report.innovation_covariance_m2->matrix();
    mark.along_std_m = std::sqrt(direction_world_.dot(covariance_m2 * direction_world_));
    mark.left_std_m = std::sqrt(left_world.dot(covariance_m2 * left_world));
  }
  fixes_.add(mark);
  if ((report.flags & fix_used) == 0) return;
  last_used_ = report;
  if (std::isnan(mark.along_m)) return;  // the first fix has no prediction
  along_m_.push_back(mark.along_m);
  left_m_.push_back(mark.left_m);
}

Histogram RunCurves::histogram() const {
  constexpr double min_m = 0.01;
  std::vector<double> sizes_m;
  for (const double value : along_m_) sizes_m.push_back(std::abs(value));
  for (const double value : left_m_) sizes_m.push_back(std::abs(value));
  Histogram histogram;
  histogram.half_width_m =
      sizes_m.empty() ? min_m : std::max(min_m, 1.3 * statistics::quantile(std::move(sizes_m), 0.99));
  for (const double value : along_m_) count(histogram.along, value, histogram.half_width_m);
  for (const double value : left_m_) count(histogram.left, value, histogram.half_width_m);
  return histogram;
}

double RunCurves::speed_since_last_used(const FixReport& fix) const {
  constexpr double min_interval_s = 0.05;  // shorter intervals show mostly noise
  constexpr double max_gap_s = 0.5;
  if (!last_used_ || (fix.flags & fix_used) == 0 || has_several_tags_) return unknown;
  const double interval_s = seconds_between(last_used_->emission_time_ns, fix.emission_time_ns);
  if (!(interval_s > min_interval_s && interval_s < max_gap_s)) return unknown;
  return (fix.position_world_m - last_used_->position_world_m).norm() / interval_s;
}

}  // namespace sonopose::plots
