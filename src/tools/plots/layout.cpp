#include "plots/layout.hpp"

#include <sonopose/statistics/quantile.hpp>

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

namespace sonopose::plots {
namespace {

using statistics::quantile;

/// Returns the axis of errors in cm. Its maximum suits the usual errors, so rare jumps may be cut off. The
/// axis is logarithmic if rare errors are far larger than usual, as in outages.
std::string error_axis(const std::vector<double>& errors_m, double top_m) {
  constexpr double min_top_cm = 5.0;
  constexpr double max_linear_ratio = 12.0;
  if (quantile(errors_m, 0.99) > max_linear_ratio * quantile(errors_m, 0.5) &&
      quantile(errors_m, 0.5) > 0.0) {
    return fmt::format("set logscale y\nset yrange [0.3:{:.3g}]\n",
                       std::max(min_top_cm, 120.0 * quantile(errors_m, 1.0)));
  }
  return fmt::format("set yrange [0:{:.3g}]\n", std::max(min_top_cm, 100.0 * top_m));
}

}  // namespace

double tic_step(double span) {
  constexpr double max_tics = 4.0;
  const double power = std::pow(10.0, std::floor(std::log10(span / max_tics)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (span <= max_tics * factor * power) return factor * power;
  }
  return 10.0 * power;
}

std::string axis_of_errors(const PlotData& data) {
  std::vector<double> errors_m;
  std::vector<double> last_fix_errors_m;
  for (const RunCurves& run : data.runs) {
    for (const Moment& moment : run.moments()) {
      if (moment.is_placed()) errors_m.push_back(moment.error_m);
      last_fix_errors_m.push_back(moment.last_fix_error_m);
    }
  }
  const double fused_m = quantile(errors_m, 0.99);
  const double last_fix_m = quantile(last_fix_errors_m, 0.9);
  return error_axis(errors_m, std::max(1.5 * fused_m, std::min(1.2 * last_fix_m, 5.0 * fused_m)));
}

std::string axis_of_innovations(const PlotData& data) {
  constexpr double min_m = 0.05;
  std::vector<double> sizes_m;
  for (const RunCurves& run : data.runs) {
    for (const FixMark& fix : run.fixes()) {
      if (fix.verdict != FixVerdict::used) continue;
      sizes_m.insert(sizes_m.end(), {std::abs(fix.along_m), std::abs(fix.left_m)});
    }
  }
  const double top_cm =
      100.0 * (sizes_m.empty() ? min_m : std::max(min_m, 1.5 * quantile(std::move(sizes_m), 0.98)));
  return fmt::format("set yrange [{:.3g}:{:.3g}]\n", -top_cm, top_cm);
}

std::string axis_of_heights(const PlotData& data) {
  constexpr double min_span_m = 0.2;
  std::vector<double> heights_m;
  for (const RunCurves& run : data.runs) {
    for (const Moment& moment : run.moments()) {
      if (moment.is_placed()) heights_m.push_back(moment.position_world_m.z());
      const double true_m = moment.true_position_world_m.z();
      if (std::isfinite(true_m)) heights_m.push_back(true_m);
    }
  }
  if (heights_m.empty()) return "set yrange [-1:1]\n";
  const double low_m = quantile(heights_m, 0.005);
  const double high_m = quantile(heights_m, 0.995);
  const double margin_m = std::max(0.2 * (high_m - low_m), 0.5 * (min_span_m - (high_m - low_m)));
  return fmt::format("set yrange [{:.3f}:{:.3f}]; set ytics {:.4g}\n", low_m - margin_m, high_m + margin_m,
                     tic_step(high_m - low_m + 2.0 * margin_m));
}

std::string axis_of_speeds(const PlotData& data) {
  constexpr double min_mps = 0.1;
  std::vector<double> speeds_mps;
  for (const RunCurves& run : data.runs) {
    for (const Moment& moment : run.moments()) {
      speeds_mps.insert(speeds_mps.end(), {moment.speed_mps, moment.true_speed_mps});
    }
  }
  return fmt::format("set yrange [0:{:.4g}]\n",
                     std::max(min_mps, 1.05 * quantile(std::move(speeds_mps), 1.0)));
}

std::string axis_of_delays(const PlotData& data) {
  constexpr double min_ms = 50.0;
  std::vector<double> delays_ms{min_ms};
  for (const ArrivalMark& fix : data.arrivals.fixes) delays_ms.push_back(1e3 * fix.delay_s);
  const double top_ms = std::max(min_ms, 1.3 * quantile(delays_ms, 0.99));
  const double bottom_ms = std::min(0.0, 1.3 * quantile(std::move(delays_ms), 0.0));
  const bool usual = top_ms - bottom_ms < 400.0;
  return fmt::format("set yrange [{:.4g}:{:.4g}]; set ytics {}\n", bottom_ms, top_ms,
                     usual ? (top_ms > 150.0 ? "50" : "25") : "auto");
}

Box path_box(const PlotData& data) {
  Box box;
  for (const RunCurves& run : data.runs) {
    for (const PathPoint& point : run.path()) {
      box.include(point.position_world_m);
      box.include(point.true_position_world_m);
    }
    for (const FixMark& fix : run.fixes()) {
      if (fix.verdict == FixVerdict::used) box.include(fix.position_world_m);
    }
  }
  box.fit(path_panel.width() * plot_width, path_panel.height() * plot_height);
  return box;
}

}  // namespace sonopose::plots
