#pragma once
/// \file
/// A direct comparison of the gyroscope with headings, which shows a wrong sign, a dead axis and a wrong
/// scale whatever else is wrong.

#include "motion/window.hpp"

#include <cstddef>
#include <cstdint>

namespace sonopose::motion {

/// Turns by the gyroscope over the same turns by heading.
struct TurnGain {
  std::size_t turns = 0;  ///< compared turns, of at least 30° in 2 s; 0 without gravity
  bool is_slow = false;   ///< in 8 s, for want of faster turns: their gain only shows a sign
  /// Median: 1 if the gyroscope is right. Its sign is that of the turn about the mean specific force.
  double gain = 0;
  double spread = 0;          ///< interquartile range
  bool by_heading = false;    ///< false: by the direction of travel of the fixes, which not every body faces
  double compared_radps = 0;  ///< mean rate of the fastest compared turn, by heading
  double gyro_radps = 0;      ///< fastest mean rate over a second, about the mean specific force, at any time
};

TurnGain turn_gain_of(Window window);

enum class TurnFault : std::uint8_t {
  none,        ///< or not known
  wrong_sign,  ///< sign of gyroscope or accelerometer
  dead,        ///< the axis does not sense turns
  degrees,     ///< seems to be in deg/s
  scale,
};

TurnFault turn_fault_of(const TurnGain& turn);

}  // namespace sonopose::motion
