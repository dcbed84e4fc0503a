#include "ros2/relay/parameter_changes.hpp"

#include "logging/log.hpp"
#include "ros2/relay/parameter_messages.hpp"
#include <sonopose/settings/settings_table.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

namespace sonopose::ros2::relay {
namespace {

constexpr const char* ending = "the relay ends";

/// A setting with its new value, or the error of the parameter.
struct Checked {
  SettingName setting = {};
  std::string value = {};
  std::string error = {};
};

/// Checks name and value. `explains`: an unknown name is compared with all others, which takes long.
Checked checked(const ros2::Parameter& parameter, const presence::AddressSet& addresses, bool explains) {
  const std::string_view name(parameter.name);
  if (name.size() > max_name_bytes) {
    return {.error = fmt::format("unknown parameter '{}...': the name has {} bytes, the limit is {}",
                                 name.substr(0, 32), name.size(), max_name_bytes)};
  }
  const auto setting = setting_named(std::string(name));
  if (!setting) {
    return {.error = explains
                         ? fmt::format("unknown parameter '{}': {}", name, why_unknown(std::string(name)))
                         : fmt::format("unknown parameter '{}'", name)};
  }
  if (!addresses.contains(setting->address)) {
    return {.error = fmt::format("{}: beacon {} is not one of --addresses", name, setting->address)};
  }
  auto value = value_text(parameter.value);
  if (!value) return {.error = fmt::format("{}: must be a bool, an integer, a double or a string", name)};
  try {
    settings::parse_value(setting->key, *value);
  } catch (const settings::SettingError& error) {
    return {.error = error.what()};
  }
  return {.setting = *setting, .value = *std::move(value)};
}

/// Adds an assignment, which replaces an earlier one of its key.
void add(SettingsRequest& request, const SettingAssignment& assignment) {
  std::erase_if(request.assignments,
                [&](const SettingAssignment& each) { return each.key == assignment.key; });
  request.assignments.push_back(assignment);
}

}  // namespace

std::string excess_of(std::size_t names, std::size_t bytes) {
  if (names > max_names) return fmt::format("the request has {} names, the limit is {}", names, max_names);
  if (bytes <= max_text_bytes) return {};
  return fmt::format("the names and values of the request have {} bytes, the limit is {}", bytes,
                     max_text_bytes);
}

std::string excess_of(std::span<const ros2::Parameter> parameters) {
  std::size_t bytes = 0;
  if (parameters.size() <= max_names) {
    for (const ros2::Parameter& parameter : parameters) {
      bytes += std::strlen(parameter.name) + std::strlen(parameter.value.string_value);
    }
  }
  return excess_of(parameters.size(), bytes);
}

std::vector<std::string> ParameterChanges::set(std::span<const ros2::Parameter> parameters,
                                               const Stopped& stopped) {
  constexpr int max_explained = 16;
  std::size_t to_repeat = 16;  // a refused request changes nothing; more requests would block the service
  std::vector<std::string> errors(parameters.size());
  Changes changes;
  int unknown = 0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (stopped()) {
      errors.assign(errors.size(), ending);
      return errors;
    }
    Checked change = checked(parameters[i], addresses_, unknown < max_explained);
    errors[i] = std::move(change.error);
    if (!errors[i].empty()) {
      ++unknown;
    } else {
      changes[change.setting.address].push_back({i, {change.setting.key, std::move(change.value)}});
    }
  }
  std::optional<std::string> failure;  // nobody replies: do not wait again for each one
  const auto send_some = [&](BeaconAddress address, std::span<const Change> some) {
    SettingsRequest request;
    request.address = address;
    for (const Change& change : some) add(request, change.assignment);
    Outcome outcome = failure ? Outcome{*failure, false} : send(request, stopped);
    if (!outcome.error.empty() && !outcome.is_refusal) failure = outcome.error;
    for (const Change& change : some) errors[change.place] = outcome.error;
    return outcome.is_refusal;
  };
  for (const auto& [address, some] : changes) {
    if (!send_some(address, some) || some.size() == 1 || some.size() > to_repeat) continue;
    to_repeat -= some.size();
    for (const Change& change : some) send_some(address, {&change, 1});
  }
  return errors;
}

std::string ParameterChanges::set_atomically(std::span<const ros2::Parameter> parameters,
                                             const Stopped& stopped) {
  if (parameters.empty()) return {};
  SettingsRequest request;
  for (const ros2::Parameter& parameter : parameters) {
    if (stopped()) return ending;
    Checked change = checked(parameter, addresses_, true);
    if (!change.error.empty()) return std::move(change.error);
    if (!request.assignments.empty() && request.address != change.setting.address) {
      return "parameters of several beacons cannot be set atomically";
    }
    request.address = change.setting.address;
    add(request, {change.setting.key, std::move(change.value)});
  }
  return send(request, stopped).error;
}

ParameterChanges::Outcome ParameterChanges::send(const SettingsRequest& request, const Stopped& stopped) {
  if (stopped()) return {ending, false};
  const auto reply = client_.change(request, reply_timeout_s, stopped);
  if (!reply && stopped()) return {ending, false};
  if (!reply) return {fmt::format("no fusion replied within {} s", reply_timeout_s), false};
  if (!reply->accepted) return {reply->reason, true};
  if (!reply->reason.empty()) logging::warning("parameters: " + reply->reason);
  return {};
}

}  // namespace sonopose::ros2::relay
