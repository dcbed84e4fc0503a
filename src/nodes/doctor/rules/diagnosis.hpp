#pragma once
/// \file
/// Derives findings, problems and their remedies, from observations of a system. Pure functions.

#include "doctor/rules/observations.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::doctor::rules {

enum class Severity : std::uint8_t { ok, note, warning, error };

struct Finding {
  Severity severity = Severity::ok;
  std::string subject;  ///< "sonopose/pose", "line /dev/ttyACM0", "beacon 7"
  std::string what;     ///< one sentence
  std::string remedy;   ///< advice for the user; may be empty
};

/// All findings, in the order bus, topics, lines, beacons.
std::vector<Finding> diagnose(const Observations& observations);

/// True if there is a warning or an error.
bool has_problems(const std::vector<Finding>& findings);

}  // namespace sonopose::doctor::rules
