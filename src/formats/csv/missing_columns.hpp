#pragma once
/// \file
/// Errors about a header that lacks columns.

#include "files/error.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace sonopose::csv {

/// A column that the header lacks, and names in the header that it could be.
struct MissingColumn {
  std::string column;  ///< without unit
  std::vector<std::string> candidates;
};

/// Required columns are not in the header.
class MissingColumns : public files::IoError {
public:
  /// `unknown`: columns of the header that the layout does not have.
  MissingColumns(const std::string& where, const std::vector<std::string_view>& columns,
                 std::string_view header, const std::vector<std::string>& unknown);
  /// The columns of two headers.
  MissingColumns(const MissingColumns& one, const MissingColumns& other);

  [[nodiscard]] const std::vector<MissingColumn>& columns() const { return columns_; }

private:
  std::vector<MissingColumn> columns_;
};

/// A table without a line of names.
class NoNames : public files::IoError {
public:
  /// `columns`: the required ones.
  NoNames(const std::string& where, const std::vector<std::string_view>& columns, std::string_view header);
};

}  // namespace sonopose::csv
