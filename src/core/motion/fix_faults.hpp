#pragma once
/// \file
/// Faults of fixes and headings that need no fit of the motion.

#include "motion/turn_gain.hpp"
#include "motion/window.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::motion {

enum class FixFaultKind : std::uint8_t {
  unit,                 ///< positions are not in metres
  default_position,     ///< some fixes are a value instead of a position
  repeated,             ///< the source sends each position several times
  frozen,               ///< a long run of one position, or all
  headings_in_radians,  ///< read as degrees
  headings_constant,    ///< a value that nobody measured
};

struct FixFault {
  FixFaultKind kind = FixFaultKind::unit;
  std::string text;
};

/// Removes the fixes that are a value instead of a position, to which the others jump again and again.
/// Returns a text such as "40 of 200 fixes are 0 0 0 m, a default position"; empty if there is none.
std::optional<std::string> remove_default_position(std::vector<Position>& fixes);

/// The faults of a window with right readings, whose turns are these. Its streams are in order of time.
std::vector<FixFault> fix_faults_of(const Window& window, const TurnGain& turn);

/// True if most fixes extend over more than a metre.
bool are_moving(const std::vector<Position>& fixes);

}  // namespace sonopose::motion
