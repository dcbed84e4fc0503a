#include "motion/fit/window_fit.hpp"

#include "motion/fit/segment_fit.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::motion::fit {
namespace {

using detail::Segment;
using detail::SegmentFit;

/// Length of a piece: enough to see accelerations, short enough for the drift of the integrated IMU.
constexpr double piece_s = 8.0;
constexpr double min_piece_s = 2.0;
constexpr std::size_t max_pieces = 15;
constexpr std::size_t min_fixes = 12;
/// Longest gap over which the integral is known.
constexpr double max_gap_s = 0.12;

/// Measurements in [begin, end).
template <class Measurement>
std::span<const Measurement> between(const std::vector<Measurement>& all, TimeNs begin_ns, TimeNs end_ns) {
  const auto before = [](const Measurement& each, TimeNs time_ns) { return each.time_ns < time_ns; };
  const auto first = std::lower_bound(all.begin(), all.end(), begin_ns, before);
  const auto last = std::lower_bound(first, all.end(), end_ns, before);
  return {first, last};
}

/// Longest run of samples without a gap.
std::span<const Reading> longest_run_of(std::span<const Reading> imu) {
  std::span<const Reading> longest;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= imu.size(); ++i) {
    const bool ends = i == imu.size() || seconds_between(imu[i - 1].time_ns, imu[i].time_ns) > max_gap_s;
    if (!ends) continue;
    if (i - begin > longest.size()) longest = imu.subspan(begin, i - begin);
    begin = i;
  }
  return longest;
}

double span_of(std::span<const Position> fixes) {
  Vector3d min_world_m = fixes.front().position_world_m;
  Vector3d max_world_m = min_world_m;
  for (const Position& fix : fixes) {
    min_world_m = min_world_m.cwiseMin(fix.position_world_m);
    max_world_m = max_world_m.cwiseMax(fix.position_world_m);
  }
  return (max_world_m - min_world_m).norm();
}

std::optional<Measured> mount_of(const SegmentFit& fit, const Segment& segment) {
  constexpr std::size_t min_headings = 5;
  if (segment.headings.size() < min_headings || !fit.upright) return std::nullopt;
  return Measured{fit.mount_rad, std::hypot(fit.mount_std_rad, fit.heading_spread_rad)};
}

/// Deviations of the fixes that are far from the motion.
std::vector<Vector3d> outliers_of(const SegmentFit& fit) {
  constexpr double far = 6.0;
  std::vector<Vector3d> outliers_m;
  for (const Vector3d& deviation : fit.deviations_m) {
    if (deviation.norm() > far * fit.residual_m) outliers_m.push_back(deviation);
  }
  return outliers_m;
}

std::optional<Piece> piece_of(const Window& window, TimeNs begin_ns, TimeNs end_ns) {
  const auto imu = longest_run_of(between(window.imu, begin_ns, end_ns));
  if (imu.size() < 2) return std::nullopt;
  const TimeNs first_ns = imu.front().time_ns;
  const TimeNs last_ns = imu.back().time_ns;
  const Segment segment{imu, between(window.fixes, first_ns, last_ns),
                        between(window.headings, first_ns, last_ns)};
  if (segment.fixes.size() < min_fixes) return std::nullopt;
  if (seconds_between(segment.imu.front().time_ns, segment.imu.back().time_ns) < 0.8 * min_piece_s) {
    return std::nullopt;
  }
  const auto fit = detail::fit_segment(segment, Vector3d::Ones());
  if (!fit) return std::nullopt;
  Piece piece;
  piece.residual_m = fit->residual_m;
  piece.span_m = span_of(segment.fixes);
  piece.fixes = segment.fixes.size();
  piece.length_s = seconds_between(segment.imu.front().time_ns, segment.imu.back().time_ns);
  piece.delay_s = {fit->delay_s, fit->delay_std_s};
  piece.mount_rad = mount_of(*fit, segment);
  if (piece.mount_rad) {
    // Without such a fit, nothing is held against the configured mount.
    const auto configured = detail::fit_segment_with_mount(segment, window.mount_rad);
    if (configured) piece.mount_log_likelihood = configured->cost - fit->cost;
  }
  piece.outliers_m = outliers_of(*fit);
  constexpr double min_span_m = 0.5;  // a smaller motion says nothing about signs
  if (piece.span_m < min_span_m) return piece;
  for (std::size_t axis = 0; axis < piece.inverted.size(); ++axis) {
    Vector3d signs = Vector3d::Ones();
    signs(static_cast<Eigen::Index>(axis)) = -1.0;
    const auto inverted = detail::fit_segment(segment, signs);
    if (!inverted) return std::nullopt;
    piece.inverted.at(axis) = {fit->cost - inverted->cost, inverted->residual_m,
                               outliers_of(*inverted).size(), mount_of(*inverted, segment)};
  }
  return piece;
}

}  // namespace

std::vector<Piece> pieces_of(Window window, const std::function<bool()>& is_stopped) {
  sort_by_time(window);
  if (window.imu.size() < 2) return {};
  const TimeNs begin_ns = window.imu.front().time_ns;
  const double length_s = seconds_between(begin_ns, window.imu.back().time_ns);
  if (length_s < min_piece_s) return {};
  const auto count = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(length_s / piece_s)));
  const std::size_t step = (count + max_pieces - 1) / max_pieces;
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < count; i += step) {
    if (is_stopped && is_stopped()) break;
    const double share_s = length_s / static_cast<double>(count);
    auto piece = piece_of(window, begin_ns + to_ns(static_cast<double>(i) * share_s),
                          begin_ns + to_ns(static_cast<double>(i + 1) * share_s));
    if (piece) pieces.push_back(std::move(*piece));
  }
  return pieces;
}

}  // namespace sonopose::motion::fit
