#pragma once
/// \file
/// The header of a CSV file: which columns it has, and in which units.

#include "csv/layout.hpp"

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::csv {

/// Finds the columns of a layout in a header. Compares names without case, separators, the frames of EuRoC's
/// names (`w_RS_S_x`) and a path before them (`field.pose.position.x`). The axis may be first (`xacc`) or an
/// index (`gyro[0]`). A unit is in brackets or ends the name (`x_mm`); without one it is that of the layout.
/// A time may be two columns, as in ROS (`header.stamp.sec` and `header.stamp.nanosec`).
class Header {
public:
  static constexpr std::size_t max_columns = 24;  ///< most columns of a layout
  static constexpr std::size_t missing = ~std::size_t{0};

  Header() = default;
  /// `where` precedes the text of an error: file and line. `units` is a line below the names that has their
  /// units, or empty. Throws files::IoError for a missing or repeated column and a wrong unit.
  Header(const Layout& layout, std::string_view line, const std::string& where, std::string_view units = {});

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
  void join_seconds(const Layout& layout);
  void match(const Layout& layout, std::size_t place, const std::string& where);
  void set_unit(const Layout& layout, std::size_t column, std::optional<std::string_view> unit,
                const std::string& where);
  void require_columns(const Layout& layout, std::string_view line, const std::string& where);
  void require_units(const Layout& layout, const std::string& where) const;

  char separator_ = ',';
  bool is_open_ = false;  ///< the last name has an open bracket
  std::size_t required_width_ = 0;
  std::size_t seconds_place_ = missing;
  std::size_t nanoseconds_place_ = missing;
  std::vector<std::string> names_;
  std::vector<std::string> names_in_file_;  ///< before they were renamed
  std::vector<std::string> unknown_;
  std::array<std::size_t, max_columns> places_{};
  std::array<std::size_t, max_columns> ranks_{};  ///< ranks of the names found: 0 is the best
  std::array<long double, max_columns> factors_{};
  std::array<bool, max_columns> has_unit_{};
  std::array<std::string_view, max_columns> own_units_{};
};

/// Returns true if the line below the names has units instead of values: "s, rad/s, m/s^2". A column that is
/// not used may have any words there.
bool is_line_of_units(std::string_view names, std::string_view line);

}  // namespace sonopose::csv
