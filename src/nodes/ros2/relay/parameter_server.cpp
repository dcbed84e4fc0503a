#include "ros2/relay/parameter_server.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "ros2/relay/parameter_messages.hpp"
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/ros2/messages/borrow.hpp>

#include <fmt/format.h>

#include <cstring>

namespace sonopose::ros2::relay {
namespace {

using ros2::borrow_sequence;
using ros2::borrow_string;

std::vector<char*> borrow_strings(const std::vector<std::string>& values) {
  std::vector<char*> result;
  for (const std::string& value : values) result.push_back(borrow_string(value));
  return result;
}

template <class Sequence>
auto values_of(const Sequence& sequence) {
  return std::span(sequence._buffer, sequence._length);
}

template <class Sequence>
std::vector<std::string> strings_of(const Sequence& sequence) {
  const auto values = values_of(sequence);
  return {values.begin(), values.end()};
}

template <class Sequence>
std::string excess_of_names(const Sequence& sequence) {
  std::size_t bytes = 0;
  if (sequence._length <= max_names) {
    for (const char* const name : values_of(sequence)) bytes += std::strlen(name);
  }
  return excess_of(sequence._length, bytes);
}

/// Value of a parameter, and the strings that its message borrows.
struct Value {
  Value(const SettingsByBeacon& effective, const OptionParameters& options, const std::string& name) {
    if (const auto option = options.find(name); option == options.end()) {
      scalar = parameter_value(effective, name);
    } else if (const auto* const one = std::get_if<settings::SettingValue>(&option->second)) {
      scalar = *one;
    } else {
      list = option->second;
    }
    message = value_message(scalar);
    if (auto* const reals = std::get_if<std::vector<double>>(&list)) {
      message.type = static_cast<std::uint8_t>(ParameterType::reals);
      borrow_sequence(message.double_array_value, *reals);
    } else if (const auto* const texts = std::get_if<std::vector<std::string>>(&list)) {
      message.type = static_cast<std::uint8_t>(ParameterType::texts);
      pointers = borrow_strings(*texts);
      borrow_sequence(message.string_array_value, pointers);
    }
  }
  Value(const Value&) = delete;
  Value& operator=(const Value&) = delete;
  ~Value() = default;

  std::optional<settings::SettingValue> scalar;
  OptionValue list;
  std::vector<char*> pointers;
  ros2::ParameterValue message{};
};

/// Description of a parameter, and the strings and ranges that its message borrows.
struct Description {
  Description(std::string parameter, const OptionParameters& options) : name(std::move(parameter)) {
    message.name = borrow_string(name);
    if (options.contains(name)) {
      sentence = "option of sonopose-ros2; a restart changes it";
      message.type = Value({}, options, name).message.type;
      message.read_only = true;
    }
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
    const ParameterType type = type_of(info.initial);
    message.type = static_cast<std::uint8_t>(type);
    if (type == ParameterType::integer) {
      integers.push_back({std::get<int>(info.minimum), std::get<int>(info.maximum), 1});
    }
    if (type == ParameterType::real) {
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

ParameterServer::Services::Services(ros2::Node& node, const std::function<void()>& wake,
                                    const std::vector<SetPoseService>& set_poses)
    : list(node.make_service<ros2::ListParameters>("~/list_parameters", wake)),
      get(node.make_service<ros2::GetParameters>("~/get_parameters", wake)),
      get_types(node.make_service<ros2::GetParameterTypes>("~/get_parameter_types", wake)),
      describe(node.make_service<ros2::DescribeParameters>("~/describe_parameters", wake)),
      set(node.make_service<ros2::SetParameters>("~/set_parameters", wake)),
      set_atomically(node.make_service<ros2::SetParametersAtomically>("~/set_parameters_atomically", wake)),
      reset(node.make_service<ros2::Trigger>("~/reset", wake)) {
  for (const SetPoseService& each : set_poses) {
    set_pose.push_back(node.make_service<ros2::SetPose>(each.name, wake));
  }
}

ParameterServer::ParameterServer(ros2::Node& node, const dds::domain::DomainParticipant& participant,
                                 const ParameterServerOptions& options, std::function<void()> wake)
    : wake_(std::move(wake)),
      client_(participant, options.qos_file),
      addresses_(options.addresses),
      startup_requests_(requests_of(options.startup_settings)),
      own_parameters_(options.own_parameters),
      events_(node),
      admission_(options.addresses.with(all_beacons), options.max_beacons + 1),  // including all_beacons
      settings_listener_(wake_),
      settings_(dds::topics::make_reader(participant, dds::qos::Provider(options.qos_file),
                                         dds::topics::settings, wake_ ? &settings_listener_ : nullptr,
                                         dds::topics::Delivery::live, &admission_)) {
  admission_.accepts(all_beacons);
}

void ParameterServer::offer_services(ros2::Node& node, bool offered) {
  const threads::Lock lock(services_mutex_);
  if (offered == services_.has_value()) return;
  if (offered) {
    services_.emplace(node, wake_, set_poses_);
    return;
  }
  services_->for_each([&](const auto& service) { node.remove(service); });
  services_.reset();
}

bool ParameterServer::serve(const Stopped& stopped) {
  stopped_ = stopped;
  take_settings();
  apply_startup_settings();
  const threads::Lock lock(services_mutex_);
  if (!services_) return false;
  Services& of = *services_;
  bool waits = of.list.serve([this](const auto& request, const auto& reply) { list(request, reply); });
  waits |= of.get.serve([this](const auto& request, const auto& reply) { get(request, reply); });
  waits |= of.get_types.serve([this](const auto& request, const auto& reply) { get_types(request, reply); });
  waits |= of.describe.serve([this](const auto& request, const auto& reply) { describe(request, reply); });
  waits |= of.set.serve([this](const auto& request, const auto& reply) { set(request, reply); });
  waits |= of.set_atomically.serve(
      [this](const auto& request, const auto& reply) { set_atomically(request, reply); });
  waits |= of.reset.serve([this](const auto& /*request*/, const auto& reply) { reset(reply); });
  for (std::size_t i = 0; i < of.set_pose.size(); ++i) {
    waits |= of.set_pose[i].serve([&](const auto& request, const auto& reply) {
      set_poses_[i].take(request.pose);
      reply({});
    });
  }
  return waits;
}

void ParameterServer::take_settings() {
  const auto replace = [this](const EffectiveSettings& settings) {
    for (const SettingAssignment& setting : settings.values) {
      if (!setting_named(parameter_name({settings.address, setting.key})) || valid_value(setting)) continue;
      if (std::exchange(reported_invalid_, true)) break;
      const std::string of =
          settings.address == all_beacons ? "all beacons" : fmt::format("beacon {}", settings.address);
      logging::warning(fmt::format("{}: {} = '{}' is not valid in this version, so it is not a parameter", of,
                                   setting.key, setting.value));
    }
    EffectiveSettings& known = effective_[settings.address];
    events_.publish(known, settings);
    known = settings;
  };
  const auto end = [&](BeaconAddress address) {
    replace({.address = address, .values = {}});
    effective_.erase(address);
    if (address != all_beacons) admission_.forget(address);
  };
  dds::ext::take_each(
      settings_,
      [&](const sonopose_EffectiveSettings& sample, const dds::sub::SampleInfo& info) {
        if (dds::ext::is_alive(info)) {
          replace(dds::topics::from_idl(sample));
        } else {
          end(sample.address);
        }
      },
      [&](const sonopose_EffectiveSettings& key, const dds::sub::SampleInfo& info) {
        if (!dds::ext::is_alive(info)) end(key.address);
      });
}

/// Sends the startup settings once, when a fusion appears and no other is known.
void ParameterServer::apply_startup_settings() {
  if (effective_.empty()) applied_startup_ = false;
  if (applied_startup_ || !effective_.contains(all_beacons)) return;
  applied_startup_ = true;
  for (const SettingsRequest& request : startup_requests_) {
    const auto reply = client_.change(request, reply_timeout_s, stopped_);
    if (stopped_()) return;
    if (!reply) {
      logging::error(fmt::format("no fusion replied within {} s to the parameters of the command line",
                                 reply_timeout_s));
    } else if (!reply->accepted) {
      logging::error("the fusion refused the parameters of the command line: " + reply->reason);
    } else if (!reply->reason.empty()) {
      logging::warning("parameters of the command line: " + reply->reason);
    }
  }
}

/// True for a request that is too large, and when the process ends. A reply without values, like that of
/// rclcpp, is the refusal where it has no place for a reason.
bool ParameterServer::refuses(const std::string& excess) {
  if (!excess.empty()) log_refusal(excess);
  return !excess.empty() || stopped_();
}

std::string ParameterServer::read_only_error(std::span<const ros2::Parameter> parameters) const {
  for (const ros2::Parameter& parameter : parameters) {
    if (!own_parameters_.contains(parameter.name)) continue;
    return fmt::format("{} is read-only: restart sonopose-ros2 to change it", parameter.name);
  }
  return {};
}

void ParameterServer::log_refusal(const std::string& reason) {
  constexpr TimeNs period_ns = 10'000'000'000;
  const SteadyTime now = clocks::steady_now();
  if (now < next_refusal_) return;
  next_refusal_ = now + period_ns;
  logging::warning("parameters: " + reason);
}

void ParameterServer::list(const ros2::ListParameters::Request& request, const auto& reply) {
  if (refuses(excess_of_names(request.prefixes))) return reply({});
  const auto found =
      list_parameters(effective_, strings_of(request.prefixes), request.depth, own_parameters_);
  auto names = borrow_strings(found.names);
  auto prefixes = borrow_strings(found.prefixes);
  ros2::ListParameters::Response response{};
  borrow_sequence(response.result.names, names);
  borrow_sequence(response.result.prefixes, prefixes);
  reply(response);
}

void ParameterServer::get(const ros2::GetParameters::Request& request, const auto& reply) {
  if (refuses(excess_of_names(request.names))) return reply({});
  std::vector<std::unique_ptr<Value>> values;
  std::vector<ros2::ParameterValue> messages;
  for (const std::string& name : strings_of(request.names)) {
    messages.push_back(
        values.emplace_back(std::make_unique<Value>(effective_, own_parameters_, name))->message);
  }
  ros2::GetParameters::Response response{};
  borrow_sequence(response.values, messages);
  reply(response);
}

void ParameterServer::get_types(const ros2::GetParameterTypes::Request& request, const auto& reply) {
  if (refuses(excess_of_names(request.names))) return reply({});
  std::vector<std::uint8_t> types;
  for (const std::string& name : strings_of(request.names)) {
    types.push_back(Value(effective_, own_parameters_, name).message.type);
  }
  ros2::GetParameterTypes::Response response{};
  borrow_sequence(response.types, types);
  reply(response);
}

void ParameterServer::describe(const ros2::DescribeParameters::Request& request, const auto& reply) {
  if (refuses(excess_of_names(request.names))) return reply({});
  std::vector<std::unique_ptr<Description>> descriptions;
  std::vector<ros2::ParameterDescriptor> messages;
  for (const std::string& name : strings_of(request.names)) {
    messages.push_back(
        descriptions.emplace_back(std::make_unique<Description>(name, own_parameters_))->message);
  }
  ros2::DescribeParameters::Response response{};
  borrow_sequence(response.descriptors, messages);
  reply(response);
}

void ParameterServer::set(const ros2::SetParameters::Request& request, const auto& reply) {
  const auto parameters = values_of(request.parameters);
  const std::string excess = excess_of(parameters);
  std::vector<std::string> errors;
  if (excess.empty()) {
    errors = changes_.set(parameters, stopped_);
  } else {
    log_refusal(excess);
  }
  // One text for all, since there may be any number.
  const auto error_of = [&](std::size_t i) -> const std::string& {
    static const std::string as_first = "see the reason of the first parameter";
    if (!excess.empty()) return i < max_names ? excess : as_first;
    return errors[i];
  };
  std::vector<ros2::SetParametersResult> results;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    std::string read_only = read_only_error(parameters.subspan(i, 1));
    if (!read_only.empty()) errors[i] = std::move(read_only);
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::string& error = error_of(i);
    results.push_back({error.empty(), borrow_string(error)});
  }
  ros2::SetParameters::Response response{};
  borrow_sequence(response.results, results);
  reply(response);
}

void ParameterServer::set_atomically(const ros2::SetParametersAtomically::Request& request,
                                     const auto& reply) {
  const auto parameters = values_of(request.parameters);
  std::string error = excess_of(parameters);
  if (error.empty()) error = read_only_error(parameters);
  if (error.empty()) {
    error = changes_.set_atomically(parameters, stopped_);
  } else {
    log_refusal(error);
  }
  ros2::SetParametersAtomically::Response response{};
  response.result = {error.empty(), borrow_string(error)};
  reply(response);
}

std::vector<BeaconAddress> ParameterServer::reset_beacons() {
  if (!addresses_.first()) return client_.reset(all_beacons, reply_timeout_s, stopped_);
  std::vector<BeaconAddress> beacons;
  for (const auto& [address, settings] : effective_) {
    if (!addresses_.contains(address)) continue;
    for (const BeaconAddress one : client_.reset(address, reply_timeout_s, stopped_)) beacons.push_back(one);
  }
  return beacons;
}

void ParameterServer::reset(const auto& reply) {
  std::vector<BeaconAddress> beacons;
  std::string message;
  try {
    beacons = reset_beacons();
    message = beacons.empty() ? "no fusion has reset a beacon" : "reset";
  } catch (const std::exception& error) {  // DDS Security may refuse the topic
    message = error.what();
  }
  for (const BeaconAddress address : beacons) message += fmt::format(" {}", address);
  ros2::Trigger::Response response{};
  response.success = !beacons.empty();
  response.message = borrow_string(message);
  reply(response);
}

}  // namespace sonopose::ros2::relay
