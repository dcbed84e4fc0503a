#pragma once
/// \file
/// The relay process: a ROS 2 node that publishes native samples and poses as standard messages, and samples
/// of ROS 2 drivers as native topics.

#include "presence/address_set.hpp"
#include "presence/beacon_admission.hpp"
#include "process/stop_signal.hpp"
#include "ros2/relay/parameters.hpp"
#include "ros2/relay/presence.hpp"
#include "ros2/relay/source.hpp"
#include "ros2/relay/startup_settings.hpp"
#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/ros2/messages/beacon_topics.hpp>
#include <sonopose/ros2/messages/covariance.hpp>
#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace sonopose::ros2::relay {

/// Limit of relayed beacons. Each has up to seven writers and their topics, and Cyclone DDS 0.10 limits a
/// participant to 16,383 of both.
inline constexpr std::size_t max_relayed_beacons = 1000;

/// The transform that locates the robot (REP-105: a frame has one parent).
enum class TfMode : std::uint8_t {
  map_base,  ///< map → base_link: no other source of the base's pose
  map_odom,  ///< map → odom: another source publishes odom → base_link
  off
};

/// Availability of the parameter services.
enum class ServicesMode : std::uint8_t {
  automatic,  ///< unless a process uses Fast DDS, which would wait for a reply forever
  on,
  off
};

enum class FixMessage : std::uint8_t { pose, point };

/// The messages of a beacon.
struct Output {
  std::string beacon_namespace = "hedge_{address}";  ///< relative to the node's namespace
  ros2::FrameNames frames;
  ros2::Mount mount;
  bool mount_from_tf = false;  ///< takes the mount from /tf_static
  ros2::Noise noise;
  TfMode tf = TfMode::map_base;
  std::optional<bool> tf_static = std::nullopt;  ///< empty: unless `tf` is off
  FixMessage fix = FixMessage::pose;
  std::set<std::string> topics{ros2::beacon_topics().begin(), ros2::beacon_topics().end()};
  double rate_hz = 0;  ///< most poses and transforms per second; 0: all
  double path_s = 0;   ///< length of `path` in seconds; 0: no path

  /// True if the transform from the base to the IMU is published. Without `tf`, another node owns the tree.
  [[nodiscard]] bool publishes_mount() const {
    return tf_static.value_or(tf != TfMode::off && !mount_from_tf);
  }
};

/// Poses for an autopilot.
struct AutopilotOptions {
  enum class Kind : std::uint8_t { px4, ardupilot };
  Kind kind = Kind::px4;
  std::string name_space;  ///< prefix of its topics: "/uav_1"; empty: none
  double rate_hz = 30;
  std::optional<double> north_rad = {};  ///< direction of north in the map, counter-clockwise from x
};

struct RelayOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  ros2::NameResolver names;
  std::optional<ros2::Distro> distro;  ///< empty: that of the other ROS 2 processes
  std::string enclave = "/";
  ros2::QosOverrides qos_overrides = {};
  presence::AddressSet addresses;
  std::size_t max_beacons = presence::BeaconAdmission::default_max_beacons;  ///< most beacons at a time
  Output output;
  std::vector<Input> inputs;
  std::vector<AidingInput> aiding_inputs;
  std::optional<AutopilotOptions> autopilot = {};
  bool use_sim_time = false;  ///< takes the time of ROS 2 from /clock
  ServicesMode services = ServicesMode::automatic;
  std::vector<StartupSetting> startup_settings;  ///< sent when a fusion appears and no other is known
  OptionParameters own_parameters = {};          ///< these options, for the parameter services
  bool rosout = true;                            ///< publishes log lines
  Presence::Limits presence = {};                ///< times after which a beacon is stale and gone
};

/// Publishes samples and poses on Cyclone's receive thread as they arrive. The main thread creates a beacon's
/// writers after its first sample, and closes them when the beacon is gone. Earlier samples are not
/// published.
class Relay {
public:
  /// Joins the domain and starts to relay. Throws dds::core::Exception, dds::qos::FileError,
  /// std::invalid_argument.
  explicit Relay(const RelayOptions& options);
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;
  ~Relay();

  /// Creates the writers of new beacons, and publishes diagnostics once per second, until the stop. Throws if
  /// an input fails.
  void run(const process::StopSignal& stop);

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonopose::ros2::relay
