#pragma once
/// \file
/// The doctor's report as text and as JSON.

#include "doctor/rules/diagnosis.hpp"

#include <string>
#include <vector>

namespace sonopose::doctor::rules {

/// "ok", "note", "warning" or "error".
const char* text_of(Severity severity);

/// Formats one line per problem with its remedy below it, the most severe last, then the number of problems.
/// Findings without a problem share one line, and so do equal notes; `is_verbose` prints each separately.
std::string report_of(std::vector<Finding> findings, bool is_verbose = false);

/// {"ok": …, "findings": [{"severity", "subject", "what", "remedy"}]}, on one line without a newline.
std::string json_of(std::vector<Finding> findings);

}  // namespace sonopose::doctor::rules
