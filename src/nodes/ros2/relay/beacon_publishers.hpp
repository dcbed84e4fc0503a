#pragma once
// Writers of the ROS 2 topics of one beacon.

#include "observation/first_reports.hpp"
#include "ros2/relay/fix_queue.hpp"
#include "ros2/relay/imu_pairing.hpp"
#include "ros2/relay/odometry_buffer.hpp"
#include "ros2/relay/relay.hpp"
#include "threads/guarded.hpp"
#include "threads/mutex.hpp"
#include "transitions/transition_detector.hpp"
#include <sonopose/ros2/messages/beacon_topics.hpp>
#include <sonopose/ros2/messages/messages.hpp>
#include <sonopose/ros2/messages/time.hpp>
#include <sonopose/samples/live_settings.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <atomic>
#include <deque>
#include <optional>
#include <string>

namespace sonopose::ros2::relay {

/// Standard deviation of a fix of unknown noise: that with which the Kalman engine starts.
inline constexpr double unknown_fix_std_m = 0.05;

/// Returns the standard deviation of a fix without a learned one: with the documented engine its setting.
double fix_std_of(const EffectiveSettings& settings);

/// Publishers of one beacon. `on` runs on Cyclone's receive thread or, for samples that this process
/// publishes, on the bridge's thread. Locks are held for computations only, never while writing.
class BeaconPublishers {
public:
  /// Creates the writers. `tf`: writer of transforms, nil in mode off; must outlive this object. `in_tree`:
  /// publish transforms of this beacon. `wakeup`: wakes the main thread; must outlive this object, too.
  BeaconPublishers(ros2::Node& node, const Output& output, BeaconAddress address,
                   dds::pub::DataWriter<ros2::TFMessage>& tf, bool in_tree, process::Wakeup& wakeup);

  void on(const ImuSample& sample);
  void on(const FusedPose& pose);
  /// Changes of state in its poses and reports since the last call. Main thread only.
  transitions::TransitionQueue take_transitions();
  void on(const UltrasonicFix& fix);
  void on(const FixReport& report);
  /// `fix_std_m`: setting of the fusion.
  void set_fix_std(double fix_std_m) { fix_std_m_ = fix_std_m; }
  void on(const Estimate& estimate);
  /// Takes a transform odom → base_link of another odometry source.
  void on_odometry(TimeNs time_ns, const ros2::Transform& base_in_odom);

  /// Creates the writer of the magnetic field after the first sample with one, which wakes the main thread.
  /// Main thread only.
  void create_magnetic_writer(ros2::Node& node);
  /// Publishes fixes without a report of the fusion, and gives up poses without an IMU sample. Each IMU
  /// sample does the former, too.
  void handle_overdue();
  /// Publishes the path. Main thread only, once per second.
  void publish_path();
  /// Removes its writers from the node, before it is destroyed. Main thread only.
  void leave(ros2::Node& node) const;

  /// Number of `imu/data` messages that were not published because the pose's sample did not arrive.
  [[nodiscard]] std::uint64_t imu_data_lost() const;
  /// Sets the mount of the IMU, without which there are no poses. Returns true if it is another one.
  bool set_mount(const ros2::Mount& mount);
  /// The mount; empty if it is not known yet.
  [[nodiscard]] std::optional<ros2::Mount> mount() const;
  [[nodiscard]] bool has_mount() const { return mount().has_value(); }

  [[nodiscard]] const ros2::FrameNames& frames() const { return frames_; }
  [[nodiscard]] bool is_in_tree() const { return in_tree_; }
  void set_in_tree(bool in_tree) { in_tree_ = in_tree; }
  /// True in mode map_odom if there was no odometry at the time of the latest pose.
  [[nodiscard]] bool lacks_odometry() const { return lacks_odometry_; }

private:
  void publish_raw(const ImuSample& sample);
  void publish_odometry(const FusedPose& pose);
  void publish_imu(const ImuSample& sample, const FusedPose& pose);
  void publish(const ros2::relay::FixQueue::Ready& fixes);
  void publish_transform(const ros2::Odometry& odometry, TimeNs stamp_ns);
  void add_to_path(const ros2::Odometry& odometry, TimeNs stamp_ns);

  const Output& output_;
  std::string prefix_;  ///< prefix of the topic names
  ros2::FrameNames frames_;
  dds::pub::DataWriter<ros2::TFMessage>& tf_;
  std::atomic<bool> in_tree_;
  process::Wakeup& wakeup_;
  bool publishes_mag_;
  ros2::RateThinner pose_rate_;  ///< used on the thread of the poses only
  dds::pub::DataWriter<ros2::Imu> raw_imu_ = dds::core::null;
  dds::pub::DataWriter<ros2::Imu> imu_ = dds::core::null;
  dds::pub::DataWriter<ros2::MagneticField> magnetic_ = dds::core::null;
  dds::pub::DataWriter<ros2::Odometry> odometry_ = dds::core::null;
  dds::pub::DataWriter<ros2::PoseWithCovarianceStamped> pose_ = dds::core::null;
  dds::pub::DataWriter<ros2::PoseWithCovarianceStamped> fix_as_pose_ = dds::core::null;
  dds::pub::DataWriter<ros2::PointStamped> fix_as_point_ = dds::core::null;
  dds::pub::DataWriter<ros2::Path> path_ = dds::core::null;

  [[nodiscard]] ros2::Covariance3 covariance_of(const ReadyFix& fix) const;

  std::atomic<double> fix_std_m_;                    ///< setting of the fusion
  std::atomic<double> learned_fix_std_m_{};          ///< learned by the engine; 0: not learned
  std::atomic<SteadyTime> fused_at_ = SteadyTime{};  ///< reception time of the latest pose
  std::atomic<bool> lacks_odometry_ = false;
  std::atomic<bool> has_magnetic_ = false;         ///< a sample had a magnetic field
  std::atomic<bool> has_magnetic_writer_ = false;  ///< the writer exists

  threads::Guarded<ros2::RisingStamp> raw_stamp_;
  threads::Guarded<ros2::RisingStamp> imu_stamp_;
  /// No slack: a pose older than a published one is useless.
  threads::Guarded<ros2::RisingStamp> pose_stamp_{0};
  threads::Guarded<ros2::RisingStamp> fix_stamp_;

  threads::Mutex transitions_mutex_;
  observation::FirstReports reports_ SONOPOSE_GUARDED_BY(transitions_mutex_);
  transitions::TransitionDetector detector_ SONOPOSE_GUARDED_BY(transitions_mutex_);
  transitions::TransitionQueue transitions_ SONOPOSE_GUARDED_BY(transitions_mutex_);

  mutable threads::Mutex mutex_;
  std::optional<ros2::Mount> mount_ SONOPOSE_GUARDED_BY(mutex_);
  ros2::relay::ImuPairing pairing_ SONOPOSE_GUARDED_BY(mutex_);
  ros2::relay::FixQueue fixes_ SONOPOSE_GUARDED_BY(mutex_);
  ros2::relay::OdometryBuffer other_odometry_ SONOPOSE_GUARDED_BY(mutex_);
  struct PathPoint {
    TimeNs time_ns;
    ros2::Pose pose;
  };
  std::deque<PathPoint> path_points_ SONOPOSE_GUARDED_BY(mutex_);
};

}  // namespace sonopose::ros2::relay
