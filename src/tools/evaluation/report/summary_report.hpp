#pragma once
/// \file
/// Writes summaries of scored cases as text and as JSON.

#include "evaluation/replay/evaluation.hpp"

#include <string>
#include <vector>

namespace sonopose::evaluation {

/// Two aligned tables with headers: errors against the truth, a row at the end of each case, and prediction
/// errors at the end. "-" is an unknown value.
class SummaryTable {
public:
  /// `name_columns`: length of the longest name.
  explicit SummaryTable(std::size_t name_columns);

  /// Returns the line of one case, the first time below the header.
  std::string add(Summary summary);

  /// Returns the table of prediction errors.
  [[nodiscard]] std::string predictions() const;

  [[nodiscard]] const std::vector<Summary>& rows() const { return rows_; }

private:
  std::size_t width_;
  std::vector<Summary> rows_;
};

/// Writes summaries as a JSON array, with the prediction errors of each run; null for unknown values.
std::string json_of(const std::vector<Summary>& summaries);

}  // namespace sonopose::evaluation
