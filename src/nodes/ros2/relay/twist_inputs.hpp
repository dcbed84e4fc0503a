#pragma once
/// \file
/// Velocities of ROS 2 drivers (wheel odometry) as samples of beacons.

#include "publication/source.hpp"
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

/// Reads topics of velocities. Its readers are created by the constructor, on the thread of the node; the
/// other members are for the thread that runs the source.
class TwistInputs {
public:
  /// Receives a line, once for each topic whose messages cannot be used.
  using Log = std::function<void(const std::string& line)>;
  /// Time of reception in the clock of the stamps of a beacon.
  using Reception = std::function<TimeNs(BeaconAddress address)>;

  /// `mount` is that of the IMU on the base. Throws dds::Error.
  TwistInputs(ros2::Node& node, const std::vector<TwistInput>& inputs, const ros2::Mount& mount);
  ~TwistInputs();
  TwistInputs(const TwistInputs&) = delete;
  TwistInputs& operator=(const TwistInputs&) = delete;

  void attach_to(dds::WaitSet& waitset);
  void take(publication::SampleSink& sink, const Reception& reception, const Log& log);

private:
  class Topic;
  template <class T>
  class TopicOf;
  std::vector<std::unique_ptr<Topic>> topics_;
};

}  // namespace sonopose::ros2::relay
