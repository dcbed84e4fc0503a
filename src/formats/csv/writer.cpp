#include "csv/writer.hpp"

#include "csv/units.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <exception>
#include <utility>

namespace sonopose::csv {

namespace {

constexpr std::size_t full_buffer = std::size_t{1} << 16U;  ///< bytes

template <class Integer>
void append_integer(std::string& text, Integer value) {
  std::array<char, 24> digits{};
  const auto result = std::to_chars(digits.begin(), digits.end(), value);
  text.append(digits.data(), result.ptr);
}

}  // namespace

Writer::Writer(const std::filesystem::path& file, Existing existing, char separator)
    : file_{file, existing}, separator_{separator} {}

Writer::~Writer() {
  try {
    flush();
  } catch (const std::exception&) {  // a destructor cannot report errors
  }
}

void Writer::header(std::span<const std::string_view> columns) {
  lines_ += '#';
  for (const std::string_view column : columns) text(column);
  end_row();
}

Writer& Writer::integer(std::int64_t value) {
  begin_cell();
  append_integer(lines_, value);
  return *this;
}

Writer& Writer::number(double value) {
  begin_cell();
  append_number(lines_, value);
  return *this;
}

Writer& Writer::number_in(long double unit, double value) {
  begin_cell();
  append_number_in(unit, lines_, value);
  return *this;
}

Writer& Writer::known_number(double value) {
  return std::isnan(value) ? empty() : number(value);
}

Writer& Writer::vector(const Vector3d& value) {
  for (const double component : value) number(component);
  return *this;
}

Writer& Writer::seconds(TimeNs time_ns) {
  constexpr std::uint64_t per_second = 1'000'000'000;
  constexpr std::size_t decimals = 9;
  begin_cell();
  auto magnitude = static_cast<std::uint64_t>(time_ns);
  if (time_ns < 0) {
    lines_ += '-';
    magnitude = 0 - magnitude;  // also correct for the least time, which has no opposite
  }
  append_integer(lines_, magnitude / per_second);
  lines_ += '.';
  const std::size_t fraction = lines_.size();
  append_integer(lines_, magnitude % per_second);
  lines_.insert(fraction, decimals - (lines_.size() - fraction), '0');
  return *this;
}

Writer& Writer::text(std::string_view value) {
  begin_cell();
  lines_ += value;
  return *this;
}

Writer& Writer::empty() {
  begin_cell();
  return *this;
}

void Writer::end_row() {
  lines_ += '\n';
  in_row_ = false;
  if (lines_.size() > full_buffer) flush();
}

void Writer::flush() {
  file_.append(std::as_bytes(std::span(lines_)));
  lines_.clear();
}

void Writer::begin_cell() {
  if (std::exchange(in_row_, true)) lines_ += separator_;
}

}  // namespace sonopose::csv
