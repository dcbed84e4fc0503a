#pragma once
/// \file
/// Compares two sets of settings on the same cases.

#include <cstddef>
#include <string>
#include <vector>

namespace sonopose::evaluation {

/// The costs of one case with both settings (see cost_of).
struct CostPair {
  std::string name;
  bool has_truth = false;  ///< true: errors against the truth; false: prediction errors
  double first_m = 0;
  double second_m = 0;

  /// Relative change from the first to the second cost: negative if the second is better.
  [[nodiscard]] double change() const { return second_m / first_m - 1.0; }
};

/// The change over several cases of one kind: with truth, or without.
struct Change {
  std::size_t cases = 0;
  double mean = 0;  ///< relative change of the geometric mean
  /// Standard error of the mean, from the spread over the cases; NaN for a single case.
  double standard_error = 0;
};

Change change_of(const std::vector<CostPair>& costs, bool has_truth);

/// Writes an aligned table with the change of each case, and of all with truth and all without.
std::string table_of(const std::vector<CostPair>& costs, const std::string& first, const std::string& second);

/// Writes {"first": …, "second": …, "cases": [{…}], "with_truth": {…}, "without_truth": {…}}; null: no such
/// case.
std::string json_of(const std::vector<CostPair>& costs, const std::string& first, const std::string& second);

}  // namespace sonopose::evaluation
