#pragma once
/// \file
/// The header of a CSV file: which columns it has, and in which units.

#include "files/error.hpp"
#include <sonopose/samples/time.hpp>

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::files {

/// Another name of a column. A final `*` stands for an axis: `gyro*` for `gyro_x`, `gyro_y`, ….
struct ColumnSynonym {
  std::string_view name;  ///< lower case, without separators
  std::string_view own;   ///< the same for the name in the layout
};

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
  /// Columns of each file that one of its readers does not use, instead of a warning.
  std::map<std::string, std::vector<std::vector<std::string>>> unused_by_file = {};

  /// The given name of a column, and its name in the layout; null if it has none.
  [[nodiscard]] const std::pair<const std::string, std::string>* find(const std::filesystem::path& file,
                                                                      const std::string& name) const;
  /// The option that gives a unit to a column that a reader found. Names the file if it is not the only one.
  [[nodiscard]] std::string option(std::size_t reader, const std::string& column,
                                   std::string_view unit) const;
};

/// The columns that a file can have.
struct CsvLayout {
  std::span<const std::string_view> columns;  ///< names with units: `x [m]`
  std::size_t required_columns = 0;           ///< number of those, from the first, that a file must have
  std::span<const ColumnSynonym> synonyms{};
  ColumnNames* given_names = nullptr;  ///< these replace names in the header, and are marked as found
  TimeNs time_offset_ns = 0;           ///< added to each time
  std::string file{};                  ///< set by the reader
  std::string last_value{};            ///< only rows with this in the last column; empty: all rows
};

/// Returns true if the layout has a column of this name, with or without unit.
bool has_column(const CsvLayout& layout, std::string_view name);

/// A column that the header lacks, and names in the header that it could be.
struct MissingColumn {
  std::string column;  ///< without unit
  std::vector<std::string> candidates;
};

/// Required columns are not in the header.
class MissingColumns : public IoError {
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
class NoNames : public IoError {
public:
  using IoError::IoError;
};

/// Finds the columns of a layout in a header. Compares names without case, separators, the frames of EuRoC's
/// names (`w_RS_S_x`) and a path before them (`field.pose.position.x`). The axis may be first (`xacc`) or an
/// index (`gyro[0]`). A unit is in brackets or ends the name (`x_mm`); without one it is that of the layout.
/// A time may be two columns, as in ROS (`header.stamp.sec` and `header.stamp.nanosec`).
class CsvHeader {
public:
  static constexpr std::size_t max_columns = 24;  ///< of a layout
  static constexpr std::size_t missing = ~std::size_t{0};

  CsvHeader() = default;
  /// `where` precedes the text of an error: file and line. `units` is a line below the names that has their
  /// units, or empty. Throws IoError for a missing or repeated column and a wrong unit.
  CsvHeader(const CsvLayout& layout, std::string_view line, const std::string& where,
            std::string_view units = {});

  [[nodiscard]] char separator() const { return separator_; }
  [[nodiscard]] std::size_t width() const { return names_.size(); }
  /// Number of cells that a row must have: up to the last required column.
  [[nodiscard]] std::size_t required_width() const { return required_width_; }
  /// Place of a column of the layout in the rows, or `missing`.
  [[nodiscard]] std::size_t place(std::size_t column) const { return places_[column]; }
  /// Factor to the unit of the layout.
  [[nodiscard]] long double factor(std::size_t column) const { return factors_[column]; }
  void set_factor(std::size_t column, long double factor) { factors_[column] = factor; }
  /// Returns true if the header names the unit.
  [[nodiscard]] bool has_unit(std::size_t column) const { return has_unit_[column]; }
  /// Unit in the layout; empty without one.
  [[nodiscard]] std::string_view own_unit(std::size_t column) const { return own_units_[column]; }
  /// Name of a column of the layout as the header has it.
  [[nodiscard]] const std::string& name(std::size_t column) const { return names_[places_[column]]; }
  /// Place of the nanoseconds that are added to the first column of the layout, or `missing`.
  [[nodiscard]] std::size_t nanoseconds_place() const { return nanoseconds_place_; }
  /// Names of the columns that the layout does not have.
  [[nodiscard]] const std::vector<std::string>& unknown() const { return unknown_; }

private:
  void add_name(std::string_view cell);
  void rename(ColumnNames& given, const std::filesystem::path& file, const std::string& where);
  void add_units(std::string_view units);
  void join_seconds(const CsvLayout& layout);
  void match(const CsvLayout& layout, std::size_t place, const std::string& where);
  void set_unit(const CsvLayout& layout, std::size_t column, std::optional<std::string_view> unit,
                const std::string& where);
  void require_units(const CsvLayout& layout, const std::string& where) const;

  char separator_ = ',';
  bool is_open_ = false;  ///< the last name has an open bracket
  std::size_t required_width_ = 0;
  std::size_t seconds_place_ = missing;
  std::size_t nanoseconds_place_ = missing;
  std::vector<std::string> names_;
  std::vector<std::string> names_in_file_;  ///< before they were renamed
  std::vector<std::string> unknown_;
  std::array<std::size_t, max_columns> places_{};
  std::array<std::size_t, max_columns> ranks_{};  ///< of the name that was found: 0 is the best
  std::array<long double, max_columns> factors_{};
  std::array<bool, max_columns> has_unit_{};
  std::array<std::string_view, max_columns> own_units_{};
};

/// Returns true if the line below the names has units instead of values: "s, rad/s, m/s^2". A column that is
/// not used may have any words there.
bool is_line_of_units(std::string_view names, std::string_view line);

/// A text without spaces and tabs at its ends.
inline std::string_view trimmed(std::string_view text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// A text without quotation marks around it.
inline std::string_view unquoted(std::string_view text) {
  const bool is_quoted = text.size() > 1 && text.front() == '"' && text.back() == '"';
  return is_quoted ? text.substr(1, text.size() - 2) : text;
}

/// Splits a line; calls `on_cell(index, cell)` for each cell, and returns their number.
template <class OnCell>
std::size_t split_cells(char separator, std::string_view line, const OnCell& on_cell) {
  line = trimmed(line);
  for (std::size_t index = 0;; ++index) {
    const std::size_t end = separator == ' ' ? line.find_first_of(" \t") : line.find(separator);
    on_cell(index, unquoted(trimmed(line.substr(0, end))));
    if (end == std::string_view::npos) return index + 1;
    line.remove_prefix(end + 1);
    if (separator == ' ') line = trimmed(line);
  }
}

}  // namespace sonopose::files
