#pragma once
/// \file
/// Reads rows and cells of a CSV file, with errors that name the position.

#include "csv/header.hpp"
#include "csv/layout.hpp"
#include "files/line_reader.hpp"
#include <sonopose/samples/samples.hpp>

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace sonopose::csv {

/// Reads the columns of a layout by their names in the header, in any order and unit. A column is identified
/// by its index in the layout, and its values are in the unit of the layout. In a table with given names,
/// `NaN` and the like are empty cells, and a separator may end a row. The line below the names may have their
/// units.
class Reader {
public:
  /// Opens the file and reads its header: the first of its lines that begin with `#` or `%` and have the
  /// required columns, or else the first line that does not begin so; in a table with given names the last
  /// before the values. Later lines that begin with `#` or `%` are comments. A first line `sep=;` is skipped.
  /// Logs a warning about columns that the layout does not have.
  Reader(const std::filesystem::path& file, Layout layout);

  /// Advances to the next row that is not blank and belongs to the layout. Returns false at the end.
  bool next_row();

  /// Estimated number of rows, if all were as long as the current one.
  [[nodiscard]] std::size_t rows_like_this() const { return lines_.lines_like(row_); }

  /// Cells of the current row. A cell beyond the row's end, or of a column that the file lacks, is empty.
  [[nodiscard]] bool is_empty(std::size_t column) const { return cell(column).empty(); }
  [[nodiscard]] std::string_view text(std::size_t column) const { return cell(column); }
  /// Time in 1 … 2^62 − 1: a number, or a date as of clocks::utc_time_ns. Without a unit in the header a
  /// number is in nanoseconds, or in seconds if the first row with a time other than 0 has decimals of one
  /// below 1e12.
  [[nodiscard]] TimeNs time_ns(std::size_t column) const;
  [[nodiscard]] double number(std::size_t column) const;
  [[nodiscard]] std::optional<double> optional_number(std::size_t column) const;
  [[nodiscard]] Vector3d vector(std::size_t first_column) const;
  /// Returns a number that the layout has in another unit; see units.hpp.
  [[nodiscard]] double number_in(long double unit, std::size_t column) const;

  /// Returns true if the header has the column.
  [[nodiscard]] bool has(std::size_t column) const;
  /// Number of cells that are filled.
  [[nodiscard]] std::size_t filled(std::size_t first_column, std::size_t count) const;
  /// Returns true if all cells are filled, false if all are empty. Throws files::IoError otherwise.
  [[nodiscard]] bool all_filled(std::size_t first_column, std::size_t count) const;

  /// Throws files::IoError with file, line, column and its value.
  [[noreturn]] void fail(std::size_t column, std::string_view what) const;

private:
  [[noreturn]] void fail_line(std::string_view what) const;
  [[nodiscard]] std::string_view cell(std::size_t column) const {
    const std::size_t place = header_.place(column);
    return place < cells_.size() ? cells_[place] : std::string_view{};
  }
  [[nodiscard]] std::string position() const { return name_ + ":" + std::to_string(lines_.number()); }
  void read_header();
  bool read_row();
  std::optional<std::string_view> next_line();
  void detect_seconds();
  [[nodiscard]] TimeNs other_time_ns(std::size_t column) const;
  [[nodiscard]] TimeNs nanoseconds() const;
  std::string_view with_points(std::string_view line);

  std::string name_;
  Layout layout_;
  files::LineReader lines_;
  Header header_;
  std::size_t reader_ = 0;                    ///< index in ColumnNames
  std::unique_ptr<std::string> read_ahead_;   ///< first row; at the same place after a move
  std::unique_ptr<std::string> decimal_row_;  ///< current row with decimal points, likewise
  std::string_view row_;
  std::string_view written_row_;  ///< the same with decimal commas
  std::array<std::string_view, 64> cells_{};
  bool is_unit_of_time_open_ = true;
};

}  // namespace sonopose::csv
