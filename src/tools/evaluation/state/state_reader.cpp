#include "evaluation/state/state_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sonopose::evaluation {
namespace {

using nlohmann::json;

std::string kind_error(const json& value, std::string_view wanted) {
  constexpr std::size_t longest = 60;
  std::string shown = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (shown.size() > longest) shown = shown.substr(0, longest) + "…";
  return "is " + shown + " instead of " + std::string(wanted);
}

/// Returns false for numbers that no real run reaches, and that may overflow in the next events.
bool is_in_range(double number) {
  constexpr double max_magnitude = 1e12;
  return std::abs(number) <= max_magnitude;
}

/// Returns what is impossible about a filter's field. No real run ends with larger numbers, and larger ones
/// may overflow.
template <class Field>
std::string_view fault_of(std::string_view name, const Field& field) {
  constexpr double max_magnitude = 1e9;
  if constexpr (std::is_same_v<Field, double>) {
    if (name.ends_with("_s") && field < 0.0) return "is a negative time";
    if (std::abs(field) > max_magnitude) return "is beyond 1e9";
  } else if constexpr (std::is_same_v<Field, Vector3d> || std::is_same_v<Field, Eigen::Matrix3d>) {
    if (field.cwiseAbs().maxCoeff() > max_magnitude) return "is beyond 1e9";
  }
  return {};
}

}  // namespace

StateReader::StateReader(json object, std::string place)
    : object_(std::move(object)), place_(std::move(place)) {
  if (!object_.is_object()) throw StateFileError(place_ + ": " + kind_error(object_, "an object"));
}

StateReader StateReader::parsed(std::string_view text, const std::string& name) {
  try {
    return {json::parse(text), name};
  } catch (const json::exception& error) {
    const std::string reason = error.what();
    const std::size_t end = reason.find("] ");  // of its own name
    throw StateFileError(name + ": is not JSON: " + reason.substr(end == std::string::npos ? 0 : end + 2));
  }
}

std::string StateReader::text(const char* name) {
  const json value = take(name);
  if (!value.is_string()) fail(name, kind_error(value, "a text"));
  return value.get<std::string>();
}

std::uint64_t StateReader::count(const char* name) {
  const json value = take(name);
  if (!value.is_number_unsigned()) fail(name, kind_error(value, "a count"));
  return value.get<std::uint64_t>();
}

std::uint32_t StateReader::count32(const char* name) {
  const std::uint64_t value = count(name);
  if (value > std::numeric_limits<std::uint32_t>::max()) fail(name, kind_error(value, "a count below 2^32"));
  return static_cast<std::uint32_t>(value);
}

StateReader StateReader::object(const char* name) {
  return {take(name), place_ + ": " + name};
}

void StateReader::read(const char* name, double& value) {
  const json read = take(name);
  if (!read.is_number()) fail(name, kind_error(read, "a number"));
  value = read.get<double>();
  if (!is_in_range(value)) fail(name, "is beyond 1e12");
}

void StateReader::read(const char* name, bool& value) {
  const json read = take(name);
  if (!read.is_boolean()) fail(name, kind_error(read, "true or false"));
  value = read.get<bool>();
}

void StateReader::read(const char* name, int& value) {
  const std::uint64_t read = count(name);
  if (read > static_cast<std::uint64_t>(std::numeric_limits<int>::max())) {
    fail(name, kind_error(read, "a count below 2^31"));
  }
  value = static_cast<int>(read);
}

void StateReader::read(const char* name, TimeNs& value) {
  const json read = take(name);
  const bool fits = read.is_number_integer() &&
                    (!read.is_number_unsigned() ||
                     read.get<std::uint64_t>() <= std::uint64_t{std::numeric_limits<TimeNs>::max()});
  if (!fits) fail(name, kind_error(read, "a time in whole nanoseconds"));
  value = read.get<TimeNs>();
}

std::size_t StateReader::choice(const char* name, std::span<const std::string_view> choices) {
  const std::string word = text(name);
  const auto found = std::find(choices.begin(), choices.end(), word);
  if (found == choices.end()) {
    std::string wanted;
    for (const std::string_view one : choices) wanted += (wanted.empty() ? "" : " or ") + std::string(one);
    fail(name, kind_error(word, wanted));
  }
  return static_cast<std::size_t>(found - choices.begin());
}

void StateReader::read(const char* name, Vector3d& value) {
  const auto numbers = take_numbers<3>(name, "three numbers");
  value = Vector3d(numbers.data());
}

void StateReader::read(const char* name, Quaterniond& q) {
  constexpr double tolerance = 1e-6;
  const auto [w, x, y, z] = take_numbers<4>(name, "four numbers");
  q = Quaterniond(w, x, y, z);
  if (!(std::abs(q.norm() - 1.0) < tolerance)) fail(name, "is not a unit quaternion");
}

void StateReader::read_rows(const char* name, int size, double* by_columns) {
  const json rows = array(name);
  const auto count = static_cast<std::size_t>(size);
  const std::string wanted = std::to_string(size) + " rows of " + std::to_string(size) + " numbers";
  if (rows.size() != count) fail(name, kind_error(rows, wanted));
  for (std::size_t row = 0; row < count; ++row) {
    const json& numbers = rows[row];
    const bool fits =
        numbers.is_array() && numbers.size() == count &&
        std::all_of(numbers.begin(), numbers.end(), [](const json& one) { return one.is_number(); });
    if (!fits) fail(name, kind_error(numbers, wanted));
    for (std::size_t column = 0; column < count; ++column) {
      const auto number = numbers[column].get<double>();
      if (!is_in_range(number)) fail(name, "is beyond 1e12");
      by_columns[column * count + row] = number;
    }
  }
}

void StateReader::read(const char* name, attitude::AnyFilter& filter) {
  StateReader fields = object(name);
  attitude::FilterKind kind{};
  fields.read("kind", kind);
  filter.select(kind);
  filter.for_each_field([&fields](const char* field, auto& value) {
    fields.read(field, value);
    const std::string_view fault = fault_of(field, value);
    if (!fault.empty()) fields.fail(field, std::string(fault));
  });
  fields.finish();
}

void StateReader::finish() const {
  if (!object_.empty()) fail(object_.items().begin().key(), "is not known");
}

void StateReader::fail(const std::string& name, const std::string& what) const {
  throw StateFileError(place_ + ": " + name + ": " + what);
}

json StateReader::take(const char* name) {
  const auto found = object_.find(name);
  if (found == object_.end()) fail(name, "is missing");
  json value = std::move(*found);
  object_.erase(found);
  return value;
}

template <std::size_t Count>
std::array<double, Count> StateReader::take_numbers(const char* name, const char* wanted) {
  const json read = array(name);
  const bool fits = read.size() == Count &&
                    std::all_of(read.begin(), read.end(), [](const json& one) { return one.is_number(); });
  if (!fits) fail(name, kind_error(read, wanted));
  const auto numbers = read.get<std::array<double, Count>>();
  if (!std::all_of(numbers.begin(), numbers.end(), is_in_range)) fail(name, "is beyond 1e12");
  return numbers;
}

json StateReader::array(const char* name) {
  json value = take(name);
  if (!value.is_array()) fail(name, kind_error(value, "an array"));
  return value;
}

}  // namespace sonopose::evaluation
