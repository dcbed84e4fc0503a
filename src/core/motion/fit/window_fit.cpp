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

/// Samples of a segment that are changed.
struct Changed {
  explicit Changed(const Segment& segment)
      : imu(segment.imu.begin(), segment.imu.end()),
        fixes(segment.fixes.begin(), segment.fixes.end()),
        headings(segment.headings.begin(), segment.headings.end()) {}

  [[nodiscard]] Segment segment() const { return {imu, fixes, headings}; }

  std::vector<Reading> imu;
  std::vector<Position> fixes;
  std::vector<Direction> headings;
};

/// Log-likelihood of the second fit over that of the first, which may have more or fewer fixes.
double gain_of(const SegmentFit& before, const SegmentFit& after) {
  const auto share =
      static_cast<double>(before.deviations_m.size()) / static_cast<double>(after.deviations_m.size());
  return before.cost - share * after.cost;
}

Variant variant_of(const SegmentFit& unchanged, const Segment& segment, const SegmentFit& changed) {
  return Variant{gain_of(unchanged, changed), changed.residual_m, outliers_of(changed).size(),
                 mount_of(changed, segment)};
}

std::optional<Variant> variant_of(const SegmentFit& unchanged, const Segment& segment,
                                  const Vector3d& signs = Vector3d::Ones()) {
  const auto fit = detail::fit_segment(segment, signs);
  return fit ? std::optional(variant_of(unchanged, segment, *fit)) : std::nullopt;
}

/// Fits the segment as it would be with a gyroscope or a map of the other sense.
void fit_mirrored(const Segment& segment, const SegmentFit& fit, Piece& piece) {
  Changed changed(segment);
  for (Reading& reading : changed.imu) reading.rate_body_radps *= -1.0;
  piece.turned_gyroscope = variant_of(fit, changed.segment()).value_or(Variant{});
  changed.imu.assign(segment.imu.begin(), segment.imu.end());
  for (Position& fix : changed.fixes) fix.position_world_m.y() *= -1.0;
  piece.mirrored_fixes = variant_of(fit, changed.segment()).value_or(Variant{});
  if (segment.headings.empty()) {
    piece.mirrored = piece.mirrored_fixes;
    return;
  }
  for (Direction& heading : changed.headings) heading.heading_world_rad *= -1.0;
  piece.mirrored = variant_of(fit, changed.segment()).value_or(Variant{});
}

/// Fits the segment with the stamps of fixes and headings set back by up to a second, the smallest change
/// first, and compares it with a fit whose delay is one of a beacon. Finds nothing if it is stopped.
void search_clock(const Window& window, const Segment& segment, const SegmentFit& fit,
                  const std::function<bool()>& is_stopped, Piece& piece) {
  constexpr double beacon_delay_std_s = 0.02;
  constexpr double step_s = 0.2;  // the fit itself finds half of it
  constexpr int steps = 10;       // to both sides
  constexpr double good_residual_m = 0.03;
  constexpr double good_log_likelihood = 25.0;
  const auto one_clock = detail::fit_segment(segment, Vector3d::Ones(), {.delay_std_s = beacon_delay_std_s});
  if (!one_clock) return;
  bool is_found = false;
  constexpr double inside_s = 0.12;  // further out the next change fits better
  constexpr double edge_s = 0.25;
  const auto compare = [&](const SegmentFit& found, const Segment& of, double set_back_s) {
    const double gain = gain_of(*one_clock, found);
    if (gain <= piece.other_clock.log_likelihood || std::abs(found.delay_s) > edge_s) return;
    piece.other_clock = variant_of(*one_clock, of, found);
    piece.clock_offset_s = {set_back_s + found.delay_s, found.delay_std_s};
    is_found = found.residual_m < good_residual_m && gain > good_log_likelihood &&
               std::abs(found.delay_s) < inside_s;
  };
  compare(fit, segment, 0.0);
  for (int step = 1; step <= steps && !is_found; ++step) {
    if (is_stopped()) {
      piece.other_clock = {};
      piece.clock_offset_s = {};
      return;
    }
    const double set_back_s = step_s * (step % 2 == 0 ? -step / 2 : (step + 1) / 2);
    const TimeNs set_back_ns = to_ns(set_back_s);
    const TimeNs first_ns = segment.imu.front().time_ns + set_back_ns;
    const TimeNs last_ns = segment.imu.back().time_ns + set_back_ns;
    Changed changed(
        {segment.imu, between(window.fixes, first_ns, last_ns), between(window.headings, first_ns, last_ns)});
    if (changed.fixes.size() < min_fixes) continue;
    for (Position& fix_back : changed.fixes) fix_back.time_ns -= set_back_ns;
    for (Direction& heading : changed.headings) heading.time_ns -= set_back_ns;
    const auto found = detail::fit_segment(changed.segment(), Vector3d::Ones());
    if (found) compare(*found, changed.segment(), set_back_s);
  }
  piece.clock_search = ClockSearch::done;
}

/// A piece with its unchanged fit.
struct FittedPiece {
  Piece piece;
  Segment segment;
  SegmentFit fit;
  bool is_mirror_untried = false;  ///< true if no mirrored fit was made
};

/// Fits the samples in [begin, end).
std::optional<FittedPiece> piece_of(const Window& window, TimeNs begin_ns, TimeNs end_ns) {
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
  FittedPiece fitted{{}, segment, *fit};
  Piece& piece = fitted.piece;
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
  if (piece.span_m < min_span_m) return fitted;
  const auto scaled = detail::fit_segment(segment, Vector3d::Ones(), {.is_map_scaled = true});
  if (scaled) {
    piece.scaled = variant_of(*fit, segment, *scaled);
    piece.map_scale = {scaled->map_scale, scaled->map_scale_std};
  }
  return fitted;
}

/// Fits the piece with changes that may explain it better. Searches another clock unless that is done.
/// Returns false if one with another sign fails.
bool fit_changes(const Window& window, const std::function<bool()>& is_stopped, bool is_clock_searched,
                 FittedPiece& fitted) {
  Piece& piece = fitted.piece;
  const Segment& segment = fitted.segment;
  if (piece.span_m < min_span_m) return true;
  for (std::size_t axis = 0; axis < piece.inverted.size(); ++axis) {
    Vector3d signs = Vector3d::Ones();
    signs(static_cast<Eigen::Index>(axis)) = -1.0;
    const auto inverted = variant_of(fitted.fit, segment, signs);
    if (!inverted) return false;
    piece.inverted.at(axis) = *inverted;
  }
  constexpr double poor_residual_m = 0.022;
  constexpr double doubtful_residual_m = 0.035;
  constexpr double doubtful_log_likelihood = 10.0;
  constexpr double doubtful_delay_s = 0.1;
  const bool is_poor = piece.residual_m > poor_residual_m ||
                       piece.mount_log_likelihood > doubtful_log_likelihood ||
                       std::ranges::any_of(piece.inverted, [](const Variant& inverted) {
                         return inverted.log_likelihood > doubtful_log_likelihood;
                       });
  fitted.is_mirror_untried = !is_poor;
  if (is_poor) fit_mirrored(segment, fitted.fit, piece);
  const bool has_doubtful_clock =
      piece.residual_m > doubtful_residual_m || std::abs(piece.delay_s.value) > doubtful_delay_s;
  if (has_doubtful_clock) piece.clock_search = ClockSearch::left_out;
  if (has_doubtful_clock && is_judged(piece) && !is_clock_searched) {
    search_clock(window, segment, fitted.fit, is_stopped, piece);
  }
  return true;
}

/// True if pieces with a known mount have different ones.
bool have_other_mounts(const std::vector<FittedPiece>& pieces) {
  constexpr double min_difference_rad = 45.0 * geometry::radians_per_degree;
  constexpr double max_std_rad = 10.0 * geometry::radians_per_degree;
  const Piece* first = nullptr;
  return std::ranges::any_of(pieces, [&](const FittedPiece& fitted) {
    const Piece& piece = fitted.piece;
    if (!piece.mount_rad || piece.mount_rad->std > max_std_rad) return false;
    if (first == nullptr) first = &piece;
    return std::abs(geometry::wrap_angle(piece.mount_rad->value - first->mount_rad->value)) >
           min_difference_rad;
  });
}

}  // namespace

std::vector<Piece> pieces_of(Window window, const PieceOptions& options) {
  sort_by_time(window);
  if (window.imu.size() < 2) return {};
  const TimeNs begin_ns = window.imu.front().time_ns;
  const double length_s = seconds_between(begin_ns, window.imu.back().time_ns);
  if (length_s < min_piece_s) return {};
  const auto count = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(length_s / piece_s)));
  const std::size_t fitted_count = std::min(count, options.max_pieces);
  const auto is_stopped = [&] { return options.is_stopped && options.is_stopped(); };
  bool is_clock_searched = false;
  std::vector<FittedPiece> fitted;
  for (std::size_t each = 0; each < fitted_count && !is_stopped(); ++each) {
    const std::size_t i = each * count / fitted_count;
    const double share_s = length_s / static_cast<double>(count);
    auto piece = piece_of(window, begin_ns + to_ns(static_cast<double>(i) * share_s),
                          begin_ns + to_ns(static_cast<double>(i + 1) * share_s));
    if (!piece) continue;
    if (options.with_changes && !fit_changes(window, is_stopped, is_clock_searched, *piece)) continue;
    is_clock_searched = is_clock_searched || piece->piece.clock_search == ClockSearch::done;
    fitted.push_back(std::move(*piece));
  }
  // A straight way of a mirrored map looks like another mount.
  const bool may_be_mirrored = have_other_mounts(fitted);
  std::vector<Piece> pieces;
  for (FittedPiece& each : fitted) {
    if (may_be_mirrored && each.is_mirror_untried && !is_stopped()) {
      fit_mirrored(each.segment, each.fit, each.piece);
    }
    pieces.push_back(std::move(each.piece));
  }
  return pieces;
}

}  // namespace sonopose::motion::fit
