#include "plots/data_blocks.hpp"

#include "plots/layout.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>

namespace sonopose::plots {
namespace {

constexpr double deg_per_rad = 180.0 / std::numbers::pi;

/// Knows where silences of the IMU interrupt a curve whose points come in order.
class Breaks {
public:
  explicit Breaks(const RunCurves& run) : silences_(run.silences()) {}

  /// Returns "\n" if a silence ended since the point before.
  const char* before(double time_s) {
    const std::size_t passed = passed_;
    while (passed_ < silences_.size() && silences_[passed_].end_s <= time_s) ++passed_;
    return passed_ > passed ? "\n" : "";
  }

private:
  const std::vector<Silence>& silences_;
  std::size_t passed_ = 0;
};

void append_poses(std::string& script, const RunCurves& run, std::size_t index) {
  auto out = std::back_inserter(script);
  fmt::format_to(out, "$poses{} << END\n", index);
  Breaks breaks(run);
  for (const Moment& moment : run.moments()) {
    fmt::format_to(out, "{}", breaks.before(moment.time_s));
    const Vector3d position = moment.is_placed() ? moment.position_world_m : Vector3d::Constant(unknown);
    const double z_band = 3.0 * std::sqrt(moment.position_covariance_m2(2, 2));
    fmt::format_to(out, "{:.4f} {:.4g} {:.4g} {:.4g} {:.4g} {:.3g} {:.3f} {:.3f} {:.3f} {:.3f} {:.4g}\n",
                   moment.time_s, moment.speed_mps, moment.true_speed_mps,
                   100.0 * (moment.is_placed() ? moment.error_m : unknown), 100.0 * moment.last_fix_error_m,
                   moment.trust, position.z(), position.z() - z_band, position.z() + z_band,
                   moment.true_position_world_m.z(),
                   300.0 * std::sqrt(moment.position_covariance_m2.trace()));
  }
  fmt::format_to(out, "END\n");
}

void append_path(std::string& script, const RunCurves& run, std::size_t index) {
  auto out = std::back_inserter(script);
  fmt::format_to(out, "$path{} << END\n", index);
  Breaks breaks(run);
  for (const PathPoint& point : run.path()) {
    fmt::format_to(out, "{}", breaks.before(point.time_s));
    fmt::format_to(out, "{:.3f} {:.3f} {:.3f} {:.3f}\n", point.position_world_m.x(),
                   point.position_world_m.y(), point.true_position_world_m.x(),
                   point.true_position_world_m.y());
  }
  fmt::format_to(out, "END\n");
}

/// Ends the curve by a blank line wherever the yaw wraps, too.
void append_yaw(std::string& script, const RunCurves& run, std::size_t index) {
  auto out = std::back_inserter(script);
  fmt::format_to(out, "$yaw{} << END\n", index);
  double before_rad = 0.0;
  Breaks breaks(run);
  for (const Moment& moment : run.moments()) {
    if (!moment.is_placed()) continue;
    const bool wraps = std::abs(moment.yaw_rad - before_rad) > std::numbers::pi;
    const char* const silence = breaks.before(moment.time_s);
    fmt::format_to(out, "{}", wraps ? "\n" : silence);
    before_rad = moment.yaw_rad;
    const double band_deg = 3.0 * deg_per_rad * moment.yaw_std_rad;
    const double yaw_deg = deg_per_rad * moment.yaw_rad;
    fmt::format_to(out, "{:.4f} {:.5g} {:.5g} {:.5g} {:.5g}\n", moment.time_s, yaw_deg, yaw_deg - band_deg,
                   yaw_deg + band_deg,
                   yaw_deg + deg_per_rad * geometry::wrap_angle(moment.true_yaw_rad - moment.yaw_rad));
  }
  fmt::format_to(out, "END\n");
}

/// Appends the largest ellipse in each of equal parts of the run.
void append_ellipses(std::string& script, const RunCurves& run, std::size_t index) {
  constexpr std::size_t parts = 40;
  auto out = std::back_inserter(script);
  fmt::format_to(out, "$ellipses{} << END\n", index);
  const auto& moments = run.moments();
  for (std::size_t part = 0; part < parts; ++part) {
    const Moment* widest = nullptr;
    for (std::size_t i = part * moments.size() / parts; i < (part + 1) * moments.size() / parts; ++i) {
      const auto size = [](const Moment& moment) {
        return moment.position_covariance_m2.topLeftCorner<2, 2>().trace();
      };
      if (!moments[i].is_placed() || !std::isfinite(size(moments[i]))) continue;
      if (widest == nullptr || size(moments[i]) > size(*widest)) widest = &moments[i];
    }
    if (widest == nullptr) continue;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(
        widest->position_covariance_m2.topLeftCorner<2, 2>());
    const Eigen::Vector2d diameters_m = 6.0 * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    const Eigen::Vector2d major = axes.eigenvectors().col(1);
    fmt::format_to(out, "{:.3f} {:.3f} {:.4g} {:.4g} {:.4g}\n", widest->position_world_m.x(),
                   widest->position_world_m.y(), diameters_m[1], diameters_m[0],
                   deg_per_rad * std::atan2(major.y(), major.x()));
  }
  fmt::format_to(out, "END\n");
}

void append_fixes(std::string& script, const RunCurves& run, std::size_t index) {
  auto out = std::back_inserter(script);
  fmt::format_to(out, "$fixes{} << END\n", index);
  for (const FixMark& fix : run.fixes()) {
    fmt::format_to(out, "{:.4f} {:.3f} {:.3f} {:.3f} {:.4g} {:.4g} {:.4g} {:.4g} {:.3g} {:.4g} {} {}\n",
                   fix.time_s, fix.position_world_m.x(), fix.position_world_m.y(), fix.position_world_m.z(),
                   100.0 * fix.along_m, 100.0 * fix.left_m, 300.0 * fix.along_std_m, 300.0 * fix.left_std_m,
                   fix.weight, fix.speed_mps, static_cast<int>(fix.verdict), fix.seen_flags);
  }
  fmt::format_to(out, "END\n");
}

void append_histogram(std::string& script, const RunCurves& run, std::size_t index) {
  auto out = std::back_inserter(script);
  const Histogram histogram = run.histogram();
  const auto share_percent = [](const std::vector<std::size_t>& bins, std::size_t bin) {
    const auto all = std::accumulate(bins.begin(), bins.end(), std::size_t{0});
    return all == 0 ? 0.0 : 100.0 * static_cast<double>(bins[bin]) / static_cast<double>(all);
  };
  fmt::format_to(out, "$histogram{} << END\n", index);
  for (std::size_t bin = 0; bin < Histogram::bins; ++bin) {
    fmt::format_to(out, "{:.4g} {:.3g} {:.3g}\n", 100.0 * histogram.centre_m(static_cast<int>(bin)),
                   share_percent(histogram.along, bin), share_percent(histogram.left, bin));
  }
  fmt::format_to(out, "END\n");
}

void append_arrivals(std::string& script, const PlotData& data) {
  auto out = std::back_inserter(script);
  const double mount_rad = data.runs.front().mount_offset_rad();
  fmt::format_to(out, "$headings << END\n");
  for (const HeadingMark& mark : data.arrivals.headings) {
    fmt::format_to(
        out, "{:.4f} {:.5g}\n", mark.time_s,
        deg_per_rad * geometry::wrap_angle(mark.heading_world_rad - (mark.is_of_body ? 0.0 : mount_rad)));
  }
  fmt::format_to(out, "END\n$arrivals << END\n");
  for (const ArrivalMark& mark : data.arrivals.fixes) {
    fmt::format_to(out, "{:.4f} {:.4g} {:.4g}\n", mark.time_s, 1e3 * mark.delay_s, mark.quality_percent);
  }
  fmt::format_to(out, "END\n");
}

/// Appends only changes, to keep the plot of an hour small.
void append_status(std::string& script, const PlotData& data) {
  auto out = std::back_inserter(script);
  fmt::format_to(out, "$status << END\n");
  const auto& moments = data.runs.front().moments();
  int before = -1;
  for (const Moment& moment : moments) {
    const int stale = bit(moment.status, status_stale);
    const int converging = bit(moment.status, status_converging);
    const int now = 2 * stale + converging;
    if (now == before && &moment != &moments.back()) continue;
    fmt::format_to(out, "{:.4f} {} {}\n", moment.time_s, stale, converging);
    before = now;
  }
  fmt::format_to(out, "END\n");
}

void append_silences(std::string& script, const PlotData& data) {
  auto out = std::back_inserter(script);
  fmt::format_to(out, "$silences << END\n");
  for (const Silence& silence : data.runs.front().silences()) {
    fmt::format_to(out, "{:.4f} 1\n{:.4f} 0\n", silence.begin_s, silence.end_s);
  }
  fmt::format_to(out, "END\n");
}

}  // namespace

std::string data_blocks(const PlotData& data) {
  std::string script;
  for (std::size_t index = 0; index < data.runs.size(); ++index) {
    append_poses(script, data.runs[index], index);
    append_path(script, data.runs[index], index);
    append_yaw(script, data.runs[index], index);
    append_ellipses(script, data.runs[index], index);
    append_fixes(script, data.runs[index], index);
    append_histogram(script, data.runs[index], index);
  }
  append_arrivals(script, data);
  append_status(script, data);
  append_silences(script, data);
  return script;
}

}  // namespace sonopose::plots
