#include "plots/plot.hpp"

#include "plots/gnuplot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sonopose::plots {
namespace {

/// The larger of two errors; either may be NaN (unknown).
double worse(double a, double b) {
  return std::isnan(a) || b > a ? b : a;
}

void merge(PlotData::Moment& into, const PlotData::Moment& next) {
  const PlotData::Moment before = into;
  into = next;
  into.error_m = worse(before.error_m, next.error_m);
  into.last_fix_error_m = worse(before.last_fix_error_m, next.last_fix_error_m);
  into.trust = std::min(before.trust, next.trust);
  into.status |= before.status;
}

}  // namespace

Plot::Plot(std::filesystem::path file, std::string title, const recording::SensorLog& log)
    : file_(std::move(file)),
      replacement_(file_),
      begin_ns_(log.events.empty() ? 0 : available_at_ns(log.events.front())),
      truth_(log.truth) {
  check_plot_file(file_, replacement_);
  data_.title = std::move(title);
  data_.has_truth = !log.truth.empty();
}

void Plot::add(const FusedPose& pose) {
  PlotData::Moment moment;
  moment.time_s = seconds_between(begin_ns_, pose.time_ns);
  moment.position_world_m = pose.position_world_m;
  moment.speed_mps = pose.velocity_world_mps.norm();
  moment.trust = pose.trust;
  moment.status = pose.status;
  if (const auto truth = truth_.at(pose.time_ns)) {
    moment.true_position_world_m = truth->position_world_m;
    moment.true_speed_mps = truth->velocity_world_mps.norm();
    moment.error_m = (pose.position_world_m - truth->position_world_m).norm();
    if (const auto fix_world_m = baseline_.last_fix()) {
      moment.last_fix_error_m = (*fix_world_m - truth->position_world_m).norm();
    }
  }
  if (poses_in_last_ > 0 && poses_in_last_ < poses_per_moment_) {
    merge(data_.moments.back(), moment);
    ++poses_in_last_;
    return;
  }
  if (data_.moments.size() == most_moments) halve();
  data_.moments.push_back(moment);
  poses_in_last_ = 1;
}

void Plot::add(const FixReport& report) {
  UltrasonicFix fix;
  fix.emission_time_ns = report.emission_time_ns;
  fix.position_world_m = report.position_world_m;
  baseline_.on(fix);
  data_.fixes.push_back({.time_s = seconds_between(begin_ns_, report.applied_time_ns),
                         .position_world_m = report.position_world_m,
                         .innovation_m = report.innovation_world_m.norm(),
                         .weight = report.weight,
                         .speed_mps = speed_since_last_used(report),
                         .flags = report.flags});
  if ((report.flags & fix_used) != 0) last_used_ = report;
}

void Plot::halve() {
  auto& moments = data_.moments;
  for (std::size_t i = 0; i < moments.size() / 2; ++i) {
    PlotData::Moment pair = moments[2 * i];
    merge(pair, moments[2 * i + 1]);
    moments[i] = pair;
  }
  moments.resize(moments.size() / 2);
  poses_per_moment_ *= 2;
}

double Plot::speed_since_last_used(const FixReport& fix) const {
  constexpr double least_interval_s = 0.05;  // shorter intervals show mostly noise
  constexpr double widest_gap_s = 0.5;
  if (!last_used_ || (fix.flags & fix_used) == 0) return PlotData::unknown;
  const double interval_s = seconds_between(last_used_->emission_time_ns, fix.emission_time_ns);
  if (!(interval_s > least_interval_s && interval_s < widest_gap_s)) return PlotData::unknown;
  return (fix.position_world_m - last_used_->position_world_m).norm() / interval_s;
}

void Plot::draw() {
  draw_plot(file_, replacement_, gnuplot_script(data_, replacement_.part(), file_.extension()));
}

}  // namespace sonopose::plots
