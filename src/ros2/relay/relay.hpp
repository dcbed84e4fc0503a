#pragma once
/// \file
/// The relay process: a ROS 2 node that hands the native samples and poses on as standard messages, and takes
/// samples of ROS 2 drivers in.

#include <sonopose/dds/binding/domain.hpp>
#include "process/address_set.hpp"
#include "ros2/relay/source.hpp"
#include "process/stop_signal.hpp"
#include <sonopose/ros2/messages/covariance.hpp>
#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/ros2/messages/node.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::ros2 {

/// Which transform says where the robot is (REP-105: a frame has one parent).
enum class TfMode : std::uint8_t {
  map_base,  ///< map → base_link: nothing else knows where the base is
  map_odom,  ///< map → odom: another source publishes odom → base_link
  off
};

enum class FixMessage : std::uint8_t { pose, point };

/// What the messages of a beacon are like.
struct Ros2Output {
  std::string beacon_namespace = "hedge_{address}";  ///< of its topics, within the node's namespace
  ros2::FrameNames frames;
  ros2::Mount mount;
  ros2::Noise noise;
  TfMode tf = TfMode::map_base;
  FixMessage fix = FixMessage::pose;
  double path_s = 0;  ///< how much of the way `path` shows; 0: there is none
};

struct Ros2RelayOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  ros2::NameResolver names;
  ros2::Distro distro = ros2::Distro::jazzy;
  std::string enclave = "/";
  process::AddressSet addresses;
  Ros2Output output;
  std::vector<Ros2Input> inputs;
};

/// Samples and poses are handed on on Cyclone's receive thread, as they come. A beacon's topics are made when
/// it is first heard of, by the main thread; what came before they are there is not handed on.
class Ros2Relay {
public:
  /// Joins the domain and begins to relay. Throws dds::Error, dds::QosFileError, std::invalid_argument.
  explicit Ros2Relay(const Ros2RelayOptions& options);
  Ros2Relay(const Ros2Relay&) = delete;
  Ros2Relay& operator=(const Ros2Relay&) = delete;
  ~Ros2Relay();

  /// Makes the topics of new beacons, and tells of all once a second, until the stop. Throws what makes the
  /// input unusable.
  void run(const process::StopSignal& stop);

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonopose::ros2
