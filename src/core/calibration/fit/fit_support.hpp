#pragma once
/// \file
/// Helpers shared by the fits. Private to this folder.

#include "calibration/fit/error.hpp"
#include "calibration/fit/least_squares.hpp"
#include "calibration/fit/terms.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <string_view>

namespace sonopose::calibration::fit::detail {

/// Formats a number with few digits.
inline std::string text_of(double value) {
  std::array<char, 32> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6);
  return {text.data(), error == std::errc{} ? end : text.data()};
}

/// Throws CalibrationError for a number that its setting does not allow.
template <class Model>
void check_ranges(const Model& model) {
  const std::string found = out_of_range(terms_of(model));
  if (!found.empty()) throw CalibrationError(found);
}

/// Name of the parameter that the residuals determine least.
template <std::size_t count>
std::string_view weakest_of(const Solution& solution, const std::array<std::string_view, count>& names) {
  Eigen::Index place = 0;
  solution.weakest.cwiseAbs().maxCoeff(&place);
  return names[static_cast<std::size_t>(place)];
}

}  // namespace sonopose::calibration::fit::detail
