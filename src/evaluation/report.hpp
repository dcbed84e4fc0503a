#pragma once
/// \file
/// Reports the result of a run as text and as JSON.

#include "evaluation/run.hpp"

#include <string>

namespace sonopose::evaluation {

/// Duration of a run, measured by the program with the host's clock.
struct Timing {
  double reading_s = 0;
  double running_s = 0;
};

/// A few aligned lines with units.
std::string report_text(const RunResult& result, const Timing& timing);

/// One JSON object; null for values that need a truth where there is none.
std::string report_json(const RunResult& result, const Timing& timing);

}  // namespace sonopose::evaluation
