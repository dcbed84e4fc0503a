#pragma once
/// \file
/// Derives faults of the installation of a beacon from fits of its motion: other clocks, a mirrored map or
/// one of a wrong scale, wrong signs, mount offset and delay.

#include "motion/fit/window_fit.hpp"
#include "motion/imu_summary.hpp"
#include "motion/turn_gain.hpp"
#include <sonopose/settings/settings.hpp>

#include <string>
#include <vector>

namespace sonopose::installation {

/// Properties of a beacon's samples over a window.
struct Evidence {
  settings::Settings settings;             ///< settings of its fusion
  std::vector<motion::fit::Piece> pieces;  ///< fits of its motion
  motion::ImuSummary imu_summary;          ///< summary with the calibration applied
  motion::TurnGain turn_gain;              ///< gain of the calibrated gyroscope
  bool are_headings_of_body = false;       ///< true if they are not those of a pair
  bool are_fixes_timed = false;            ///< true if the hardware measured the delay of most fixes
  double min_fix_delay_s = 0;              ///< minimum time from emission to receipt
};

struct Finding {
  bool is_error = true;  ///< otherwise a warning
  std::string text;      ///< one sentence about "its" samples
  std::string remedy;
};

/// Returns the faults. A fault that causes others is returned without them.
std::vector<Finding> findings_of(const Evidence& evidence);

/// True if a motion with the configured mount and a map of the right scale explains the piece, or if the
/// piece is too small to judge.
bool is_explained(const motion::fit::Piece& piece);

/// Returns the fault if only the accelerometer's axis z has the wrong sign; otherwise none.
std::vector<Finding> wrong_sign_of_z(const Evidence& evidence);

}  // namespace sonopose::installation
