#pragma once
/// \file
/// Velocities of ROS 2 drivers (wheel odometry) as samples of beacons.

#include "logging/log.hpp"
#include "publication/source.hpp"
#include "ros2/relay/input_monitor.hpp"
#include <sonopose/dds/binding/discovery.hpp>
#include <sonopose/dds/binding/waitset.hpp>
#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::ros2::relay {

/// One topic of velocities, and the address of its beacon.
struct TwistInput {
  enum class Type : std::uint8_t { odometry, twist_with_covariance, twist };
  Type type = Type::odometry;
  std::string topic;
  BeaconAddress address = 0;

  /// Parses "/odom=7" as nav_msgs/Odometry.
  static TwistInput parse_odometry(std::string_view text);
  /// Parses "/wheel/twist=7" as TwistWithCovarianceStamped, or "/wheel/twist:TwistStamped=7". Both throw
  /// std::invalid_argument.
  static TwistInput parse_twist(std::string_view text);
};

/// Throws std::invalid_argument for two topics of one beacon: their errors would be taken for independent.
void check(const std::vector<TwistInput>& inputs);

/// Reads and monitors topics of velocities. The constructor, which creates the readers, and check_type() are
/// for the thread of the node, samples_lost() for any, and the others for the thread that runs the source.
class TwistInputs {
public:
  using Log = std::function<void(logging::Level level, const std::string& line)>;
  /// Time of reception in the clock of the stamps of a beacon.
  using Reception = std::function<TimeNs(BeaconAddress address)>;

  /// Current mount of the IMU of a beacon on the base. Called on the thread that runs the source.
  using MountSource = std::function<ros2::Mount(BeaconAddress address)>;

  /// `timeout_ns`: time after which a topic is silent. Throws dds::Error.
  TwistInputs(ros2::Node& node, const std::vector<TwistInput>& inputs, MountSource mount, TimeNs timeout_ns);
  ~TwistInputs();
  TwistInputs(const TwistInputs&) = delete;
  TwistInputs& operator=(const TwistInputs&) = delete;

  void attach_to(dds::WaitSet& waitset);
  void take(publication::SampleSink& sink, const Reception& reception, InputMonitor::Lines& lines);
  /// Adds lines about silence and losses.
  void update(SteadyTime now, InputMonitor::Lines& lines);
  /// Logs a publisher of one of the topics with another type, once for each type.
  void check_type(const dds::FoundEndpoint& writer, const Log& log);
  [[nodiscard]] std::uint64_t samples_lost(BeaconAddress address) const noexcept;

private:
  class Topic;
  template <class T>
  class TopicOf;
  MountSource mount_;
  std::vector<std::unique_ptr<Topic>> topics_;
};

}  // namespace sonopose::ros2::relay
