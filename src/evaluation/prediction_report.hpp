#pragma once
/// \file
/// Prediction errors as text and as JSON.

#include "evaluation/prediction_errors.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace sonopose::evaluation {

/// A few aligned lines with units.
std::string prediction_text(const PredictionScore& score);

/// An object; null for values that are not known.
nlohmann::ordered_json prediction_json(const PredictionScore& score);

}  // namespace sonopose::evaluation
