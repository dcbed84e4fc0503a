#pragma once
/// \file
/// Reads rows and cells of a CSV file, with errors that name the position.

#include "files/line_reader.hpp"
#include <sonopose/samples/samples.hpp>

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sonopose::files {

struct CsvLayout {
  std::span<const std::string_view> columns;  ///< names with units, for headers and errors
  std::size_t min_columns = 0;                ///< number of required columns; further ones are optional
  bool short_rows = false;                    ///< rows may have fewer columns than the header
};

class CsvReader {
public:
  /// Opens the file and reads its header line.
  CsvReader(const std::filesystem::path& file, const CsvLayout& layout);

  /// Advances to the next row that is not blank. Returns false at the end.
  bool next_row();

  /// Estimated number of rows, if all were as long as the current one.
  [[nodiscard]] std::size_t rows_like_this() const { return lines_.lines_like(row_); }

  /// Cells of the current row. A cell beyond the row's end is empty.
  [[nodiscard]] bool is_empty(std::size_t column) const { return cell(column).empty(); }
  [[nodiscard]] TimeNs time_ns(std::size_t column) const;  ///< time in 1 … 2^62 − 1
  [[nodiscard]] double number(std::size_t column) const;
  [[nodiscard]] std::optional<double> optional_number(std::size_t column) const;
  [[nodiscard]] Vector3d vector(std::size_t first_column) const;
  /// Returns a number that the file stores in another unit; see units.hpp.
  [[nodiscard]] double number_in(long double unit, std::size_t column) const;

  /// Returns true if all cells are filled, false if all are empty. Throws IoError otherwise.
  [[nodiscard]] bool all_filled(std::size_t first_column, std::size_t count) const;

  /// Throws IoError with file, line, column and its value.
  [[noreturn]] void fail(std::size_t column, std::string_view what) const;

private:
  static constexpr std::size_t max_columns = 24;

  [[noreturn]] void fail_line(std::string_view what) const;
  [[nodiscard]] std::string_view cell(std::size_t column) const { return cells_[column]; }
  void read_header();
  /// Returns the number of cells in the line; stores at most `max_columns`.
  std::size_t split(std::string_view line);

  std::string name_;
  CsvLayout layout_;
  LineReader lines_;
  std::string_view row_;
  std::size_t header_columns_ = 0;
  std::array<std::string_view, max_columns> cells_{};
};

}  // namespace sonopose::files
