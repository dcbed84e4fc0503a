#pragma once
/// \file
/// What a run has shown, for people and for programs.

#include "evaluation/run.hpp"

#include <string>

namespace sonopose::evaluation {

/// How long a run took by the host's clock, as the program measured it.
struct Timing {
  double reading_s = 0;
  double running_s = 0;
};

/// A few aligned lines with units.
std::string report_text(const RunResult& result, const Timing& timing);

/// One JSON object; null where there is no truth to compare with.
std::string report_json(const RunResult& result, const Timing& timing);

}  // namespace sonopose::evaluation
