#pragma once
/// \file
/// What the fits have in common. Private to this folder.

#include "calibration/fit/least_squares.hpp"
#include "calibration/fit/error.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <string_view>

namespace sonopose::calibration::detail {

/// A number as text in few digits.
inline std::string text_of(double value) {
  std::array<char, 32> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6);
  return {text.data(), error == std::errc{} ? end : text.data()};
}

/// Which value its setting may not have, and what follows; empty where there is none.
template <class Group>
std::string out_of_range(const Group& group) {
  std::string found;
  const auto check = [&](const auto& row) {
    const double value = group.*(row.field);
    if (!found.empty() || (value >= row.minimum && value <= row.maximum)) return;
    found = std::string(Group::group) + "." + std::string(row.name) + " comes out as " + text_of(value) +
            ", where " + text_of(row.minimum) + " … " + text_of(row.maximum) +
            " is allowed: the recording's numbers are not those of this sensor in " +
            (row.unit.empty() ? "its unit" : std::string(row.unit));
  };
  Group::declarations()([&check](const auto&... row) { (check(row), ...); });
  return found;
}

/// Throws CalibrationError for a value that its setting may not have.
template <class Group>
void check_ranges(const Group& group) {
  const std::string found = out_of_range(group);
  if (!found.empty()) throw CalibrationError(found);
}

/// The parameter that the residuals tell least about.
template <std::size_t count>
std::string_view weakest_of(const Solution& solution, const std::array<std::string_view, count>& names) {
  Eigen::Index place = 0;
  solution.weakest.cwiseAbs().maxCoeff(&place);
  return names[static_cast<std::size_t>(place)];
}

}  // namespace sonopose::calibration::detail
