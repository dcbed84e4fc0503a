#include "ros2_options.hpp"

#include "choice.hpp"
#include "run.hpp"
#include <sonopose/ros2/beacon_topics.hpp>

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>

namespace sonopose::apps {
namespace {

void add_node_options(CLI::App& app, Ros2Options& options) {
  const char* const group = "ROS 2 node";
  app.add_option("--name", options.node.name, "Name of the node")->capture_default_str()->group(group);
  app.add_option("--namespace", options.node.name_space, "Namespace of the node")
      ->capture_default_str()
      ->group(group);
  app.add_option("-r,--remap", options.remap, "Other names, as ROS 2 has it: /hedge_7/odom:=/odom (several)")
      ->type_name("FROM:=TO")
      ->group(group);
  app.add_option("--enclave", options.enclave, "Security enclave to tell of")
      ->capture_default_str()
      ->group(group);
  app.add_option_function<std::string>(
         "--ros-distro", [&options](const std::string& name) { options.distro = ros2::distro_named(name); },
         "How the node tells of itself: humble, or jazzy for Iron and later; the other distributions' names "
         "work too (default: as ROS_DISTRO says, else jazzy)")
      ->check(one_of(ros2::distro_names()))
      ->option_text("humble|jazzy")
      ->group(group);
}

void add_frame_options(CLI::App& app, Ros2Options& options) {
  const char* const group = "Frames";
  const auto frame = [&](const char* name, std::string& value, const char* what) {
    app.add_option(name, value, what)->capture_default_str()->type_name("FRAME")->group(group);
  };
  frame("--map-frame", options.output.frames.map, "The beacons' world; {address} stands for the beacon's");
  frame("--odom-frame", options.output.frames.odom, "Another source's odometry");
  frame("--base-frame", options.output.frames.base, "The robot");
  frame("--imu-frame", options.output.frames.imu, "The IMU's axes");
  app.add_option("--mount", options.mount, "Where the IMU sits on the robot: x y z (m) roll pitch yaw (deg)")
      ->type_name("N")
      ->group(group);
  add_choice<nodes::TfMode>(
      app, "--tf", options.output.tf,
      {{"map_base", nodes::TfMode::map_base},
       {"map_odom", nodes::TfMode::map_odom},
       {"off", nodes::TfMode::off}},
      "Transforms: map to base; or map to odom, where /tf has odom to base from another source; or none")
      ->group(group);
}

void add_message_options(CLI::App& app, Ros2Options& options) {
  const char* const group = "Messages";
  app.add_option("--addresses", options.addresses, "Relay these beacons alone: 7, 7-131 or 7-131,200")
      ->type_name("LIST")
      ->group(group);
  app.add_option("--beacon-namespace", options.output.beacon_namespace,
                 "Where a beacon's topics are; '' with a single beacon: right in the node's namespace")
      ->capture_default_str()
      ->group(group);
  add_choice<nodes::FixMessage>(app, "--fix-message", options.output.fix,
                                {{"pose", nodes::FixMessage::pose}, {"point", nodes::FixMessage::point}},
                                "Fixes as PoseWithCovarianceStamped or as PointStamped")
      ->group(group);
  app.add_option("--path", options.output.path_s, "Publish the way of the last S seconds")
      ->check(number_between(0.0, 3600.0))
      ->type_name("S")
      ->group(group);
  const auto deviation = [&](const char* name, double& value, double most, const char* what) {
    app.add_option(name, value, what)
        ->check(number_between(1e-12, most))
        ->capture_default_str()
        ->group(group);
  };
  deviation("--gyro-std", options.output.noise.gyro_std_radps, 1e3, "Standard deviation of the gyro, rad/s");
  deviation("--accel-std", options.output.noise.accel_std_mps2, 1e3, "Of the accelerometer, m/s^2");
  deviation("--magnetic-std", options.output.noise.magnetic_std_t, 1e3, "Of the magnetometer, T");
  deviation("--tilt-std", options.output.noise.tilt_std_deg, 180, "Of roll and pitch, deg");
}

void add_input_options(CLI::App& app, Ros2Options& options) {
  const char* const group = "From ROS 2";
  app.add_option("--imu-in", options.imu_in, "Take a driver's sensor_msgs/Imu in as a beacon's: /imu/data=7")
      ->type_name("TOPIC=ADDRESS")
      ->group(group);
  app.add_option("--fix-in", options.fix_in,
                 "Take positions in, PointStamped or PoseWithCovarianceStamped: /tag/pose=7")
      ->type_name("TOPIC=ADDRESS")
      ->group(group);
}

/// The bus of the other programs is loopback; this one is where ROS 2's nodes are.
void describe_network(CLI::App& app) {
  app.get_option("--network")
      ->option_text("loopback|lan (default: as far as ROS 2's variables say)")
      ->description(
          "loopback: this machine alone; lan: the interface that Cyclone DDS chooses, and then no bridge or "
          "fusion on loopback is heard (a CYCLONEDDS_URI of your own wins over both)");
}

/// What `make` returns; what it throws names the option.
template <class Make>
auto by_option(const std::string& option, const Make& make) {
  try {
    return make();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(option + ": " + error.what());
  }
}

ros2::NameResolver names_by(const Ros2Options& options) {
  by_option("--name", [&] { ros2::check_node_name(options.node.name); });
  by_option("--namespace", [&] { ros2::check_namespace(options.node.name_space); });
  by_option("--enclave", [&] { ros2::check_enclave(options.enclave); });
  return by_option("--remap", [&] {
    std::vector<ros2::RemapRule> rules;
    for (const std::string& rule : options.remap) rules.push_back(ros2::parse_remap_rule(rule));
    return ros2::NameResolver(options.node, std::move(rules));
  });
}

void check_topics(const nodes::Ros2RelayOptions& relay) {
  const std::string& pattern = relay.output.beacon_namespace;
  by_option("--beacon-namespace '" + pattern + "'", [&] {
    if (!ros2::tells_topics_apart(pattern) && !relay.addresses.only_one()) {
      throw std::invalid_argument(
          "without {address} all beacons would be in the same topics; that goes with a single beacon, as in "
          "--addresses 7");
    }
    ros2::check_beacon_namespace(relay.names, pattern);
  });
  by_option("--remap", [&] { ros2::check_outputs_differ(relay.names, pattern); });
}

void check_frames(const ros2::FrameNames& frames) {
  try {
    check(frames);
  } catch (const ros2::FrameError& error) {
    throw std::invalid_argument("--" + error.frame() + "-frame: " + error.what());
  }
}

/// A variable that is wrong does not matter where the option says it.
ros2::Distro distro_by(const Ros2Options& options, const ros2::Variables& environment) {
  if (options.distro) return *options.distro;
  const ros2::FoundDistro found = ros2::distro_of(environment);
  if (!found.warning.empty()) {
    fmt::print(stderr, "sonopose-ros2: warning: {}; --ros-distro says otherwise\n", found.warning);
  }
  return found.distro;
}

}  // namespace

void add_ros2_options(CLI::App& app, Ros2Options& options) {
  describe_network(app);
  add_node_options(app, options);
  add_message_options(app, options);
  add_frame_options(app, options);
  add_input_options(app, options);
}

nodes::Ros2RelayOptions relay_options(const Ros2Options& options, const ros2::Variables& environment) {
  check_frames(options.output.frames);
  nodes::Ros2RelayOptions relay{.domain = {},
                                .qos_file = {},
                                .names = names_by(options),
                                .distro = distro_by(options, environment),
                                .enclave = options.enclave,
                                .addresses = {},
                                .output = options.output,
                                .inputs = {}};
  relay.output.mount = by_option("--mount", [&] { return ros2::mount_at(options.mount); });
  if (options.addresses) {
    relay.addresses = by_option("--addresses", [&] { return nodes::AddressSet::parse(*options.addresses); });
  }
  check_topics(relay);
  using Kind = nodes::Ros2Input::Kind;
  for (const auto& text : options.imu_in) relay.inputs.push_back(nodes::Ros2Input::parse(Kind::imu, text));
  for (const auto& text : options.fix_in) relay.inputs.push_back(nodes::Ros2Input::parse(Kind::fix, text));
  return relay;
}

}  // namespace sonopose::apps
