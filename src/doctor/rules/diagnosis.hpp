#pragma once
/// \file
/// From observations of a system to findings: problems and their remedies. Pure functions.

#include "doctor/rules/observations.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::doctor::rules {

enum class Severity : std::uint8_t { ok, note, warning, error };

struct Finding {
  Severity severity = Severity::ok;
  std::string subject;  ///< "sonopose/pose", "line /dev/ttyACM0", "beacon 7"
  std::string what;     ///< a sentence
  std::string remedy;   ///< what the user can do; may be empty
};

/// All findings, in the order bus, topics, lines, beacons.
std::vector<Finding> diagnose(const Observations& observations);

/// Whether there is a warning or an error.
bool has_problems(const std::vector<Finding>& findings);

}  // namespace sonopose::doctor::rules
