#pragma once
/// \file
/// The poses of one beacon for an autopilot, over the agent of uXRCE-DDS.

#include "autopilot/external_odometry.hpp"
#include "autopilot/external_vision_gate.hpp"
#include "autopilot/remote_clock.hpp"
#include "ros2/relay/relay.hpp"
#include "threads/mutex.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/messages/time.hpp>
#include <sonopose/ros2/node/node.hpp>
#include <sonopose/samples/pose.hpp>

#include <optional>
#include <string>

namespace sonopose::ros2::relay {

/// Writes PX4's /fmu/in/vehicle_visual_odometry, in the clock of /fmu/out/timesync_status, or ArduPilot's
/// /ap/tf, in that of /ap/clock. A vehicle has one beacon: the first that is heard.
class AutopilotOutput {
public:
  /// `node` must outlive it. Throws std::invalid_argument for an impossible namespace,
  /// dds::core::Exception.
  AutopilotOutput(ros2::Node& node, const AutopilotOptions& options);
  AutopilotOutput(const AutopilotOutput&) = delete;
  AutopilotOutput& operator=(const AutopilotOutput&) = delete;
  ~AutopilotOutput() = default;

  /// Takes every pose, on a receive thread. `mount`: empty if it is unknown.
  void on(const FusedPose& pose, const std::optional<ros2::Mount>& mount);

  /// Logs that poses are sent, or why no longer. Main thread, once a second.
  void log_changes();

private:
  /// A pose that is due, with its times in the autopilot's clock.
  struct Due {
    autopilot::ExternalOdometry odometry;
    TimeNs measured_ns = 0;
    TimeNs now_ns = 0;
    std::uint8_t reset_counter = 0;
    std::uint8_t quality_percent = 0;
  };

  void on(const ros2::TimesyncStatus& status);
  void on(const ros2::Clock& message);
  void on_stamp(TimeNs stamp_ns);
  std::optional<Due> due(const FusedPose& pose, const std::optional<ros2::Mount>& mount);
  [[nodiscard]] std::optional<autopilot::NotSent> state_at(SteadyTime now) const SONOPOSE_REQUIRES(mutex_);
  [[nodiscard]] autopilot::NotSent reason_not_sent(const autopilot::ExternalOdometry& odometry,
                                                   bool has_clock) const SONOPOSE_REQUIRES(mutex_);

  bool is_px4_;
  const char* name_;
  std::string pose_topic_;
  std::string clock_topic_;
  autopilot::North north_;
  std::optional<autopilot::NotSent> logged_;  ///< main thread only, like the next one
  bool logged_others_ = false;

  threads::Mutex mutex_;
  autopilot::ExternalVisionGate gate_ SONOPOSE_GUARDED_BY(mutex_);
  autopilot::RemoteClock clock_ SONOPOSE_GUARDED_BY(mutex_);
  bool has_unix_clock_ SONOPOSE_GUARDED_BY(mutex_) = false;
  ros2::RateThinner rate_ SONOPOSE_GUARDED_BY(mutex_);
  ros2::RisingStamp stamp_ SONOPOSE_GUARDED_BY(mutex_){0};
  std::optional<BeaconAddress> address_ SONOPOSE_GUARDED_BY(mutex_);
  std::optional<BeaconAddress> other_ SONOPOSE_GUARDED_BY(mutex_);       ///< a beacon that is not sent
  std::optional<autopilot::NotSent> state_ SONOPOSE_GUARDED_BY(mutex_);  ///< at the last pose, if any
  SteadyTime posed_ SONOPOSE_GUARDED_BY(mutex_);                         ///< last pose, or the start

  dds::ext::SampleListener<ros2::TimesyncStatus> px4_listener_{
      [this](const ros2::TimesyncStatus& status, const auto&) { on(status); }};
  dds::ext::SampleListener<ros2::Clock> clock_listener_{
      [this](const ros2::Clock& message, const auto&) { on(message); }};
  dds::pub::DataWriter<ros2::VehicleOdometry> odometry_writer_ = dds::core::null;  ///< PX4's; otherwise nil
  dds::pub::DataWriter<ros2::TFMessage> tf_writer_ = dds::core::null;  ///< ArduPilot's; otherwise nil
  // Last, so that they are destroyed first.
  dds::sub::DataReader<ros2::TimesyncStatus> timesync_reader_ = dds::core::null;
  dds::sub::DataReader<ros2::Clock> clock_reader_ = dds::core::null;
};

}  // namespace sonopose::ros2::relay
