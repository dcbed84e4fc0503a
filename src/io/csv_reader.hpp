#pragma once
/// \file
/// Rows and cells of one CSV file, with errors that name the place. Private to this room.
///
/// Lines come from fast-cpp-csv-parser's LineReader. Its own column parsing is not used: it knows no empty
/// cells, cannot read a number back to the same bits, and compares header words.

#include <sonopose/core/samples.hpp>

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace io {
class LineReader;
}  // namespace io

namespace sonopose::io {

/// What a file may hold.
struct CsvLayout {
  std::span<const std::string_view> columns;  ///< names with units, as they stand in headers and errors
  std::size_t least_columns = 0;              ///< the others may be absent
  bool short_rows = false;                    ///< a row may end before the header does
};

class CsvReader {
public:
  /// Opens the file and reads its header line.
  CsvReader(const std::filesystem::path& file, const CsvLayout& layout);
  ~CsvReader();
  CsvReader(const CsvReader&) = delete;
  CsvReader& operator=(const CsvReader&) = delete;
  CsvReader(CsvReader&&) = delete;
  CsvReader& operator=(CsvReader&&) = delete;

  /// Steps to the next row that is not blank; false at the end.
  bool next_row();

  /// Cells of the current row. A cell beyond the row's end is empty.
  [[nodiscard]] bool is_empty(std::size_t column) const { return cell(column).empty(); }
  [[nodiscard]] TimeNs time_ns(std::size_t column) const;
  [[nodiscard]] double number(std::size_t column) const;
  [[nodiscard]] std::optional<double> optional_number(std::size_t column) const;
  [[nodiscard]] Vector3d vector(std::size_t first_column) const;
  /// A number that stands in the file in another unit; see units.hpp.
  [[nodiscard]] double number_in(long double unit, std::size_t column) const;

  /// True if the cells are all filled, false if they are all empty; anything between is an error.
  [[nodiscard]] bool all_filled(std::size_t first_column, std::size_t count) const;

  /// Throws IoError with file, line, column and its value.
  [[noreturn]] void fail(std::size_t column, std::string_view what) const;

private:
  static constexpr std::size_t most_columns = 24;

  [[noreturn]] void fail_line(std::string_view what) const;
  [[nodiscard]] std::string_view cell(std::size_t column) const { return cells_[column]; }
  void read_header();
  const char* next_line();  ///< null at the end
  /// Number of cells in the line; only the first ones are kept.
  std::size_t split(std::string_view line);

  std::string name_;
  CsvLayout layout_;
  std::unique_ptr<::io::LineReader> lines_;
  std::size_t header_columns_ = 0;
  std::array<std::string_view, most_columns> cells_{};
};

}  // namespace sonopose::io
