#include "ros2_options.hpp"

#include "run.hpp"

#include <map>

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
  const std::map<std::string, ros2::Distro> distros{{"humble", ros2::Distro::humble},
                                                    {"jazzy", ros2::Distro::jazzy}};
  app.add_option_function<ros2::Distro>(
         "--ros-distro", [&options](ros2::Distro distro) { options.distro = distro; },
         "How the node tells of itself: humble, or jazzy for Iron and later (default: as ROS_DISTRO says, "
         "else "
         "jazzy)")
      ->transform(CLI::CheckedTransformer(distros))
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
  const std::map<std::string, nodes::TfMode> modes{{"map_base", nodes::TfMode::map_base},
                                                   {"map_odom", nodes::TfMode::map_odom},
                                                   {"off", nodes::TfMode::off}};
  app.add_option(
         "--tf", options.output.tf,
         "Transforms: map to base; or map to odom, where /tf has odom to base from another source; or none")
      ->transform(CLI::CheckedTransformer(modes))
      ->option_text("map_base|map_odom|off (default: map_base)")
      ->group(group);
}

void add_message_options(CLI::App& app, Ros2Options& options) {
  const char* const group = "Messages";
  app.add_option("--addresses", options.addresses, "Relay these beacons alone: 7, 7-131 or 7-131,200")
      ->type_name("LIST")
      ->group(group);
  app.add_option("--beacon-namespace", options.output.beacon_namespace, "Where a beacon's topics are")
      ->capture_default_str()
      ->group(group);
  const std::map<std::string, nodes::FixMessage> fixes{{"pose", nodes::FixMessage::pose},
                                                       {"point", nodes::FixMessage::point}};
  app.add_option("--fix-message", options.output.fix, "Fixes as PoseWithCovarianceStamped or as PointStamped")
      ->transform(CLI::CheckedTransformer(fixes))
      ->option_text("pose|point (default: pose)")
      ->group(group);
  app.add_option("--path", options.output.path_s, "Publish the way of the last S seconds")
      ->check(number_between(0.0, 3600.0))
      ->type_name("S")
      ->group(group);
  const auto deviation = [&](const char* name, double& value, const char* what) {
    app.add_option(name, value, what)->check(number_between(1e-12, 1e3))->capture_default_str()->group(group);
  };
  deviation("--gyro-std", options.output.noise.gyro_std_radps, "Standard deviation of the gyro, rad/s");
  deviation("--accel-std", options.output.noise.accel_std_mps2, "Of the accelerometer, m/s^2");
  deviation("--magnetic-std", options.output.noise.magnetic_std_t, "Of the magnetometer, T");
  deviation("--tilt-std", options.output.noise.tilt_std_deg, "Of roll and pitch, deg");
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

}  // namespace

void add_ros2_options(CLI::App& app, Ros2Options& options) {
  add_node_options(app, options);
  add_message_options(app, options);
  add_frame_options(app, options);
  add_input_options(app, options);
}

nodes::Ros2RelayOptions relay_options(const Ros2Options& options, const ros2::Variables& environment) {
  std::vector<ros2::RemapRule> rules;
  for (const std::string& rule : options.remap) rules.push_back(ros2::parse_remap_rule(rule));
  check(options.output.frames);
  nodes::Ros2RelayOptions relay{.domain = {},
                                .qos_file = {},
                                .names = ros2::NameResolver(options.node, std::move(rules)),
                                .distro = {},
                                .enclave = options.enclave,
                                .addresses = {},
                                .output = options.output,
                                .inputs = {}};
  // A variable that is wrong does not matter where the option says it.
  relay.distro =
      options.distro ? *options.distro : ros2::distro_of(environment).value_or(ros2::Distro::jazzy);
  relay.output.mount = ros2::mount_at(options.mount);
  if (options.addresses) relay.addresses = nodes::AddressSet::parse(*options.addresses);
  using Kind = nodes::Ros2Input::Kind;
  for (const auto& text : options.imu_in) relay.inputs.push_back(nodes::Ros2Input::parse(Kind::imu, text));
  for (const auto& text : options.fix_in) relay.inputs.push_back(nodes::Ros2Input::parse(Kind::fix, text));
  return relay;
}

}  // namespace sonopose::apps
