// sonopose-ros2: a ROS 2 node without rclcpp that publishes poses and samples as ROS 2 messages, and reads
// samples of ROS 2 drivers.

#include "support/ros2_command_line.hpp"
#include "support/security_options.hpp"

#include <exception>
#include <utility>

namespace {

using namespace sonopose;

/// Returns the options of the relay. Without --network, the discovery range follows the environment variables
/// of ROS 2.
ros2::relay::RelayOptions relay_options(apps::Ros2Program& program) {
  const ros2::Variables environment = sonopose::dds::environment_variables(ros2::variable_names());
  program.ros2.enclave = apps::announced_enclave(program.bus);
  auto options = apps::relay_options(program.ros2, environment);
  options.domain = program.bus.domain;
  if (program.app.count("--network") == 0) {
    options.domain = ros2::with_discovery_range(program.bus.domain, environment);
  }
  options.qos_file = program.bus.qos_file;
  return options;
}

int serve(const ros2::arguments::Arguments& arguments, apps::Ros2Program& program) {
  auto others = apps::apply_parameters(arguments, program);
  auto options = relay_options(program);
  options.startup_settings = std::move(others.settings);
  options.qos_overrides = std::move(others.qos_overrides);
  options.own_parameters = apps::option_parameters(program);
  options.own_parameters.merge(others.given);
  const auto level = apps::log_level(arguments, options.names.node(), program);
  const logging::Session log(level);
  options.rosout = arguments.rosout;
  if (!options.inputs.empty() || !options.aiding_inputs.empty()) apps::check_publisher(program.bus);
  process::StopSignal stop;
  stop.listen_to_signals();
  if (!apps::wait_for_network(options.domain, stop)) return 0;
  ros2::relay::Relay relay(options);
  apps::serve([&] { relay.run(stop); });
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  const auto arguments = ros2::arguments::split({argv + 1, argv + argc});
  apps::Ros2Program program;
  return apps::run(program.app, apps::own_arguments(arguments), [&] { return serve(arguments, program); });
} catch (const std::exception& error) {
  logging::failure(error.what());
  return apps::wrong_option;
}
