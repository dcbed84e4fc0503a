// A process with one ROS 2 node on loopback: /hall/locator writes imu/data and tf_static and reads fix_in. It
// prints "ready" when everything is announced, and ends on SIGTERM.
//
//   test_ros2_node DOMAIN humble|jazzy

#include <sonopose/ros2/node/node.hpp>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>

int main(int argc, char** argv) try {
  using namespace sonopose;
  namespace dds = sonopose::dds;
  if (argc != 3) return 2;
  sigset_t end{};
  sigemptyset(&end);
  sigaddset(&end, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &end, nullptr);

  const auto distro = std::string_view(argv[2]) == "humble" ? ros2::Distro::humble : ros2::Distro::jazzy;
  const dds::domain::DomainParticipant participant = dds::ext::participant(
      {.domain_id = static_cast<std::uint32_t>(std::strtoul(argv[1], nullptr, 10))}, ros2::participant_qos());
  const dds::qos::Provider qos;
  ros2::Node node(participant, qos, ros2::NameResolver({.name_space = "/hall", .name = "locator"}), distro);
  const auto imu = node.make_writer<ros2::Imu>("imu/data", "ros2::SensorData");
  const auto transforms = node.make_writer<ros2::TFMessage>("/tf_static", "ros2::TfStatic");
  const auto fixes = node.make_reader<ros2::PointStamped>("~/fix_in", "ros2::SensorData");
  node.announce();
  std::puts("ready");
  std::fflush(stdout);
  int signal = 0;
  sigwait(&end, &signal);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
