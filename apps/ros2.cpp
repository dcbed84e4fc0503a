// sonopose-ros2: a ROS 2 node without rclcpp that publishes poses and samples as ROS 2 messages, and reads
// samples of ROS 2 drivers.

#include "support/bus_options.hpp"
#include "support/ros2_options.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace {

using namespace sonopose;

/// Without --network, the discovery range follows the environment variables of ROS 2.
ros2::relay::RelayOptions node_options(const CLI::App& app, const apps::BusOptions& bus,
                                       const apps::Ros2Options& ros2) {
  const ros2::Variables environment = dds::environment_variables(ros2::variable_names());
  auto options = apps::relay_options(ros2, environment);
  options.domain = bus.domain;
  if (app.count("--network") == 0) options.domain = ros2::with_discovery_range(bus.domain, environment);
  options.qos_file = bus.qos_file;
  return options;
}

int serve(const CLI::App& app, const apps::BusOptions& bus, const apps::Ros2Options& ros2) {
  const auto options = node_options(app, bus, ros2);
  if (!options.inputs.empty()) apps::check_publisher(bus);
  process::StopSignal stop;
  stop.listen_to_signals();
  ros2::relay::Relay relay(options);
  fmt::print(stderr, "sonopose-ros2: relaying as {}\n", ros2::full_name(options.names.node()));
  relay.run(stop);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  apps::BusOptions bus;
  apps::Ros2Options ros2;
  apps::Program app("ros2");
  apps::add_bus_options(app, bus);
  apps::add_ros2_options(app, ros2);
  return apps::run(app, argc, argv, [&] { return serve(app, bus, ros2); });
}
