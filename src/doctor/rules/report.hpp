#pragma once
/// \file
/// The doctor's words: for people, and as JSON.

#include "doctor/rules/doctor.hpp"

#include <string>
#include <vector>

namespace sonopose::doctor {

/// "ok", "note", "warning" or "error".
const char* text_of(Severity severity);

/// A line per finding with what to do below it, the worst last, and a line that counts them.
std::string report_of(std::vector<Finding> findings);

/// {"wrong": …, "findings": [{"severity", "subject", "what", "remedy"}]}, on one line without a newline.
std::string json_of(const std::vector<Finding>& findings);

}  // namespace sonopose::doctor
