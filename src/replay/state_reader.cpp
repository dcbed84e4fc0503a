#include "state_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sonopose::replay {
namespace {

using nlohmann::json;

std::string kind_error(const json& value, std::string_view wanted) {
  constexpr std::size_t longest = 60;
  std::string shown = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (shown.size() > longest) shown = shown.substr(0, longest) + "…";
  return "is " + shown + " instead of " + std::string(wanted);
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
    throw StateFileError(name + ": is no JSON: " + error.what());
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

void StateReader::read(const char* name, fusion::Track& value) {
  const std::string word = text(name);
  const auto found = std::find(track_names.begin(), track_names.end(), word);
  if (found == track_names.end()) fail(name, kind_error(word, "none, position or held"));
  value = static_cast<fusion::Track>(found - track_names.begin());
}

void StateReader::read(const char* name, Vector3d& value) {
  const json read = take_array(name);
  const bool numbers = read.size() == 3 && std::all_of(read.begin(), read.end(), [](const json& component) {
                         return component.is_number();
                       });
  if (!numbers) fail(name, kind_error(read, "three numbers"));
  for (std::size_t i = 0; i < 3; ++i) value[static_cast<Eigen::Index>(i)] = read[i].get<double>();
}

void StateReader::read(const char* name, attitude::Mahony& filter) {
  constexpr double tolerance = 1e-6;
  StateReader fields = object(name);
  const json q = fields.take_array("q_body_to_world");
  const bool numbers = q.size() == 4 && std::all_of(q.begin(), q.end(), [](const json& component) {
                         return component.is_number();
                       });
  if (!numbers) fields.fail("q_body_to_world", kind_error(q, "four numbers"));
  const Quaterniond q_body_to_world(q[0].get<double>(), q[1].get<double>(), q[2].get<double>(),
                                    q[3].get<double>());
  if (!(std::abs(q_body_to_world.norm() - 1.0) < tolerance)) {
    fields.fail("q_body_to_world", kind_error(q, "a unit quaternion"));
  }
  Vector3d gyro_bias_body_radps;
  fields.read("gyro_bias_body_radps", gyro_bias_body_radps);
  fields.finish();
  filter.restore(q_body_to_world, -gyro_bias_body_radps);
}

void StateReader::read(const char* name, fusion::InertialHistory& history) {
  const json points = take_array(name);
  if (points.size() > fusion::InertialHistory::capacity) {
    fail(name, "has " + std::to_string(points.size()) + " points, more than " +
                   std::to_string(fusion::InertialHistory::capacity));
  }
  history = {};
  for (const json& element : points) {
    StateReader fields(element, place_ + ": " + name);
    fusion::InertialPoint point;
    fields.read("time_ns", point.time_ns);
    fields.read("displacement_world_m", point.displacement_world_m);
    fields.read("yaw_rad", point.yaw_rad);
    fields.finish();
    if (!history.empty() && point.time_ns < history.newest().time_ns)
      fail(name, "has times that go backward");
    history.push(point);
  }
}

void StateReader::read(const char* name, fusion::PastFix& fix) {
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

json StateReader::take_array(const char* name) {
  json value = take(name);
  if (!value.is_array()) fail(name, kind_error(value, "an array"));
  return value;
}

}  // namespace sonopose::replay
