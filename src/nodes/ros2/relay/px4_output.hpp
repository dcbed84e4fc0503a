#pragma once
/// \file
/// The poses of one beacon for PX4, over the agent of uXRCE-DDS.

#include "autopilot/external_odometry.hpp"
#include "autopilot/pose_watch.hpp"
#include "autopilot/remote_clock.hpp"
#include "ros2/relay/log.hpp"
#include "ros2/relay/relay.hpp"
#include "threads/mutex.hpp"
#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/messages/time.hpp>
#include <sonopose/ros2/node/node.hpp>
#include <sonopose/samples/pose.hpp>

#include <optional>
#include <string>

namespace sonopose::ros2::relay {

/// Writes /fmu/in/vehicle_visual_odometry, in the clock of /fmu/out/timesync_status. A vehicle has one
/// beacon: the first that is heard.
class Px4Output {
public:
  /// `node` and `log` must outlive it. Throws std::invalid_argument for an impossible namespace, dds::Error.
  Px4Output(ros2::Node& node, const AutopilotOptions& options, Log& log);
  Px4Output(const Px4Output&) = delete;
  Px4Output& operator=(const Px4Output&) = delete;
  Px4Output(Px4Output&&) = delete;
  Px4Output& operator=(Px4Output&&) = delete;
  ~Px4Output() = default;

  /// Takes every pose, on a receive thread.
  void on(const FusedPose& pose, const ros2::Mount& mount);

  /// Logs that poses are sent, or why no longer. Main thread, once a second.
  void log_changes();

private:
  class ClockListener final : public dds::DataReaderListener<ros2::TimesyncStatus> {
  public:
    explicit ClockListener(Px4Output& output) : output_(output) {}
    void on_data_available(dds::DataReader<ros2::TimesyncStatus>& reader) noexcept override;

  private:
    Px4Output& output_;
  };

  std::optional<ros2::VehicleOdometry> message_for(const FusedPose& pose, const ros2::Mount& mount);

  std::string odometry_topic_;
  std::string clock_topic_;
  autopilot::North north_;
  Log& log_;
  std::optional<autopilot::Silence> logged_;  ///< main thread only, like the next one
  bool logged_others_ = false;

  threads::Mutex mutex_;
  autopilot::PoseWatch watch_ SONOPOSE_GUARDED_BY(mutex_);
  autopilot::RemoteClock clock_ SONOPOSE_GUARDED_BY(mutex_);
  ros2::RateLimit rate_ SONOPOSE_GUARDED_BY(mutex_);
  ros2::RisingStamp stamp_ SONOPOSE_GUARDED_BY(mutex_){0};
  std::optional<BeaconAddress> address_ SONOPOSE_GUARDED_BY(mutex_);
  std::optional<BeaconAddress> other_ SONOPOSE_GUARDED_BY(mutex_);       ///< a beacon that is not sent
  std::optional<autopilot::Silence> state_ SONOPOSE_GUARDED_BY(mutex_);  ///< empty before the first pose

  ClockListener listener_{*this};
  dds::DataWriter<ros2::VehicleOdometry> writer_;
  dds::DataReader<ros2::TimesyncStatus> clock_reader_;  ///< last, so that it is destroyed first
};

}  // namespace sonopose::ros2::relay
