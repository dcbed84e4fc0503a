#pragma once
/// \file
/// Summaries of scored cases as text and as JSON.

#include "evaluation/evaluation.hpp"

#include <string>
#include <vector>

namespace sonopose::evaluation {

/// Two aligned tables with headers: errors against the truth, a row as soon as a case ends, and prediction
/// errors at the end. "-" is a value that is not known.
class SummaryTable {
public:
  /// `name_columns`: the length of the longest name.
  explicit SummaryTable(std::size_t name_columns);

  /// The lines of one case, after the header if it is the first one that needs it.
  std::string add(Summary summary);

  /// The second table.
  [[nodiscard]] std::string predictions() const;

  [[nodiscard]] const std::vector<Summary>& rows() const { return rows_; }

private:
  std::size_t width_;
  bool has_header_ = false;
  std::vector<Summary> rows_;
};

/// Summaries as a JSON array, with the prediction errors of each run; null for values that are not known.
std::string json_of(const std::vector<Summary>& summaries);

}  // namespace sonopose::evaluation
