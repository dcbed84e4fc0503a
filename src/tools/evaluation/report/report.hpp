#pragma once
/// \file
/// Reports the result of a run as text and as JSON.

#include "evaluation/replay/run.hpp"

#include <string>

namespace sonopose::evaluation {

/// Durations of a run, measured by the program with the host's clock.
struct Timing {
  double reading_s = 0;
  double running_s = 0;
};

/// Writes a few aligned lines with units.
std::string report_text(const RunResult& result, const Timing& timing);

/// Writes one JSON object; null for values that need a missing truth.
std::string report_json(const RunResult& result, const Timing& timing);

}  // namespace sonopose::evaluation
