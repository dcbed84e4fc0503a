#include "plots/layout.hpp"

#include <sonopose/statistics/quantile.hpp>

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

namespace sonopose::plots {
namespace {

using statistics::quantile;

/// The axis of errors in cm. Its maximum suits the usual errors, so rare jumps may be cut off. If rare errors
/// are far larger than the usual ones, as in outages, the axis is logarithmic.
std::string error_axis(const std::vector<double>& errors_m, double top_m) {
  constexpr double least_top_cm = 5.0;
  constexpr double dwarfed = 12.0;
  if (quantile(errors_m, 0.99) > dwarfed * quantile(errors_m, 0.5) && quantile(errors_m, 0.5) > 0.0) {
    return fmt::format("set logscale y\nset yrange [0.3:{:.3g}]\n",
                       std::max(least_top_cm, 120.0 * quantile(errors_m, 1.0)));
  }
  return fmt::format("set yrange [0:{:.3g}]\n", std::max(least_top_cm, 100.0 * top_m));
}

}  // namespace

std::string axis_of_errors(const PlotData& data) {
  std::vector<double> errors_m;
  std::vector<double> last_fix_errors_m;
  for (const auto& moment : data.moments) {
    if (bit(moment.status, status_initialising) == 0) errors_m.push_back(moment.error_m);
    last_fix_errors_m.push_back(moment.last_fix_error_m);
  }
  const double fused_m = quantile(errors_m, 0.99);
  const double last_fix_m = quantile(last_fix_errors_m, 0.9);
  return error_axis(errors_m, std::max(1.5 * fused_m, std::min(1.2 * last_fix_m, 5.0 * fused_m)));
}

std::string axis_of_innovations(const PlotData& data) {
  std::vector<double> innovations_m;
  for (const auto& fix : data.fixes) {
    if ((fix.flags & fix_used) != 0) innovations_m.push_back(fix.innovation_m);
  }
  return error_axis(innovations_m, 1.5 * quantile(innovations_m, 0.99));
}

double top_of_speeds_mps(const PlotData& data) {
  constexpr double least_mps = 0.1;
  std::vector<double> speeds_mps;
  for (const auto& moment : data.moments) {
    speeds_mps.insert(speeds_mps.end(), {moment.speed_mps, moment.true_speed_mps});
  }
  return std::max(least_mps, 1.05 * quantile(std::move(speeds_mps), 1.0));
}

Box path_box(const PlotData& data) {
  Box box;
  for (const auto& moment : data.moments) {
    if (bit(moment.status, status_initialising) == 0) box.include(moment.position_world_m);
    box.include(moment.true_position_world_m);
  }
  for (const auto& fix : data.fixes) {
    if (class_of(fix.flags) == 0) box.include(fix.position_world_m);
  }
  box.fit(path_panel.width() * plot_width, path_panel.height() * plot_height);
  return box;
}

int class_of(std::uint32_t flags) {
  if ((flags & fix_used) == 0) return 2;
  return (flags & fix_outlier) != 0 ? 1 : 0;
}

}  // namespace sonopose::plots
