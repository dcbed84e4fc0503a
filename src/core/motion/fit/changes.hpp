#pragma once
/// \file
/// Changes that make samples agree with a motion (other clocks, a mirrored map), and the conditions under
/// which a fit with a change counts.

#include "motion/fit/window_fit.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace sonopose::motion::fit {

/// Largest residual, above the noise of any usable fix. Beyond it the IMU does not measure the motion of the
/// fixes.
inline constexpr double max_residual_m = 0.06;
/// Number of standard deviations for a finding.
inline constexpr double significant_stds = 3.5;
/// Logarithm of the likelihood ratio, per piece, by which a change must win.
inline constexpr double min_log_likelihood_ratio = 25.0;

/// True if fewer than a share of the fixes are outliers.
inline bool are_few(std::size_t outliers, const Piece& piece, double share) {
  return static_cast<double>(outliers) < share * static_cast<double>(piece.fixes);
}

/// True if this change explains the piece, which its samples as they are do not.
bool explains(const Variant& variant, const Piece& piece);

/// Weighted mean of independent estimates. Not more accurate than `min_std`, nor than their spread.
Measured mean_of(const std::vector<Measured>& all, double min_std);

/// Returns the age of the fixes beyond what the fusion assumes, if their stamps and those of the IMU are of
/// different clocks.
std::optional<Measured> clock_offset_in(const std::vector<Piece>& pieces);

/// Returns the ratio of the distances by the fixes to those by the IMU, if no other change explains the
/// pieces as well as a map of another scale.
std::optional<Measured> map_scale_in(const std::vector<Piece>& pieces);

/// The change of a mirrored map. Without right headings it is not known which.
enum class MapChange : std::uint8_t { invert_y, invert_x, exchange, exchange_and_invert, unknown };

/// "exchange x and y".
std::string_view text_of(MapChange change);

/// Returns the change if the map is mirrored. `mount_rad`: configured angle from body X to the axis of the
/// pair. The IMU must not be upside down, since it then turns the other way too.
std::optional<MapChange> mirror_in(const std::vector<Piece>& pieces, double mount_rad);

}  // namespace sonopose::motion::fit
