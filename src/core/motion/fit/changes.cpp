#include "motion/fit/changes.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace sonopose::motion::fit {
namespace {

constexpr double max_outliers = 0.1;
/// Accuracy of the mount with a change. Fixes that drift away resemble a wrong sign, but no mount fits them
/// well.
constexpr double max_mount_std_rad = 6.0 * geometry::radians_per_degree;
/// Largest difference of right mounts between pieces.
constexpr double max_range_rad = 20.0 * geometry::radians_per_degree;
/// In the plane, a mirrored map looks like an inverted axis z: the likelihoods are nearly equal.
constexpr double min_share_of_others = 0.9;

/// Log-likelihood of the best change of the IMU.
double best_of_imu(const Piece& piece) {
  double best = piece.turned_gyroscope.log_likelihood;
  for (const Variant& inverted : piece.inverted) best = std::max(best, inverted.log_likelihood);
  return best;
}

bool has_right_headings(const Piece& piece) {
  return piece.mirrored_fixes.log_likelihood > piece.mirrored.log_likelihood;
}

const Variant& mirrored_of(const Piece& piece) {
  return has_right_headings(piece) ? piece.mirrored_fixes : piece.mirrored;
}

bool is_majority(std::size_t count, std::size_t all) {
  return count > 0 && 2 * count > all;
}

MapChange change_of(double turned_rad) {
  const long quarters = std::lround(turned_rad / (0.5 * std::numbers::pi));
  constexpr std::array changes{MapChange::invert_y, MapChange::exchange, MapChange::invert_x,
                               MapChange::exchange_and_invert};
  return changes.at(static_cast<std::size_t>((quarters + 4) % 4));
}

/// Largest difference of these angles from the first.
double range_of(const std::vector<double>& angles_rad) {
  double range_rad = 0;
  for (const double angle_rad : angles_rad)
    range_rad = std::max(range_rad, std::abs(geometry::wrap_angle(angle_rad - angles_rad.front())));
  return range_rad;
}

/// On straight ways the fit is as good without a mirror, but finds another mount in each piece. With the
/// mirror the mounts agree.
std::optional<MapChange> mirror_by_mounts(const std::vector<Piece>& pieces, double mount_rad) {
  constexpr double min_range_rad = 45.0 * geometry::radians_per_degree;
  std::vector<double> mounts_rad;
  std::vector<double> mirrored_rad;
  for (const Piece& piece : pieces) {
    const auto& mirrored = piece.mirrored_fixes;
    if (!is_judged(piece) || !piece.mount_rad || piece.mount_rad->std > max_mount_std_rad) continue;
    mounts_rad.push_back(piece.mount_rad->value);
    if (!mirrored.mount_rad || mirrored.mount_rad->std > max_mount_std_rad ||
        mirrored.residual_m > max_residual_m || mirrored.log_likelihood < -min_log_likelihood_ratio)
      return std::nullopt;
    mirrored_rad.push_back(geometry::wrap_angle(mirrored.mount_rad->value - mount_rad));
  }
  if (mirrored_rad.size() < 2 || range_of(mirrored_rad) > max_range_rad ||
      range_of(mounts_rad) < min_range_rad)
    return std::nullopt;
  return change_of(mirrored_rad.front());
}

}  // namespace

bool explains(const Variant& variant, const Piece& piece) {
  if (variant.log_likelihood < min_log_likelihood_ratio || variant.residual_m > max_residual_m) return false;
  if (variant.mount_rad && variant.mount_rad->std > max_mount_std_rad) return false;
  return are_few(variant.outliers, piece, max_outliers);
}

Measured mean_of(const std::vector<Measured>& all, double min_std) {
  double weights = 0;
  double sum = 0;
  for (const Measured& each : all) {
    weights += 1.0 / (each.std * each.std);
    sum += each.value / (each.std * each.std);
  }
  const double mean = sum / weights;
  double squares = 0;
  for (const Measured& each : all) squares += (each.value - mean) * (each.value - mean);
  const double spread = std::sqrt(squares) / static_cast<double>(all.size());
  return {mean, std::max(min_std, std::hypot(std::sqrt(1.0 / weights), spread))};
}

std::optional<Measured> clock_offset_in(const std::vector<Piece>& pieces) {
  constexpr double min_offset_s = 0.12;  // less is a delay
  constexpr double min_std_s = 0.003;
  constexpr double known_std_s = 0.02;
  const Piece* searched = nullptr;  // there is at most one
  for (const Piece& piece : pieces) {
    if (!is_judged(piece) || piece.clock_search == ClockSearch::left_out) continue;
    if (piece.clock_search == ClockSearch::done) {
      searched = &piece;
    } else if (piece.delay_s.std <= known_std_s) {
      return std::nullopt;  // it fits with one clock
    }
  }
  if (searched == nullptr || !explains(searched->other_clock, *searched)) return std::nullopt;
  const double others = std::max(best_of_imu(*searched), mirrored_of(*searched).log_likelihood);
  if (searched->other_clock.log_likelihood < min_share_of_others * others) return std::nullopt;
  const Measured offset{searched->clock_offset_s.value, std::max(min_std_s, searched->clock_offset_s.std)};
  if (std::abs(offset.value) < std::max(min_offset_s, significant_stds * offset.std)) return std::nullopt;
  return offset;
}

std::optional<Measured> map_scale_in(const std::vector<Piece>& pieces) {
  constexpr double min_error = 0.08;  // more than an accelerometer and its axes err
  constexpr double piece_std = 0.04;  // error of the fit of a piece
  constexpr double good_residual_m = 0.025;
  std::size_t judged = 0;
  std::vector<Measured> scales;
  double log_likelihood = 0;
  double over_others = 0;
  for (const Piece& piece : pieces) {
    if (!is_judged(piece)) continue;
    ++judged;
    const Variant& scaled = piece.scaled;
    // A larger map has more noise. Shocks and noise of the IMU look like longer ways, but do not fit well.
    const double max_m =
        piece.map_scale.value > 1.0 ? max_residual_m * piece.map_scale.value : good_residual_m;
    const bool is_fitted = piece.map_scale.std > 0.0;
    if (!is_fitted || scaled.residual_m > max_m || !are_few(scaled.outliers, piece, max_outliers)) continue;
    log_likelihood += scaled.log_likelihood;
    over_others += scaled.log_likelihood - std::max(best_of_imu(piece), mirrored_of(piece).log_likelihood);
    scales.push_back(piece.map_scale);
  }
  if (!is_majority(scales.size(), judged) || log_likelihood < min_log_likelihood_ratio || over_others < 0) {
    return std::nullopt;
  }
  const Measured scale = mean_of(scales, piece_std / std::sqrt(static_cast<double>(scales.size())));
  const double error = std::abs(scale.value - 1.0);
  return error > std::max(min_error, significant_stds * scale.std) ? std::optional(scale) : std::nullopt;
}

std::string_view text_of(MapChange change) {
  switch (change) {
    case MapChange::invert_y:
      return "change the sign of y";
    case MapChange::invert_x:
      return "change the sign of x";
    case MapChange::exchange:
      return "exchange x and y";
    case MapChange::exchange_and_invert:
      return "exchange x and y, and change the sign of both";
    case MapChange::unknown:
      break;
  }
  return "exchange x and y, or change the sign of one of them";
}

std::optional<MapChange> mirror_in(const std::vector<Piece>& pieces, double mount_rad) {
  std::size_t judged = 0;
  std::size_t mirrored = 0;
  double over_gyroscope = 0;
  double over_imu = 0;
  std::vector<double> turned_rad;  // headings against fixes whose y has the other sign
  for (const Piece& piece : pieces) {
    if (!is_judged(piece)) continue;
    ++judged;
    const Variant& variant = mirrored_of(piece);
    if (!explains(variant, piece)) continue;
    ++mirrored;
    over_gyroscope +=
        variant.log_likelihood - piece.turned_gyroscope.log_likelihood - min_log_likelihood_ratio;
    over_imu += variant.log_likelihood - min_share_of_others * best_of_imu(piece);
    if (has_right_headings(piece) && variant.mount_rad)
      turned_rad.push_back(geometry::wrap_angle(variant.mount_rad->value - mount_rad));
  }
  if (is_majority(mirrored, judged) && over_gyroscope > 0 && over_imu > 0) {
    const bool is_known = is_majority(turned_rad.size(), mirrored) && range_of(turned_rad) < max_range_rad;
    return is_known ? change_of(turned_rad.front()) : MapChange::unknown;
  }
  return mirror_by_mounts(pieces, mount_rad);
}

}  // namespace sonopose::motion::fit
