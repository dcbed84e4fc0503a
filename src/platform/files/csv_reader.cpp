#include "files/csv_reader.hpp"

#include "files/error.hpp"
#include "files/units.hpp"

#include <charconv>
#include <system_error>

namespace sonopose::files {

namespace {

std::string_view trimmed(std::string_view text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

std::string expected_columns(const CsvLayout& layout) {
  const std::string most = std::to_string(layout.columns.size());
  if (layout.min_columns == layout.columns.size()) return most;
  return std::to_string(layout.min_columns) + " to " + most;
}

}  // namespace

CsvReader::CsvReader(const std::filesystem::path& file, const CsvLayout& layout)
    : name_{file.string()}, layout_{layout}, lines_{file} {
  read_header();
}

void CsvReader::read_header() {
  const auto line = lines_.next();
  if (!line) throw IoError(name_ + ": is empty; expected a header line that begins with #");
  if (!line->starts_with('#')) {
    fail_line("expected a header line that begins with #, found \"" + std::string(*line) + "\"");
  }
  header_columns_ = split(*line);
  if (header_columns_ < layout_.min_columns || header_columns_ > layout_.columns.size()) {
    fail_line("the header has " + std::to_string(header_columns_) + " columns instead of " +
              expected_columns(layout_));
  }
}

bool CsvReader::next_row() {
  do {
    const auto line = lines_.next();
    if (!line) return false;
    row_ = trimmed(*line);
  } while (row_.empty());
  const std::size_t count = split(row_);
  const std::size_t min_count = layout_.short_rows ? layout_.min_columns : header_columns_;
  if (count < min_count || count > header_columns_) {
    fail_line("has " + std::to_string(count) + " columns where the header has " +
              std::to_string(header_columns_));
  }
  return true;
}

std::size_t CsvReader::split(std::string_view line) {
  cells_.fill({});
  std::size_t count = 0;
  for (;;) {
    const std::size_t comma = line.find(',');
    if (count < cells_.size()) cells_[count] = trimmed(line.substr(0, comma));
    ++count;
    if (comma == std::string_view::npos) return count;
    line.remove_prefix(comma + 1);
  }
}

TimeNs CsvReader::time_ns(std::size_t column) const {
  const std::string_view text = cell(column);
  TimeNs value = 0;
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc{} || result.ptr != end) fail(column, "is not a time in whole nanoseconds");
  // The difference of any two times then fits into 64 bits.
  constexpr TimeNs too_late = TimeNs{1} << 62U;
  if (value <= 0 || value >= too_late) fail(column, "is not a time between 1 and 2^62 - 1 ns");
  return value;
}

double CsvReader::number(std::size_t column) const {
  const auto value = parse_number(cell(column));
  if (!value) fail(column, "is not a number");
  return *value;
}

std::optional<double> CsvReader::optional_number(std::size_t column) const {
  if (is_empty(column)) return std::nullopt;
  return number(column);
}

Vector3d CsvReader::vector(std::size_t first_column) const {
  return {number(first_column), number(first_column + 1), number(first_column + 2)};
}

double CsvReader::number_in(long double unit, std::size_t column) const {
  const auto value = parse_number_in(unit, cell(column));
  if (!value) fail(column, "is not a number");
  return *value;
}

bool CsvReader::all_filled(std::size_t first_column, std::size_t count) const {
  const bool first_empty = is_empty(first_column);
  for (std::size_t column = first_column + 1; column < first_column + count; ++column) {
    if (is_empty(column) == first_empty) continue;
    fail(is_empty(column) ? column : first_column, "is empty but its neighbours are not");
  }
  return !first_empty;
}

void CsvReader::fail(std::size_t column, std::string_view what) const {
  fail_line("column " + std::to_string(column + 1) + " (" + std::string(layout_.columns[column]) + "): \"" +
            std::string(cell(column)) + "\" " + std::string(what));
}

void CsvReader::fail_line(std::string_view what) const {
  throw IoError(name_ + ":" + std::to_string(lines_.number()) + ": " + std::string(what));
}

}  // namespace sonopose::files
