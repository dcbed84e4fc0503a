#pragma once
/// \file
/// Names that a user gives to columns, and what the readers of files found by them.

#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::csv {

/// Names that the user gives to columns of a file.
struct ColumnNames {
  /// Names in the layout, with or without unit (`x [mm]`), by those in the header, which may follow the file
  /// that they hold for: `imu.csv:t`.
  std::map<std::string, std::string> own_by_given;
  std::set<std::string> found;  ///< given names that a header had
  /// Names in the header of each reader in turn, by those in the layout, without units.
  std::vector<std::map<std::string, std::string>> columns_by_reader = {};
  std::vector<std::filesystem::path> file_by_reader = {};
  std::set<std::size_t> readers_in_seconds = {};  ///< those that took times without a unit for seconds
  std::map<std::string, std::size_t> titles_by_file = {};  ///< number of lines above the header
  /// Columns of each file that one of its readers does not use, instead of a warning.
  std::map<std::string, std::vector<std::vector<std::string>>> unused_by_file = {};

  /// The given name of a column, and its name in the layout; null if it has none.
  [[nodiscard]] const std::pair<const std::string, std::string>* find(const std::filesystem::path& file,
                                                                      const std::string& name) const;
  /// The option that gives a unit to a column that a reader found. Names the file if it is not the only one.
  [[nodiscard]] std::string option(std::size_t reader, const std::string& column,
                                   std::string_view unit) const;
};

}  // namespace sonopose::csv
