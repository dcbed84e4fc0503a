#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include "ros2/relay/parameter_server.hpp"
#include <sonopose/ros2/messages/borrow.hpp>

#include <fmt/format.h>

#include <type_traits>

namespace sonopose::ros2 {
namespace {

constexpr double answer_timeout_s = 2.0;

/// rcl_interfaces/msg/ParameterType.
enum Type : std::uint8_t { not_set = 0, boolean = 1, integer = 2, real = 3, text = 4 };

using ros2::lend;
using ros2::lent;

std::vector<char*> lent(const std::vector<std::string>& values) {
  std::vector<char*> result;
  for (const std::string& value : values) result.push_back(lent(value));
  return result;
}

template <class Sequence>
auto values_of(const Sequence& sequence) {
  using Value = std::remove_pointer_t<decltype(sequence._buffer)>;
  using Kept = std::conditional_t<std::is_same_v<Value, char*>, std::string, Value>;
  return std::vector<Kept>(sequence._buffer, sequence._buffer + sequence._length);
}

Type type_of(const settings::SettingValue& value) {
  constexpr Type types[] = {boolean, integer, real, text};
  return types[value.index()];
}

/// `value` must outlive the message.
ros2::ParameterValue message_of(const std::optional<settings::SettingValue>& value) {
  static const std::string nothing;
  ros2::ParameterValue message{};
  message.string_value = lent(nothing);
  if (!value) return message;
  message.type = type_of(*value);
  if (const auto* const flag = std::get_if<bool>(&*value)) message.bool_value = *flag;
  if (const auto* const count = std::get_if<int>(&*value)) message.integer_value = *count;
  if (const auto* const number = std::get_if<double>(&*value)) message.double_value = *number;
  if (const auto* const word = std::get_if<std::string>(&*value)) message.string_value = lent(*word);
  return message;
}

/// As it is typed; empty for what no setting can be.
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

/// What is told of a parameter, and what the message that tells it points to.
struct Description {
  explicit Description(std::string parameter) : name(std::move(parameter)) {
    message.name = lent(name);
    if (const auto setting = setting_named(name)) describe(settings::setting_info(setting->key));
    message.description = lent(sentence);
    message.additional_constraints = lent(allowed);
    lend(message.floating_point_range, reals);
    lend(message.integer_range, integers);
  }
  Description(const Description&) = delete;
  Description& operator=(const Description&) = delete;

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

Ros2ParameterServer::Ros2ParameterServer(ros2::Node& node, const dds::DomainParticipant& participant,
                                         const dds::DomainOptions& domain,
                                         const std::optional<std::filesystem::path>& qos_file)
    : client_(domain, qos_file),
      settings_(dds::make_reader(participant, dds::QosProvider(qos_file), dds::topics::settings)),
      list_(node.make_service<ros2::ListParameters>("~/list_parameters")),
      get_(node.make_service<ros2::GetParameters>("~/get_parameters")),
      get_types_(node.make_service<ros2::GetParameterTypes>("~/get_parameter_types")),
      describe_(node.make_service<ros2::DescribeParameters>("~/describe_parameters")),
      set_(node.make_service<ros2::SetParameters>("~/set_parameters")),
      set_atomically_(node.make_service<ros2::SetParametersAtomically>("~/set_parameters_atomically")),
      reset_(node.make_service<ros2::Trigger>("~/reset")) {}

void Ros2ParameterServer::serve() {
  take_settings();
  list_.serve([this](const auto& request, const auto& reply) { list(request, reply); });
  get_.serve([this](const auto& request, const auto& reply) { get(request, reply); });
  get_types_.serve([this](const auto& request, const auto& reply) { get_types(request, reply); });
  describe_.serve([this](const auto& request, const auto& reply) { describe(request, reply); });
  set_.serve([this](const auto& request, const auto& reply) { set(request, reply); });
  set_atomically_.serve([this](const auto& request, const auto& reply) { set_atomically(request, reply); });
  reset_.serve([this](const auto& /*request*/, const auto& reply) { reset(reply); });
}

void Ros2ParameterServer::take_settings() {
  settings_.take_each([this](const sonopose_EffectiveSettings& sample,
                             const dds::SampleInfo&) { in_force_[sample.address] = dds::from_idl(sample); },
                      [this](const sonopose_EffectiveSettings& key, const dds::SampleInfo& info) {
                        if (!info.alive()) in_force_.erase(key.address);
                      });
}

void Ros2ParameterServer::list(const ros2::ListParameters::Request& request, const auto& reply) {
  const auto found = list_parameters(in_force_, values_of(request.prefixes), request.depth);
  auto names = lent(found.names);
  auto prefixes = lent(found.prefixes);
  ros2::ListParameters::Response response{};
  lend(response.result.names, names);
  lend(response.result.prefixes, prefixes);
  reply(response);
}

void Ros2ParameterServer::get(const ros2::GetParameters::Request& request, const auto& reply) {
  std::vector<std::optional<settings::SettingValue>> values;
  for (const std::string& name : values_of(request.names)) {
    values.push_back(parameter_value(in_force_, name));
  }
  std::vector<ros2::ParameterValue> messages;
  for (const auto& value : values) messages.push_back(message_of(value));
  ros2::GetParameters::Response response{};
  lend(response.values, messages);
  reply(response);
}

void Ros2ParameterServer::get_types(const ros2::GetParameterTypes::Request& request, const auto& reply) {
  std::vector<std::uint8_t> types;
  for (const std::string& name : values_of(request.names)) {
    const auto value = parameter_value(in_force_, name);
    types.push_back(value ? type_of(*value) : not_set);
  }
  ros2::GetParameterTypes::Response response{};
  lend(response.types, types);
  reply(response);
}

void Ros2ParameterServer::describe(const ros2::DescribeParameters::Request& request, const auto& reply) {
  std::vector<std::unique_ptr<Description>> descriptions;
  std::vector<ros2::ParameterDescriptor> messages;
  for (const std::string& name : values_of(request.names)) {
    messages.push_back(descriptions.emplace_back(std::make_unique<Description>(name))->message);
  }
  ros2::DescribeParameters::Response response{};
  lend(response.descriptors, messages);
  reply(response);
}

void Ros2ParameterServer::set(const ros2::SetParameters::Request& request, const auto& reply) {
  std::vector<std::string> faults;
  for (const ros2::Parameter& parameter : values_of(request.parameters))
    faults.push_back(changed({parameter}));
  std::vector<ros2::SetParametersResult> results;
  for (const std::string& fault : faults) results.push_back({fault.empty(), lent(fault)});
  ros2::SetParameters::Response response{};
  lend(response.results, results);
  reply(response);
}

void Ros2ParameterServer::set_atomically(const ros2::SetParametersAtomically::Request& request,
                                         const auto& reply) {
  const std::string fault = changed(values_of(request.parameters));
  ros2::SetParametersAtomically::Response response{};
  response.result = {fault.empty(), lent(fault)};
  reply(response);
}

/// All of them, or none. Returns why not, or nothing.
std::string Ros2ParameterServer::changed(const std::vector<ros2::Parameter>& parameters) {
  if (parameters.empty()) return {};
  SettingsRequest change;
  for (const ros2::Parameter& parameter : parameters) {
    const auto setting = setting_named(parameter.name);
    if (!setting) return fmt::format("there is no parameter '{}'", parameter.name);
    const auto value = text_of(parameter.value);
    if (!value) return fmt::format("{}: must be a bool, an integer, a double or a string", parameter.name);
    if (!change.assignments.empty() && change.address != setting->address) {
      return "parameters of several beacons cannot be set at one stroke";
    }
    change.address = setting->address;
    change.assignments.push_back({setting->key, *value});
  }
  const auto answer = client_.change(change, answer_timeout_s);
  if (!answer) return fmt::format("no fusion answered within {} s", answer_timeout_s);
  return answer->accepted ? std::string() : answer->reason;
}

void Ros2ParameterServer::reset(const auto& reply) {
  const auto beacons = client_.reset(all_beacons, answer_timeout_s);
  std::string message = beacons.empty() ? "no fusion has reset a beacon" : "reset";
  for (const BeaconAddress address : beacons) message += fmt::format(" {}", address);
  ros2::Trigger::Response response{};
  response.success = !beacons.empty();
  response.message = lent(message);
  reply(response);
}

}  // namespace sonopose::ros2
