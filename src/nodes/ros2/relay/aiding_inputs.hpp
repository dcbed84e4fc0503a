#pragma once
/// \file
/// Velocities, headings and poses of ROS 2 drivers as samples of beacons.

#include "logging/log.hpp"
#include "publication/source.hpp"
#include "ros2/inputs/aiding_input.hpp"
#include "ros2/inputs/beacon_inputs.hpp"
#include "ros2/inputs/input_frames.hpp"
#include "ros2/inputs/input_monitor.hpp"
#include <sonopose/dds/psm/discovery.hpp>
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace sonopose::ros2::relay {

/// A service by which users set a pose.
struct SetPoseService {
  std::string name;
  std::function<void(const ros2::PoseWithCovarianceStamped& pose)> take;  ///< for any thread
};

/// Reads and monitors such topics. The constructor, which creates the readers, and check_type() are for the
/// thread of the node, samples_lost() for any, and the others for the thread that runs the source.
class AidingInputs {
public:
  using Log = std::function<void(logging::Level level, const std::string& line)>;
  /// Time of reception, in the clock of ROS 2 and in that of the stamps of an input's beacon.
  struct Received {
    TimeNs time_ns = 0;
    TimeNs in_stamps_ns = 0;
  };
  using Reception = std::function<Received(const AidingInput& input)>;

  /// `timeout_ns`: time after which a topic is silent. Throws dds::core::Exception.
  AidingInputs(ros2::Node& node, const std::vector<AidingInput>& inputs, InputFrames frames,
               TimeNs timeout_ns);
  ~AidingInputs();
  AidingInputs(const AidingInputs&) = delete;
  AidingInputs& operator=(const AidingInputs&) = delete;

  /// Services whose requests the owner passes on, while this object exists.
  [[nodiscard]] std::vector<SetPoseService> services();
  void attach_to(dds::core::cond::WaitSet& waitset);
  void take(publication::SampleSink& sink, const Reception& reception, InputMonitor::Lines& lines);
  /// Adds lines about silence and losses, and those of `check`, which compares the clocks of an input.
  void update(SteadyTime now, InputMonitor::Lines& lines,
              const std::function<void(MonitoredInput& input)>& check = {});
  /// Logs a publisher of one of the topics with another type, once for each type.
  void check_type(const dds::FoundEndpoint& writer, const Log& log);
  /// Number of messages that were not used.
  [[nodiscard]] std::uint64_t unused(BeaconAddress address) const;
  [[nodiscard]] std::uint64_t samples_lost(BeaconAddress address) const noexcept;

private:
  class Topic;
  template <class T>
  class TopicOf;
  class SetPoses;
  InputFrames frames_;
  std::vector<std::unique_ptr<Topic>> topics_;
};

}  // namespace sonopose::ros2::relay
