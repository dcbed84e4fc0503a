#include "ros2/relay/beacon.hpp"

#include "process/clocks.hpp"
#include <sonopose/settings/settings.hpp>
#include <sonopose/ros2/messages/borrow.hpp>

#include <algorithm>
#include <charconv>

namespace sonopose::ros2 {
namespace {

/// Between two points of a path.
constexpr TimeNs way_step_ns = 100'000'000;
const char* const profile = "ros2::Default";

/// The transforms of one message, and nobody's memory.
ros2::TFMessage message_of(ros2::TransformStamped& transform) {
  return {{1, 1, &transform, false}};
}

}  // namespace

Ros2Beacon::Ros2Beacon(ros2::Node& node, const Ros2Output& output, BeaconAddress address,
                       dds::DataWriter<ros2::TFMessage>& tf, bool in_tree)
    : output_(output),
      prefix_(ros2::topic_prefix(output.beacon_namespace, address)),
      frames_(ros2::for_beacon(output.frames, address)),
      tf_(tf),
      in_tree_(in_tree),
      fix_std_m_(settings::UncertaintySettings{}.fix_std_m) {
  raw_imu_ = node.make_writer<ros2::Imu>(prefix_ + "imu/data_raw", profile);
  imu_ = node.make_writer<ros2::Imu>(prefix_ + "imu/data", profile);
  odometry_ = node.make_writer<ros2::Odometry>(prefix_ + "odom", profile);
  pose_ = node.make_writer<ros2::PoseWithCovarianceStamped>(prefix_ + "pose", profile);
  if (output.fix == FixMessage::pose) {
    fix_as_pose_ = node.make_writer<ros2::PoseWithCovarianceStamped>(prefix_ + "fix", profile);
  } else {
    fix_as_point_ = node.make_writer<ros2::PointStamped>(prefix_ + "fix", profile);
  }
  if (output.path_s > 0) path_ = node.make_writer<ros2::Path>(prefix_ + "path", profile);
}

void Ros2Beacon::make_magnetic(ros2::Node& node) {
  if (!has_magnetic_ || magnetic_made_) return;
  magnetic_ = node.make_writer<ros2::MagneticField>(prefix_ + "imu/mag", profile);
  magnetic_made_ = true;
}

void Ros2Beacon::on(const ImuSample& sample) {
  {
    const std::lock_guard lock(mutex_);
    samples_[next_sample_++ % samples_.size()] = sample;
  }
  const auto stamp_ns = next(raw_stamp_, sample.sensor_time_ns);
  if (!stamp_ns) return;
  raw_imu_.try_write(ros2::raw_imu(sample, *stamp_ns, frames_, output_.noise));
  const auto field = ros2::magnetic_field(sample, *stamp_ns, frames_, output_.noise);
  if (!field) return;
  has_magnetic_ = true;
  if (magnetic_made_) magnetic_.try_write(*field);
}

void Ros2Beacon::on(const FusedPose& pose) {
  fused_at_ = process::steady_now();
  publish_odometry(pose);  // first: somebody drives by it
  publish_imu(pose);
}

void Ros2Beacon::publish_odometry(const FusedPose& pose) {
  if ((pose.status & status_initialising) != 0) return;  // there is no position yet
  const auto stamp_ns = next(pose_stamp_, pose.time_ns);
  if (!stamp_ns) return;
  const ros2::Odometry odometry = ros2::odometry(pose, *stamp_ns, frames_, output_.mount, output_.noise);
  publish_transform(odometry, *stamp_ns);
  odometry_.try_write(odometry);
  pose_.try_write(ros2::pose_of(odometry));
  if (!path_.is_nil()) remember(odometry, *stamp_ns);
}

/// A pose between samples has none of its own.
void Ros2Beacon::publish_imu(const FusedPose& pose) {
  if ((pose.status & status_predicted) != 0) return;
  const auto sample = sample_of(pose.sequence);
  if (!sample) return;
  const auto stamp_ns = next(imu_stamp_, sample->sensor_time_ns);
  if (stamp_ns) imu_.try_write(ros2::fused_imu(*sample, pose, *stamp_ns, frames_, output_.noise));
}

std::optional<ImuSample> Ros2Beacon::sample_of(std::uint64_t sequence) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(samples_.begin(), samples_.end(), [sequence](const ImuSample& sample) {
    return sample.sequence == sequence;
  });
  if (found == samples_.end()) return std::nullopt;
  return *found;
}

void Ros2Beacon::publish_transform(const ros2::Odometry& odometry, TimeNs stamp_ns) {
  if (!in_tree_ || output_.tf == TfMode::off) return;
  const ros2::Transform base_in_map = ros2::base_in_map(odometry);
  if (output_.tf == TfMode::map_base) {
    auto transform = ros2::transform(base_in_map, stamp_ns, frames_.map, frames_.base);
    tf_.try_write(message_of(transform));
    return;
  }
  std::optional<ros2::Transform> base_in_odom;
  {
    const std::lock_guard lock(mutex_);
    base_in_odom = odom_track_.at(stamp_ns);
  }
  lacks_odometry_ = !base_in_odom;
  if (!base_in_odom) return;
  auto transform =
      ros2::transform(ros2::odom_in_map(base_in_map, *base_in_odom), stamp_ns, frames_.map, frames_.odom);
  tf_.try_write(message_of(transform));
}

void Ros2Beacon::on_odometry(TimeNs time_ns, const ros2::Transform& base_in_odom) {
  const std::lock_guard lock(mutex_);
  odom_track_.add(time_ns, base_in_odom);
}

void Ros2Beacon::on(const UltrasonicFix& fix) {
  constexpr TimeNs fusion_gone_ns = 1'000'000'000;
  if (!fix.position_world_m.allFinite()) return;
  const SteadyTime now = process::steady_now();
  const SteadyTime fused_at = fused_at_;
  const bool fusion_runs = fused_at != SteadyTime{} && now - fused_at < fusion_gone_ns;
  ros2::FixQueue::Ready ready;
  {
    const std::lock_guard lock(mutex_);
    ready = fixes_.on(fix, now, fusion_runs);
  }
  publish(ready);
}

void Ros2Beacon::on(const FixReport& report) {
  if (!report.position_world_m.allFinite()) return;
  ros2::FixQueue::Ready ready;
  {
    const std::lock_guard lock(mutex_);
    ready = fixes_.on(report);
  }
  publish(ready);
}

void Ros2Beacon::publish_overdue_fixes() {
  ros2::FixQueue::Ready ready;
  {
    const std::lock_guard lock(mutex_);
    ready = fixes_.overdue(process::steady_now());
  }
  publish(ready);
}

void Ros2Beacon::publish(const ros2::FixQueue::Ready& fixes) {
  for (const ros2::ReadyFix& fix : fixes) {
    const auto stamp_ns = next(fix_stamp_, fix.emission_time_ns);
    if (!stamp_ns) continue;
    if (output_.fix == FixMessage::point) {
      fix_as_point_.try_write(ros2::position_as_point(fix.position_world_m, *stamp_ns, frames_));
    } else {
      fix_as_pose_.try_write(ros2::position_as_pose(
          fix.position_world_m, ros2::fix_covariance(fix_std_m_, fix.weight), *stamp_ns, frames_));
    }
  }
}

std::optional<TimeNs> Ros2Beacon::next(ros2::RisingStamp& stamp, TimeNs time_ns) {
  const std::lock_guard lock(mutex_);
  return stamp.next(time_ns);
}

void Ros2Beacon::on(const EffectiveSettings& settings) {
  for (const auto& [key, value] : settings.values) {
    if (key != "uncertainty.fix_std_m") continue;
    double std_m = 0;
    std::from_chars(value.data(), value.data() + value.size(), std_m);
    if (std_m > 0) fix_std_m_ = std_m;
  }
}

void Ros2Beacon::remember(const ros2::Odometry& odometry, TimeNs stamp_ns) {
  const std::lock_guard lock(mutex_);
  if (!way_.empty() && stamp_ns - way_.back().time_ns < way_step_ns) {
    if (stamp_ns > way_.back().time_ns) return;
    way_.clear();  // the clock was set back
  }
  way_.push_back({stamp_ns, odometry.pose.pose});
  while (stamp_ns - way_.front().time_ns > to_ns(output_.path_s)) way_.pop_front();
}

void Ros2Beacon::publish_path() {
  if (path_.is_nil()) return;
  std::vector<ros2::PoseStamped> poses;
  {
    const std::lock_guard lock(mutex_);
    poses.reserve(way_.size());
    for (const WayPoint& point : way_) {
      poses.push_back({ros2::header_of(point.time_ns, frames_.map), point.pose});
    }
  }
  if (poses.empty()) return;
  ros2::Path path{};
  path.header = poses.back().header;
  ros2::lend(path.poses, poses);
  path_.try_write(path);
}

}  // namespace sonopose::ros2
