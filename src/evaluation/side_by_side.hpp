#pragma once
/// \file
/// Two sets of settings on the same cases.

#include <string>
#include <vector>

namespace sonopose::evaluation {

/// The costs of one case with both settings (see cost_of).
struct CostPair {
  std::string name;
  bool has_truth = false;  ///< otherwise the costs are prediction errors
  double first_m = 0;
  double second_m = 0;

  /// Of the second over the first, minus 1: negative if the second is better.
  [[nodiscard]] double change() const { return second_m / first_m - 1.0; }
};

/// The change over several cases.
struct Change {
  double mean = 0;  ///< of the geometric mean
  /// The standard error of the mean, from the spread over the cases; NaN for a single case. A change of less
  /// than twice this may be chance.
  double standard_error = 0;
};

/// `costs` must not be empty.
Change change_of(const std::vector<CostPair>& costs);

/// An aligned table with the change of each case and of all.
std::string table_of(const std::vector<CostPair>& costs, const std::string& first, const std::string& second);

/// {"first": …, "second": …, "cases": [{…}], "change": …, "standard_error": …}
std::string json_of(const std::vector<CostPair>& costs, const std::string& first, const std::string& second);

}  // namespace sonopose::evaluation
