#pragma once
/// \file
/// The installation of a beacon as shown by the samples of a window: mount, delay, scale of the map, signs of
/// the accelerometer's axes. Independent of the fusion and its engine.

#include "motion/window.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace sonopose::motion::fit {

/// An estimate and its standard deviation.
struct Measured {
  double value = 0;
  double std = 0;
};

/// The motion of samples with one change; all zero if no fit succeeded.
struct Variant {
  double log_likelihood = 0;  ///< log-likelihood minus that without the change
  double residual_m = 0;
  std::size_t outliers = 0;  ///< fixes that are far from this motion
  std::optional<Measured> mount_rad;
};

/// Search for another clock of the fixes. One takes as long as several pieces, so the others are left out.
enum class ClockSearch : std::uint8_t { not_needed, left_out, done };

/// One piece of the window, some seconds long.
struct Piece {
  std::size_t fixes = 0;
  double length_s = 0;
  double span_m = 0;  ///< diagonal of the box around the fixes
  /// Distance of the fixes from the motion that the IMU measures: standard deviation per axis, without
  /// outliers.
  double residual_m = 0;
  Measured delay_s;                   ///< age of fixes and headings beyond what the fusion assumes
  std::optional<Measured> mount_rad;  ///< angle from body X to the axis of the pair; empty without headings
  /// Log-likelihood minus that of the motion with the configured mount; 0 without headings.
  double mount_log_likelihood = 0;
  Variant scaled;                   ///< distances by the fixes, changed by 1 / `map_scale`
  Measured map_scale{1.0, 0.0};     ///< distances by the fixes over those by the IMU; std 0 if not fitted
  std::array<Variant, 3> inverted;  ///< sign of one axis of the accelerometer: x, y, z
  // Only of pieces that no motion explains well without a change.
  Variant turned_gyroscope;  ///< sign of all rates
  Variant mirrored;          ///< sign of y of fixes and headings
  Variant mirrored_fixes;    ///< sign of y of the fixes alone
  Variant other_clock;       ///< stamps of fixes and headings, changed by `clock_offset_s`
  /// Age of fixes and headings beyond what the fusion assumes, up to about a second.
  Measured clock_offset_s;
  ClockSearch clock_search = ClockSearch::not_needed;
  std::vector<Vector3d> outliers_m;  ///< deviations of the fixes that are far from the motion, world
};

/// Smallest motion at which fixes say something about mount, signs and clocks.
inline constexpr double min_span_m = 0.5;

/// True if a piece is long and wide enough to judge changes.
[[nodiscard]] inline bool is_judged(const Piece& piece) {
  constexpr double min_length_s = 5.0;  // in less time, tilt and biases explain a wrong sign
  return piece.span_m >= min_span_m && piece.length_s >= min_length_s;
}

struct PieceOptions {
  std::size_t max_pieces = 15;
  bool with_changes = true;  ///< also fit signs, mirrored maps and other clocks
  std::function<bool()> is_stopped{};
};

/// Pieces of the window with enough samples: about 8 s each, or the whole of a shorter window; of a long
/// window `max_pieces`, evenly spread. Stops early, with the pieces so far, when `is_stopped` returns true.
std::vector<Piece> pieces_of(Window window, const PieceOptions& options = {});

}  // namespace sonopose::motion::fit
