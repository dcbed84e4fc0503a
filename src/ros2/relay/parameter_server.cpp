#include "ros2/relay/parameter_server.hpp"

#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/ros2/messages/borrow.hpp>

#include <fmt/format.h>

#include <array>
#include <type_traits>

namespace sonopose::ros2::relay {
namespace {

constexpr double reply_timeout_s = 2.0;

/// rcl_interfaces/msg/ParameterType.
enum Type : std::uint8_t { not_set = 0, boolean = 1, integer = 2, real = 3, text = 4 };

using ros2::borrow_sequence;
using ros2::borrow_string;

std::vector<char*> borrow_strings(const std::vector<std::string>& values) {
  std::vector<char*> result;
  for (const std::string& value : values) result.push_back(borrow_string(value));
  return result;
}

template <class Sequence>
auto values_of(const Sequence& sequence) {
  using Value = std::remove_pointer_t<decltype(sequence._buffer)>;
  using Copy = std::conditional_t<std::is_same_v<Value, char*>, std::string, Value>;
  return std::vector<Copy>(sequence._buffer, sequence._buffer + sequence._length);
}

Type type_of(const settings::SettingValue& value) {
  constexpr std::array types{boolean, integer, real, text};
  return types.at(value.index());
}

/// `value` must outlive the message.
ros2::ParameterValue message_of(const std::optional<settings::SettingValue>& value) {
  static const std::string nothing;
  ros2::ParameterValue message{};
  message.string_value = borrow_string(nothing);
  if (!value) return message;
  message.type = type_of(*value);
  if (const auto* const flag = std::get_if<bool>(&*value)) message.bool_value = *flag;
  if (const auto* const count = std::get_if<int>(&*value)) message.integer_value = *count;
  if (const auto* const number = std::get_if<double>(&*value)) message.double_value = *number;
  if (const auto* const word = std::get_if<std::string>(&*value)) message.string_value = borrow_string(*word);
  return message;
}

/// The value as text; empty for a type that no setting has.
std::optional<std::string> text_of(const ros2::ParameterValue& message) {
  switch (message.type) {
    case boolean:
      return message.bool_value ? "true" : "false";
    case integer:
      return std::to_string(message.integer_value);
    case real:
      return settings::to_text(message.double_value);
    case text:
      return message.string_value;
    default:
      return std::nullopt;
  }
}

/// The description of a parameter, and the strings and ranges that its message borrows.
struct Description {
  explicit Description(std::string parameter) : name(std::move(parameter)) {
    message.name = borrow_string(name);
    if (const auto setting = setting_named(name)) describe(settings::setting_info(setting->key));
    message.description = borrow_string(sentence);
    message.additional_constraints = borrow_string(allowed);
    borrow_sequence(message.floating_point_range, reals);
    borrow_sequence(message.integer_range, integers);
  }
  Description(const Description&) = delete;
  Description& operator=(const Description&) = delete;
  ~Description() = default;

  void describe(const settings::SettingInfo& info) {
    sentence = info.unit.empty() ? info.sentence : info.sentence + " [" + info.unit + "]";
    allowed = info.allowed();
    message.type = type_of(info.initial);
    if (message.type == integer) {
      integers.push_back({std::get<int>(info.minimum), std::get<int>(info.maximum), 1});
    }
    if (message.type == real) {
      reals.push_back({std::get<double>(info.minimum), std::get<double>(info.maximum), 0});
    }
  }

  std::string name;
  std::string sentence;
  std::string allowed;
  std::vector<ros2::FloatingPointRange> reals;
  std::vector<ros2::IntegerRange> integers;
  ros2::ParameterDescriptor message{};
};

}  // namespace

ParameterServer::ParameterServer(ros2::Node& node, const dds::DomainParticipant& participant,
                                 const dds::DomainOptions& domain,
                                 const std::optional<std::filesystem::path>& qos_file)
    : client_(domain, qos_file),
      settings_(dds::topics::make_reader(participant, dds::qos::Provider(qos_file), dds::topics::settings)),
      list_(node.make_service<ros2::ListParameters>("~/list_parameters")),
      get_(node.make_service<ros2::GetParameters>("~/get_parameters")),
      get_types_(node.make_service<ros2::GetParameterTypes>("~/get_parameter_types")),
      describe_(node.make_service<ros2::DescribeParameters>("~/describe_parameters")),
      set_(node.make_service<ros2::SetParameters>("~/set_parameters")),
      set_atomically_(node.make_service<ros2::SetParametersAtomically>("~/set_parameters_atomically")),
      reset_(node.make_service<ros2::Trigger>("~/reset")) {}

void ParameterServer::serve() {
  take_settings();
  list_.serve([this](const auto& request, const auto& reply) { list(request, reply); });
  get_.serve([this](const auto& request, const auto& reply) { get(request, reply); });
  get_types_.serve([this](const auto& request, const auto& reply) { get_types(request, reply); });
  describe_.serve([this](const auto& request, const auto& reply) { describe(request, reply); });
  set_.serve([this](const auto& request, const auto& reply) { set(request, reply); });
  set_atomically_.serve([this](const auto& request, const auto& reply) { set_atomically(request, reply); });
  reset_.serve([this](const auto& /*request*/, const auto& reply) { reset(reply); });
}

void ParameterServer::take_settings() {
  settings_.take_each(
      [this](const sonopose_EffectiveSettings& sample, const dds::SampleInfo&) {
        effective_[sample.address] = dds::topics::from_idl(sample);
      },
      [this](const sonopose_EffectiveSettings& key, const dds::SampleInfo& info) {
        if (!info.alive()) effective_.erase(key.address);
      });
}

void ParameterServer::list(const ros2::ListParameters::Request& request, const auto& reply) {
  const auto found = list_parameters(effective_, values_of(request.prefixes), request.depth);
  auto names = borrow_strings(found.names);
  auto prefixes = borrow_strings(found.prefixes);
  ros2::ListParameters::Response response{};
  borrow_sequence(response.result.names, names);
  borrow_sequence(response.result.prefixes, prefixes);
  reply(response);
}

void ParameterServer::get(const ros2::GetParameters::Request& request, const auto& reply) {
  std::vector<std::optional<settings::SettingValue>> values;
  for (const std::string& name : values_of(request.names)) {
    values.push_back(parameter_value(effective_, name));
  }
  std::vector<ros2::ParameterValue> messages;
  for (const auto& value : values) messages.push_back(message_of(value));
  ros2::GetParameters::Response response{};
  borrow_sequence(response.values, messages);
  reply(response);
}

void ParameterServer::get_types(const ros2::GetParameterTypes::Request& request, const auto& reply) {
  std::vector<std::uint8_t> types;
  for (const std::string& name : values_of(request.names)) {
    const auto value = parameter_value(effective_, name);
    types.push_back(value ? type_of(*value) : not_set);
  }
  ros2::GetParameterTypes::Response response{};
  borrow_sequence(response.types, types);
  reply(response);
}

void ParameterServer::describe(const ros2::DescribeParameters::Request& request, const auto& reply) {
  std::vector<std::unique_ptr<Description>> descriptions;
  std::vector<ros2::ParameterDescriptor> messages;
  for (const std::string& name : values_of(request.names)) {
    messages.push_back(descriptions.emplace_back(std::make_unique<Description>(name))->message);
  }
  ros2::DescribeParameters::Response response{};
  borrow_sequence(response.descriptors, messages);
  reply(response);
}

void ParameterServer::set(const ros2::SetParameters::Request& request, const auto& reply) {
  std::vector<std::string> errors;
  for (const ros2::Parameter& parameter : values_of(request.parameters))
    errors.push_back(change({parameter}));
  std::vector<ros2::SetParametersResult> results;
  for (const std::string& error : errors) results.push_back({error.empty(), borrow_string(error)});
  ros2::SetParameters::Response response{};
  borrow_sequence(response.results, results);
  reply(response);
}

void ParameterServer::set_atomically(const ros2::SetParametersAtomically::Request& request,
                                     const auto& reply) {
  const std::string error = change(values_of(request.parameters));
  ros2::SetParametersAtomically::Response response{};
  response.result = {error.empty(), borrow_string(error)};
  reply(response);
}

/// Changes all parameters or none. Returns the error, empty on success.
std::string ParameterServer::change(const std::vector<ros2::Parameter>& parameters) {
  if (parameters.empty()) return {};
  SettingsRequest settings_request;
  for (const ros2::Parameter& parameter : parameters) {
    const auto setting = setting_named(parameter.name);
    if (!setting) return fmt::format("unknown parameter '{}'", parameter.name);
    const auto value = text_of(parameter.value);
    if (!value) return fmt::format("{}: must be a bool, an integer, a double or a string", parameter.name);
    if (!settings_request.assignments.empty() && settings_request.address != setting->address) {
      return "parameters of several beacons cannot be set atomically";
    }
    settings_request.address = setting->address;
    settings_request.assignments.push_back({setting->key, *value});
  }
  const auto settings_reply = client_.change(settings_request, reply_timeout_s);
  if (!settings_reply) return fmt::format("no fusion replied within {} s", reply_timeout_s);
  return settings_reply->accepted ? std::string() : settings_reply->reason;
}

void ParameterServer::reset(const auto& reply) {
  const auto beacons = client_.reset(all_beacons, reply_timeout_s);
  std::string message = beacons.empty() ? "no fusion has reset a beacon" : "reset";
  for (const BeaconAddress address : beacons) message += fmt::format(" {}", address);
  ros2::Trigger::Response response{};
  response.success = !beacons.empty();
  response.message = borrow_string(message);
  reply(response);
}

}  // namespace sonopose::ros2::relay
