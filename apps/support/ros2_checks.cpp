// Conversion and validation of the command line. Each error names its option.

#include "logging/log.hpp"
#include "ros2/inputs/wheels_file.hpp"
#include "ros2_options.hpp"
#include <sonopose/ros2/messages/beacon_topics.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace sonopose::apps {
namespace {

/// Calls `make` and adds the option to the text of an exception.
template <class Make>
auto with_option(const std::string& option, const Make& make) {
  try {
    return make();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(option + ": " + error.what());
  }
}

ros2::NameResolver resolver_of(const Ros2Options& options) {
  with_option("--name", [&] { ros2::check_node_name(options.node.name); });
  with_option("--namespace", [&] { ros2::check_namespace(options.node.name_space); });
  with_option("--enclave", [&] { ros2::check_enclave(options.enclave); });
  return with_option("--remap", [&] {
    std::vector<ros2::RemapRule> rules;
    for (const std::string& rule : options.remap) rules.push_back(ros2::parse_remap_rule(rule));
    return ros2::NameResolver(options.node, std::move(rules));
  });
}

void check_topics(const ros2::relay::RelayOptions& relay) {
  const std::string& pattern = relay.output.beacon_namespace;
  with_option("--beacon-namespace '" + pattern + "'", [&] {
    if (!ros2::has_topics_per_beacon(pattern) && !relay.addresses.only_one()) {
      throw std::invalid_argument(
          "without {address} all beacons would share the same topics; it needs a single beacon, as in "
          "--addresses 7");
    }
    ros2::check_beacon_namespace(relay.names, pattern);
  });
  with_option("--remap", [&] { ros2::check_outputs_differ(relay.names, pattern); });
}

void check_mount(const Ros2Options& options) {
  if (!options.output.mount_from_tf) return;
  const auto refuse = [](const char* other) {
    throw std::invalid_argument(std::string("--mount-from-tf: another node publishes the mount, so ") +
                                other + " has no meaning");
  };
  if (options.mount != decltype(options.mount){}) refuse("--mount");
  if (options.output.tf_static == true) refuse("--tf-static on");
}

void check_frames(const ros2::FrameNames& frames) {
  try {
    check(frames);
  } catch (const ros2::FrameError& error) {
    throw std::invalid_argument("--" + error.frame() + "-frame: " + error.what());
  }
}

/// Checks inputs by the resolved names of their topics: "imu" and "/imu" are often the same one.
template <class Input>
void check_resolved(const ros2::NameResolver& names, std::vector<Input> inputs) {
  for (Input& input : inputs) {
    input.topic = with_option(text_of(input), [&] { return names.topic(input.topic); });
  }
  check(inputs);
}

/// Prefers the option to the variable, which is then not validated.
std::optional<ros2::Distro> select_distro(const Ros2Options& options, const ros2::Variables& environment) {
  if (options.distro) return options.distro;
  const ros2::FoundDistro found = ros2::distro_of(environment);
  if (!found.warning.empty()) {
    logging::warning(fmt::format("{}; use --ros-distro to choose another", found.warning));
  }
  return found.distro;
}

void add_aiding_inputs(const Ros2Options& options, ros2::relay::RelayOptions& relay) {
  using ros2::AidingInput;
  using Kind = AidingInput::Kind;
  const std::array<std::pair<Kind, const std::vector<std::string>*>, 6> given{
      {{Kind::odometry, &options.odom_in},
       {Kind::twist, &options.twist_in},
       {Kind::wheels, &options.wheel_in},
       {Kind::heading, &options.heading_in},
       {Kind::pose, &options.pose_in},
       {Kind::set_pose, &options.set_pose_in}}};
  if (options.wheels.has_value() == options.wheel_in.empty()) {
    throw std::invalid_argument("--wheel-in and --wheels need each other");
  }
  for (const auto& [kind, texts] : given) {
    for (const std::string& text : *texts) relay.aiding_inputs.push_back(AidingInput::parse(kind, text));
  }
  for (AidingInput& input : relay.aiding_inputs) {
    if (input.kind == Kind::wheels) input.wheels = ros2::read_wheels(*options.wheels);
  }
  check_resolved(relay.names, relay.aiding_inputs);
  const bool has_service = std::ranges::any_of(relay.aiding_inputs, [](const AidingInput& input) {
    return input.type == AidingInput::Type::set_pose_service;
  });
  if (has_service && options.services == ros2::relay::ServicesMode::off) {
    throw std::invalid_argument(
        "--set-pose-in with SetPose is a service, which --services off does not offer");
  }
}

/// Converts "uav_1" or "/uav_1" to "/uav_1", and "/" to "".
std::string absolute_namespace(const std::string& option, const std::string& name_space) {
  if (name_space.empty() || name_space == "/") return "";
  const std::string absolute = name_space.starts_with('/') ? name_space : "/" + name_space;
  with_option(option, [&] { ros2::check_namespace(absolute); });
  return absolute;
}

std::optional<ros2::relay::AutopilotOptions> autopilot_options(const Ros2Options& options) {
  using Autopilot = ros2::relay::AutopilotOptions;
  if (!options.px4 && !options.ardupilot) {
    if (options.north_rad) throw std::invalid_argument("--north needs --px4 or --ardupilot");
    return std::nullopt;
  }
  Autopilot autopilot{.kind = options.px4 ? Autopilot::Kind::px4 : Autopilot::Kind::ardupilot,
                      .name_space = options.px4 ? absolute_namespace("--px4", *options.px4)
                                                : absolute_namespace("--ardupilot", *options.ardupilot)};
  if (options.ardupilot && autopilot.name_space.empty() && options.output.tf != ros2::relay::TfMode::off) {
    throw std::invalid_argument("--ardupilot /: the relay's own transforms are on /tf too; add --tf off");
  }
  if (options.output.rate_hz > 0) autopilot.rate_hz = options.output.rate_hz;
  autopilot.north_rad = options.north_rad;
  return autopilot;
}

}  // namespace

ros2::NodeName node_name(const Ros2Options& options) {
  return resolver_of(options).node();
}

ros2::relay::RelayOptions relay_options(const Ros2Options& options, const ros2::Variables& environment) {
  check_frames(options.output.frames);
  check_mount(options);
  ros2::relay::RelayOptions relay{.domain = {},
                                  .qos_file = {},
                                  .names = resolver_of(options),
                                  .distro = select_distro(options, environment),
                                  .enclave = options.enclave,
                                  .addresses = {},
                                  .max_beacons = options.max_beacons,
                                  .output = options.output,
                                  .inputs = {},
                                  .aiding_inputs = {},
                                  .services = options.services,
                                  .startup_settings = {}};
  relay.output.mount = with_option("--mount", [&] { return ros2::mount_at(options.mount); });
  if (options.addresses) {
    relay.addresses =
        with_option("--addresses", [&] { return presence::AddressSet::parse(*options.addresses); });
  }
  check_topics(relay);
  using Kind = ros2::Input::Kind;
  for (const auto& text : options.imu_in) relay.inputs.push_back(ros2::Input::parse(Kind::imu, text));
  for (auto& input : relay.inputs) input.imu_meaning = options.imu_meaning.value_or(input.imu_meaning);
  for (const auto& text : options.fix_in) relay.inputs.push_back(ros2::Input::parse(Kind::fix, text));
  check_resolved(relay.names, relay.inputs);
  add_aiding_inputs(options, relay);
  relay.autopilot = autopilot_options(options);
  relay.use_sim_time = options.use_sim_time;
  if (options.imu_meaning && options.imu_in.empty()) {
    throw std::invalid_argument("--imu-meaning only works with --imu-in");
  }
  for (const ros2::Input& input : relay.inputs) {
    if (!options.imu_meaning || input.imu_type == ros2::ImuType::ros) continue;
    throw std::invalid_argument(text_of(input) +
                                ": its samples state what they are, so --imu-meaning has no meaning");
  }
  return relay;
}

}  // namespace sonopose::apps
