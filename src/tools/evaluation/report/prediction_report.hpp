#pragma once
/// \file
/// Writes prediction errors as text and as JSON.

#include "evaluation/score/prediction_errors.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace sonopose::evaluation {

/// Writes a few aligned lines with units.
std::string prediction_text(const PredictionScore& score);

/// Writes an object; null for unknown values.
nlohmann::ordered_json prediction_json(const PredictionScore& score);

}  // namespace sonopose::evaluation
