#include "evaluation/state_reader.hpp"

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

/// Why a filter's field is implausible, or empty. No real run produces larger numbers, and they would
/// overflow later.
template <class Field>
std::string_view fault_of(std::string_view name, const Field& field) {
  constexpr double most = 1e9;
  if constexpr (std::is_same_v<Field, double>) {
    if (name.ends_with("_s") && field < 0.0) return "is a negative time";
    if (std::abs(field) > most) return "is beyond 1e9";
  } else if constexpr (std::is_same_v<Field, Vector3d> || std::is_same_v<Field, Eigen::Matrix3d>) {
    if (field.cwiseAbs().maxCoeff() > most) return "is beyond 1e9";
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
    throw StateFileError(name + ": is not JSON: " + error.what());
  }
}

std::string StateReader::text(const char* name) {
  const json value = take(name);
  if (!value.is_string()) fail(name, kind_error(value, "a string"));
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

void StateReader::read(const char* name, estimation::documented::InitPhase& value) {
  const std::string word = text(name);
  const auto found = std::find(track_names.begin(), track_names.end(), word);
  if (found == track_names.end()) fail(name, kind_error(word, "none, position or held"));
  value = static_cast<estimation::documented::InitPhase>(found - track_names.begin());
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

void StateReader::read(const char* name, Eigen::Matrix3d& value) {
  const json rows = take_array(name);
  if (rows.size() != 3) fail(name, kind_error(rows, "three rows"));
  for (Eigen::Index row = 0; row < 3; ++row) {
    StateReader reader(json{{name, rows[static_cast<std::size_t>(row)]}}, place_);
    Vector3d numbers;
    reader.read(name, numbers);
    value.row(row) = numbers;
  }
}

void StateReader::read(const char* name, attitude::AnyFilter& filter) {
  StateReader fields = object(name);
  const std::string word = fields.text("kind");
  constexpr auto kinds = choices_of(attitude::FilterKind{});
  const auto found = std::find(kinds.begin(), kinds.end(), word);
  if (found == kinds.end()) fields.fail("kind", kind_error(word, "the name of a filter"));
  filter.select(static_cast<attitude::FilterKind>(found - kinds.begin()));
  filter.for_each_field([&fields](const char* field, auto& value) {
    fields.read(field, value);
    const std::string_view fault = fault_of(field, value);
    if (!fault.empty()) fields.fail(field, std::string(fault));
  });
  fields.finish();
}

void StateReader::read(const char* name, estimation::documented::InertialHistory& history) {
  const json points = take_array(name);
  if (points.size() > estimation::documented::InertialHistory::capacity) {
    fail(name, "has " + std::to_string(points.size()) + " points, more than " +
                   std::to_string(estimation::documented::InertialHistory::capacity));
  }
  history = {};
  for (const json& element : points) {
    StateReader fields(element, place_ + ": " + name);
    estimation::documented::InertialPoint point;
    fields.read("time_ns", point.time_ns);
    fields.read("displacement_world_m", point.displacement_world_m);
    fields.read("yaw_rad", point.yaw_rad);
    fields.finish();
    if (!history.empty() && point.time_ns < history.newest().time_ns)
      fail(name, "has times that go backward");
    history.push(point);
  }
}

void StateReader::read(const char* name, estimation::documented::PastFix& fix) {
  const auto found = object_.find(name);
  if (found == object_.end()) fail(name, "is missing");
  if (!found->is_array()) fail(name, kind_error(*found, "an array"));
  const std::size_t index = next_element_[name]++;
  if (index >= found->size()) fail(name, "has only " + std::to_string(found->size()) + " elements");
  StateReader fields((*found)[index], place_ + ": " + name);
  fields.read("measured_ns", fix.measured_ns);
  fields.read("position_world_m", fix.position_world_m);
  fields.finish();
}

void StateReader::finish() const {
  for (const auto& [name, value] : object_.items()) {
    const auto counted = next_element_.find(name);
    if (counted == next_element_.end()) fail(name, "is not known");
    if (counted->second != value.size()) {
      fail(name,
           "has " + std::to_string(value.size()) + " elements instead of " + std::to_string(counted->second));
    }
  }
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
  const json read = take_array(name);
  const bool fits = read.size() == Count &&
                    std::all_of(read.begin(), read.end(), [](const json& one) { return one.is_number(); });
  if (!fits) fail(name, kind_error(read, wanted));
  return read.get<std::array<double, Count>>();
}

json StateReader::take_array(const char* name) {
  json value = take(name);
  if (!value.is_array()) fail(name, kind_error(value, "an array"));
  return value;
}

}  // namespace sonopose::evaluation
