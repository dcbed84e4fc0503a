#pragma once
/// \file
/// Summaries of scored cases as text and as JSON.

#include "evaluation/evaluation.hpp"

#include <string>
#include <vector>

namespace sonopose::evaluation {

/// Two aligned tables with headers: errors against the truth, of the cases that have one, and prediction
/// errors. "-" is a value that is not known.
std::string table_of(const std::vector<Summary>& summaries);

/// Summaries as a JSON array, with the prediction errors of each run; null for values that are not known.
std::string json_of(const std::vector<Summary>& summaries);

}  // namespace sonopose::evaluation
