#pragma once
// The topics of one beacon in ROS 2, and what is written to them.

#include "ros2/relay/relay.hpp"
#include <sonopose/ros2/messages/beacon_topics.hpp>
#include <sonopose/ros2/messages/fix_queue.hpp>
#include <sonopose/ros2/messages/messages.hpp>
#include <sonopose/ros2/messages/odom_track.hpp>
#include <sonopose/ros2/messages/time.hpp>
#include <sonopose/samples/live_settings.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <array>
#include <atomic>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::ros2 {

/// Samples come on the receive thread, or, where this process brings them itself, on the thread that does:
/// what they share has a lock, which is held for computing alone.
class Ros2Beacon {
public:
  /// Makes the topics. `tf`: where transforms go, nil for mode off; it must outlive this. `in_tree`: whether
  /// the frames are this beacon's.
  Ros2Beacon(ros2::Node& node, const Ros2Output& output, BeaconAddress address,
             dds::DataWriter<ros2::TFMessage>& tf, bool in_tree);

  void on(const ImuSample& sample);
  void on(const FusedPose& pose);
  void on(const UltrasonicFix& fix);
  void on(const FixReport& report);
  void on(const EffectiveSettings& settings);
  /// Another source says where the base is in its own odometry.
  void on_odometry(TimeNs time_ns, const ros2::Transform& base_in_odom);

  /// On the main thread: makes the topic of the magnetic field once there is one.
  void make_magnetic(ros2::Node& node);
  /// On the main thread, often: fixes that nobody reports on.
  void publish_overdue_fixes();
  /// On the main thread, once a second.
  void publish_path();

  [[nodiscard]] const ros2::FrameNames& frames() const { return frames_; }
  [[nodiscard]] bool is_in_tree() const { return in_tree_; }
  /// In mode map_odom: whether the latest pose found no odometry to stand on.
  [[nodiscard]] bool lacks_odometry() const { return lacks_odometry_; }

private:
  void publish_odometry(const FusedPose& pose);
  void publish_imu(const FusedPose& pose);
  void publish(const ros2::FixQueue::Ready& fixes);
  std::optional<TimeNs> next(ros2::RisingStamp& stamp, TimeNs time_ns);
  void publish_transform(const ros2::Odometry& odometry, TimeNs stamp_ns);
  void remember(const ros2::Odometry& odometry, TimeNs stamp_ns);
  [[nodiscard]] std::optional<ImuSample> sample_of(std::uint64_t sequence) const;

  const Ros2Output& output_;
  std::string prefix_;  ///< of the topics' names
  ros2::FrameNames frames_;
  dds::DataWriter<ros2::TFMessage>& tf_;
  bool in_tree_;
  dds::DataWriter<ros2::Imu> raw_imu_;
  dds::DataWriter<ros2::Imu> imu_;
  dds::DataWriter<ros2::MagneticField> magnetic_;
  dds::DataWriter<ros2::Odometry> odometry_;
  dds::DataWriter<ros2::PoseWithCovarianceStamped> pose_;
  dds::DataWriter<ros2::PoseWithCovarianceStamped> fix_as_pose_;
  dds::DataWriter<ros2::PointStamped> fix_as_point_;
  dds::DataWriter<ros2::Path> path_;

  std::atomic<double> fix_std_m_;
  std::atomic<SteadyTime> fused_at_ = SteadyTime{};  ///< when the latest pose came
  std::atomic<bool> lacks_odometry_ = false;
  std::atomic<bool> has_magnetic_ = false;   ///< a sample had a magnetic field
  std::atomic<bool> magnetic_made_ = false;  ///< and its topic is there

  mutable std::mutex mutex_;  ///< of what follows
  std::array<ImuSample, 64> samples_{};
  std::size_t next_sample_ = 0;
  ros2::RisingStamp raw_stamp_;
  ros2::RisingStamp imu_stamp_;
  ros2::RisingStamp pose_stamp_{0};  ///< a measured pose that is older than a predicted one is of no use
  ros2::RisingStamp fix_stamp_;
  ros2::FixQueue fixes_;
  ros2::OdomTrack odom_track_;
  struct WayPoint {
    TimeNs time_ns;
    ros2::Pose pose;
  };
  std::deque<WayPoint> way_;
};

}  // namespace sonopose::ros2
