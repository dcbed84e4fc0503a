#include "csv/reader.hpp"

#include "clocks/utc_time.hpp"
#include "csv/cells.hpp"
#include "csv/column_units.hpp"
#include "csv/units.hpp"
#include "files/error.hpp"
#include "logging/log.hpp"
#include <sonopose/text/escaped.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <system_error>
#include <utility>
#include <vector>

namespace sonopose::csv {
namespace {

/// True for a word that programs write for a missing value.
bool is_absent(std::string_view text) {
  constexpr std::array<std::string_view, 18> words{
      "nan", "NaN", "NAN",  "NA",    "null",   "NULL",    "None",    "none",  "n/a",
      "N/A", "-",   "#N/A", "#NUM!", "#NULL!", "#DIV/0!", "#VALUE!", "#REF!", "#NAME?"};
  return std::ranges::find(words, text) != words.end();
}

/// True for a comment. The first cell may also be what a spreadsheet writes for a missing value.
bool is_comment(std::string_view line) {
  return is_marked(line) && !is_absent(line.substr(0, line.find_first_of(",;\t ")));
}

/// True for a line such as `Start: 2026-01-31 12:00:00`.
bool has_key(std::string_view line) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || colon > line.find_first_of("0123456789,;\t")) return false;
  return colon + 1 == line.size() || line[colon + 1] == ' ';
}

/// True for a row of values: its first cell, or most, begin as numbers and dates do, or are missing. Names
/// and titles are words.
bool has_values(std::string_view line) {
  std::size_t cells = 0;
  std::size_t values = 0;
  bool begins_with_value = false;
  split_cells(separator_of(line), line, [&](std::size_t index, std::string_view cell) {
    if (cell.empty()) return;
    const bool is_value =
        std::string_view("+-.0123456789").find(cell.front()) != std::string_view::npos || is_absent(cell);
    ++cells;
    if (is_value) ++values;
    if (index == 0) begins_with_value = is_value;
  });
  return begins_with_value || (2 * values > cells && !has_key(line)) || cells == 0;
}

std::size_t cells_in(std::string_view line) {
  return split_cells(separator_of(line), line, [](auto, auto) {});
}

}  // namespace

Reader::Reader(const std::filesystem::path& file, Layout layout)
    : name_{file.string()}, layout_{std::move(layout)}, lines_{file} {
  layout_.file = name_;
  read_header();
}

void Reader::read_header() {
  std::exception_ptr refusal;  // of a comment
  bool is_found = false;
  std::size_t titles = 0;
  std::optional<std::string_view> line = next_line();
  if (line && unquoted(*line).starts_with("sep=")) line = next_line();  // for spreadsheets
  while (!is_found) {
    if (!line && !refusal)
      throw files::IoError(name_ + ": is empty; expected a header line with the names of the columns");
    // Below a comment, a row of numbers is not the header.
    if (!line || (refusal && parse_number(line->substr(0, line->find_first_not_of("+-.0123456789eE")))))
      std::rethrow_exception(refusal);
    const std::string names(*line);
    const std::string where = position();
    // Reads on before it judges: an error of the file ends the search, a line that is no header does not.
    line = next_line();
    const bool has_units = line && is_line_of_units(names, *line);
    const bool is_title =
        layout_.given_names != nullptr && line && !has_units && !is_marked(*line) && !has_values(*line);
    const auto skip = [&] {
      if (!is_marked(names)) ++titles;
    };
    if (is_title && cells_in(*line) > cells_in(names)) {
      skip();
      continue;
    }
    try {
      header_ = Header(layout_, names, where, has_units ? *line : std::string_view{});
      is_found = true;
    } catch (const files::IoError&) {
      if (!is_marked(names) && !is_title) throw;
      if (is_marked(names)) refusal = std::current_exception();
      skip();
    }
    if (is_found && has_units) line = next_line();
  }
  if (titles > 0) layout_.given_names->titles_by_file[name_] = titles;
  if (line) read_ahead_ = std::make_unique<std::string>(*line);
  if (header_.width() > cells_.size()) {
    throw files::IoError(name_ + ": the header has " + std::to_string(header_.width()) +
                         " columns; at most " + std::to_string(cells_.size()) + " are read");
  }
  if (layout_.given_names != nullptr) {
    layout_.given_names->unused_by_file[name_].push_back(header_.unknown());
    reader_ = layout_.given_names->columns_by_reader.size() - 1;
    return;
  }
  std::string unknown;
  for (const std::string& name : header_.unknown()) unknown += (unknown.empty() ? "" : ", ") + name;
  if (!unknown.empty()) logging::warning(name_ + ": columns that are not used: " + text::escaped(unknown));
}

/// The next line that is not blank.
std::optional<std::string_view> Reader::next_line() {
  for (auto line = lines_.next(); line; line = lines_.next()) {
    if (!trimmed(*line).empty()) return trimmed(*line);
  }
  return std::nullopt;
}

bool Reader::next_row() {
  while (read_row()) {
    if (layout_.last_value.empty() || text(layout_.columns.size() - 1) == layout_.last_value) return true;
  }
  return false;
}

bool Reader::read_row() {
  const bool is_first = row_.empty();
  std::optional<std::string_view> line = is_first && read_ahead_ ? *read_ahead_ : next_line();
  while (line && is_comment(*line)) line = next_line();
  if (!line) return false;
  written_row_ = *line;
  row_ = header_.separator() == ';' ? with_points(*line) : *line;
  cells_.fill({});
  const bool is_table = layout_.given_names != nullptr;
  std::size_t filled = 0;
  std::size_t count = split_cells(header_.separator(), row_, [&](std::size_t index, std::string_view text) {
    if (!text.empty()) filled = index + 1;
    if (index < cells_.size() && !(is_table && is_absent(text))) cells_[index] = text;
  });
  if (is_table) count = std::min(count, std::max(filled, header_.width()));  // a separator may end the row
  if (count > header_.width() || count < header_.required_width()) {
    fail_line("has " + std::to_string(count) + " columns where the header has " +
              std::to_string(header_.width()));
  }
  if (is_unit_of_time_open_) detect_seconds();
  return true;
}

/// A row in which decimal commas, as between semicolons, are points.
std::string_view Reader::with_points(std::string_view line) {
  if (line.find(',') == std::string_view::npos) return line;
  decimal_row_ = std::make_unique<std::string>(line);
  std::ranges::replace(*decimal_row_, ',', '.');
  return *decimal_row_;
}

void Reader::detect_seconds() {
  std::vector<std::size_t> times;
  for (std::size_t column = 0; column < layout_.columns.size(); ++column) {
    const bool is_time = unit_factor("s", header_.own_unit(column)).has_value();
    if (is_time && !header_.has_unit(column)) times.push_back(column);
  }
  is_unit_of_time_open_ = !times.empty() && std::ranges::all_of(times, [this](std::size_t column) {
    return parse_number(cell(column)).value_or(0.0) == 0.0;
  });
  const bool are_seconds = std::ranges::any_of(times, [this](std::size_t column) {
    constexpr double max_s = 1e12;
    const bool has_decimals = cell(column).find('.') != std::string_view::npos;
    return has_decimals && parse_number(cell(column)).value_or(max_s) < max_s;
  });
  if (!are_seconds) return;
  if (layout_.given_names != nullptr) layout_.given_names->readers_in_seconds.insert(reader_);
  for (const std::size_t column : times) header_.set_factor(column, *unit_factor("s", "ns"));
}

/// A time that is no whole number of nanoseconds: with a unit, with decimals, or a date.
TimeNs Reader::other_time_ns(std::size_t column) const {
  const std::string_view text = cell(column);
  const long double factor = header_.factor(column);
  const auto time = parse_long_number(text);
  if (!time) {
    const auto utc_ns = clocks::utc_time_ns(text);
    if (!utc_ns)
      fail(column, "is not a time: a number, or a date such as 2026-01-31 12:00:00.5 or 31.01.2026 12:00");
    return *utc_ns;
  }
  const long double time_ns = *time * factor;
  if (factor == 1.0L && time_ns != std::floor(time_ns)) fail(column, "is not a time in whole nanoseconds");
  const bool is_in_range = std::abs(time_ns) < static_cast<long double>(end_of_time_ns);
  return is_in_range ? std::llround(time_ns) : end_of_time_ns;
}

/// The nanoseconds of a time in two columns.
TimeNs Reader::nanoseconds() const {
  const std::size_t place = header_.nanoseconds_place();
  if (place == Header::missing) return 0;
  const auto number = parse_number(place < cells_.size() ? cells_[place] : std::string_view{});
  constexpr double second_ns = 1e9;
  if (!number || *number < 0.0 || *number >= second_ns || *number != std::floor(*number))
    fail(0, "has no nanoseconds in 0 … 999999999 beside it");
  return static_cast<TimeNs>(*number);
}

TimeNs Reader::time_ns(std::size_t column) const {
  const std::string_view text = cell(column);
  const long double factor = header_.factor(column);
  TimeNs value = 0;
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (factor != 1.0L || result.ec != std::errc{} || result.ptr != end) {
    value = other_time_ns(column);
  }
  if (column == 0) value = saturated_sum(value, nanoseconds());
  value = saturated_sum(value, layout_.time_offset_ns);
  if (value <= 0 || value >= end_of_time_ns) fail(column, "is not a time between 1 and 2^62 - 1 ns");
  return value;
}

double Reader::number(std::size_t column) const {
  const long double factor = header_.factor(column);
  const auto value = factor == 1.0L ? parse_number(cell(column)) : parse_number_in(factor, cell(column));
  if (!value) fail(column, "is not a number");
  return *value;
}

std::optional<double> Reader::optional_number(std::size_t column) const {
  if (is_empty(column)) return std::nullopt;
  return number(column);
}

Vector3d Reader::vector(std::size_t first_column) const {
  return {number(first_column), number(first_column + 1), number(first_column + 2)};
}

double Reader::number_in(long double unit, std::size_t column) const {
  const auto value = parse_number_in(unit * header_.factor(column), cell(column));
  if (!value) fail(column, "is not a number");
  return *value;
}

bool Reader::has(std::size_t column) const {
  return header_.place(column) != Header::missing;
}

std::size_t Reader::filled(std::size_t first_column, std::size_t count) const {
  std::size_t filled = 0;
  for (std::size_t column = first_column; column < first_column + count; ++column) {
    if (!is_empty(column)) ++filled;
  }
  return filled;
}

bool Reader::all_filled(std::size_t first_column, std::size_t count) const {
  const bool first_empty = is_empty(first_column);
  for (std::size_t column = first_column + 1; column < first_column + count; ++column) {
    if (is_empty(column) == first_empty) continue;
    fail(is_empty(column) ? column : first_column, "is empty but its neighbours are not");
  }
  return !first_empty;
}

void Reader::fail(std::size_t column, std::string_view what) const {
  if (header_.place(column) == Header::missing) {
    fail_line("has no column \"" + std::string(layout_.columns[column]) + "\": it " + std::string(what));
  }
  std::string_view written;  // with decimal commas, and with words for a missing value
  split_cells(header_.separator(), written_row_, [&](std::size_t index, std::string_view text) {
    if (index == header_.place(column)) written = text;
  });
  fail_line("column " + std::to_string(header_.place(column) + 1) + " (" + header_.name(column) + "): \"" +
            std::string(written) + "\" " + std::string(what));
}

void Reader::fail_line(std::string_view what) const {
  throw files::IoError(position() + ": " + std::string(what));
}

}  // namespace sonopose::csv
