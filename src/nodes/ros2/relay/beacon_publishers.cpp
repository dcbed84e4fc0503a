#include "ros2/relay/beacon_publishers.hpp"

#include "clocks/clocks.hpp"
#include <sonopose/ros2/messages/borrow.hpp>

#include <algorithm>
#include <charconv>
#include <utility>

namespace sonopose::ros2::relay {
namespace {

/// Interval between points of a path.
constexpr TimeNs path_step_ns = 100'000'000;
const char* const profile = "ros2::Default";

/// A message that borrows one transform.
ros2::TFMessage message_of(ros2::TransformStamped& transform) {
  return {{1, 1, &transform, false}};
}

std::optional<TimeNs> next_stamp(threads::Guarded<ros2::RisingStamp>& stamp, TimeNs time_ns) {
  return stamp.with([time_ns](ros2::RisingStamp& rising) { return rising.next(time_ns); });
}

}  // namespace

double fix_std_of(const EffectiveSettings& settings) {
  bool is_documented = false;
  double std_m = 0;
  for (const auto& [key, value] : settings.values) {
    if (key == "fusion.engine") is_documented = value == "documented";
    if (key == "documented.uncertainty.fix_std_m") {
      std::from_chars(value.data(), value.data() + value.size(), std_m);
    }
  }
  return is_documented && std_m > 0 ? std_m : unknown_fix_std_m;
}

BeaconPublishers::BeaconPublishers(ros2::Node& node, const Output& output, BeaconAddress address,
                                   dds::pub::DataWriter<ros2::TFMessage>& tf, bool in_tree,
                                   process::Wakeup& wakeup)
    : output_(output),
      prefix_(ros2::topic_prefix(output.beacon_namespace, address)),
      frames_(ros2::for_beacon(output.frames, address)),
      tf_(tf),
      in_tree_(in_tree),
      wakeup_(wakeup),
      publishes_mag_(output.topics.contains("imu/mag")),
      pose_rate_(output.rate_hz),
      fix_std_m_(unknown_fix_std_m),
      detector_(address) {
  if (!output.mount_from_tf) mount_ = output.mount;
  const auto publish = [&]<class T>(dds::pub::DataWriter<T>& writer, const char* topic) {
    if (output.topics.contains(topic)) writer = node.make_writer<T>(prefix_ + topic, profile);
  };
  publish(raw_imu_, "imu/data_raw");
  publish(imu_, "imu/data");
  publish(odometry_, "odom");
  publish(pose_, "pose");
  if (output.fix == FixMessage::pose) {
    publish(fix_as_pose_, "fix");
  } else {
    publish(fix_as_point_, "fix");
  }
  if (output.path_s > 0) path_ = node.make_writer<ros2::Path>(prefix_ + "path", profile);
}

void BeaconPublishers::create_magnetic_writer(ros2::Node& node) {
  if (!has_magnetic_ || has_magnetic_writer_) return;
  magnetic_ = node.make_writer<ros2::MagneticField>(prefix_ + "imu/mag", profile);
  has_magnetic_writer_ = true;
}

void BeaconPublishers::leave(ros2::Node& node) const {
  const auto remove = [&node](const auto&... writers) {
    ((writers.is_nil() ? void() : node.remove(writers)), ...);
  };
  remove(raw_imu_, imu_, magnetic_, odometry_, pose_, fix_as_pose_, fix_as_point_, path_);
}

void BeaconPublishers::on(const ImuSample& sample) {
  std::optional<FusedPose> early_pose;
  bool has_overdue_fix = false;
  {
    const threads::Lock lock(mutex_);
    early_pose = pairing_.on(sample);
    has_overdue_fix = fixes_.has_overdue(clocks::steady_now());
  }
  if (has_overdue_fix) handle_overdue();
  publish_raw(sample);
  if (early_pose) publish_imu(sample, *early_pose);
}

void BeaconPublishers::publish_raw(const ImuSample& sample) {
  const auto stamp_ns = next_stamp(raw_stamp_, sample.sensor_time_ns);
  if (!stamp_ns) return;
  if (!raw_imu_.is_nil())
    dds::ext::try_write(raw_imu_, ros2::raw_imu(sample, *stamp_ns, frames_, output_.noise));
  if (!publishes_mag_) return;
  const auto field = ros2::magnetic_field(sample, *stamp_ns, frames_, output_.noise);
  if (!field) return;
  if (!has_magnetic_.exchange(true)) wakeup_.wake();
  if (has_magnetic_writer_) dds::ext::try_write(magnetic_, *field);
}

void BeaconPublishers::on(const FusedPose& pose) {
  fused_at_ = clocks::steady_now();
  publish_odometry(pose);  // first, because vehicle control may depend on it
  {
    const threads::Lock lock(transitions_mutex_);
    detector_.on(pose, transitions_);
  }
  if ((pose.status & status_predicted) != 0) return;  // a predicted pose has no IMU sample
  std::optional<ImuSample> sample;
  {
    const threads::Lock lock(mutex_);
    sample = pairing_.on(pose, clocks::steady_now());
  }
  if (sample) publish_imu(*sample, pose);
}

transitions::TransitionQueue BeaconPublishers::take_transitions() {
  const threads::Lock lock(transitions_mutex_);
  return std::exchange(transitions_, {});
}

void BeaconPublishers::publish_odometry(const FusedPose& pose) {
  if ((pose.status & status_initialising) != 0) return;  // no position yet
  const auto stamp_ns = next_stamp(pose_stamp_, pose.time_ns);
  if (!stamp_ns || !pose_rate_.admits(*stamp_ns)) return;
  const auto known_mount = mount();
  if (!known_mount) return;
  const ros2::Odometry odometry = ros2::odometry(pose, *stamp_ns, frames_, *known_mount, output_.noise);
  publish_transform(odometry, *stamp_ns);
  if (!odometry_.is_nil()) dds::ext::try_write(odometry_, odometry);
  if (!pose_.is_nil()) dds::ext::try_write(pose_, ros2::pose_of(odometry));
  if (!path_.is_nil()) add_to_path(odometry, *stamp_ns);
}

std::optional<ros2::Mount> BeaconPublishers::mount() const {
  const threads::Lock lock(mutex_);
  return mount_;
}

bool BeaconPublishers::set_mount(const ros2::Mount& mount) {
  const threads::Lock lock(mutex_);
  const bool is_same = mount_ && mount_->imu_in_base_m == mount.imu_in_base_m &&
                       mount_->q_imu_to_base.coeffs() == mount.q_imu_to_base.coeffs();
  mount_ = mount;
  return !is_same;
}

void BeaconPublishers::publish_imu(const ImuSample& sample, const FusedPose& pose) {
  if (imu_.is_nil()) return;
  const auto stamp_ns = next_stamp(imu_stamp_, sample.sensor_time_ns);
  if (stamp_ns) dds::ext::try_write(imu_, ros2::fused_imu(sample, pose, *stamp_ns, frames_, output_.noise));
}

std::uint64_t BeaconPublishers::imu_data_lost() const {
  const threads::Lock lock(mutex_);
  return pairing_.given_up();
}

void BeaconPublishers::publish_transform(const ros2::Odometry& odometry, TimeNs stamp_ns) {
  if (!in_tree_ || output_.tf == TfMode::off) return;
  const ros2::Transform base_in_map = ros2::base_in_map(odometry);
  if (output_.tf == TfMode::map_base) {
    auto transform = ros2::transform(base_in_map, stamp_ns, frames_.map, frames_.base);
    dds::ext::try_write(tf_, message_of(transform));
    return;
  }
  std::optional<ros2::Transform> base_in_odom;
  {
    const threads::Lock lock(mutex_);
    base_in_odom = other_odometry_.at(stamp_ns);
  }
  lacks_odometry_ = !base_in_odom;
  if (!base_in_odom) return;
  auto transform =
      ros2::transform(odom_in_map(base_in_map, *base_in_odom), stamp_ns, frames_.map, frames_.odom);
  dds::ext::try_write(tf_, message_of(transform));
}

void BeaconPublishers::on_odometry(TimeNs time_ns, const ros2::Transform& base_in_odom) {
  const threads::Lock lock(mutex_);
  other_odometry_.add(time_ns, base_in_odom);
}

void BeaconPublishers::on(const UltrasonicFix& fix) {
  constexpr TimeNs fusion_gone_ns = 1'000'000'000;
  if (!fix.position_world_m.allFinite()) return;
  const SteadyTime now = clocks::steady_now();
  const SteadyTime fused_at = fused_at_;
  const bool fusion_runs = fused_at != SteadyTime{} && now - fused_at < fusion_gone_ns;
  ros2::relay::FixQueue::Ready ready;
  {
    const threads::Lock lock(mutex_);
    ready = fixes_.on(fix, now, fusion_runs);
  }
  publish(ready);
}

void BeaconPublishers::on(const FixReport& report) {
  {
    const threads::Lock lock(transitions_mutex_);
    if (reports_.accepts(report)) detector_.on(report, transitions_);
  }
  if (!report.position_world_m.allFinite()) return;
  ros2::relay::FixQueue::Ready ready;
  {
    const threads::Lock lock(mutex_);
    ready = fixes_.on(report);
  }
  publish(ready);
}

void BeaconPublishers::handle_overdue() {
  ros2::relay::FixQueue::Ready ready;
  {
    const threads::Lock lock(mutex_);
    ready = fixes_.overdue(clocks::steady_now());
    pairing_.drop_overdue(clocks::steady_now());
  }
  publish(ready);
}

void BeaconPublishers::publish(const ros2::relay::FixQueue::Ready& fixes) {
  if (fix_as_pose_.is_nil() && fix_as_point_.is_nil()) return;
  for (const ReadyFix& fix : fixes) {
    const auto stamp_ns = next_stamp(fix_stamp_, fix.emission_time_ns);
    if (!stamp_ns) continue;
    if (output_.fix == FixMessage::point) {
      dds::ext::try_write(fix_as_point_, ros2::position_as_point(fix.position_world_m, *stamp_ns, frames_));
    } else {
      dds::ext::try_write(
          fix_as_pose_, ros2::position_as_pose(fix.position_world_m, covariance_of(fix), *stamp_ns, frames_));
    }
  }
}

ros2::Covariance3 BeaconPublishers::covariance_of(const ReadyFix& fix) const {
  if (fix.covariance_world_m2) return ros2::fix_covariance(fix.covariance_world_m2->matrix(), fix.weight);
  const double learned_m = learned_fix_std_m_;
  return ros2::fix_covariance(learned_m > 0 ? learned_m : fix_std_m_.load(), fix.weight);
}

void BeaconPublishers::on(const Estimate& estimate) {
  learned_fix_std_m_ = estimate.fix_noise_m ? estimate.fix_noise_m->value : 0.0;
}

void BeaconPublishers::add_to_path(const ros2::Odometry& odometry, TimeNs stamp_ns) {
  const threads::Lock lock(mutex_);
  if (!path_points_.empty() && saturated_difference(stamp_ns, path_points_.back().time_ns) < path_step_ns) {
    if (stamp_ns > path_points_.back().time_ns) return;
    path_points_.clear();  // the clock was stepped back
  }
  path_points_.push_back({stamp_ns, odometry.pose.pose});
  const auto age_ns = [&](const PathPoint& point) { return saturated_difference(stamp_ns, point.time_ns); };
  while (age_ns(path_points_.front()) > to_ns(output_.path_s)) path_points_.pop_front();
}

void BeaconPublishers::publish_path() {
  if (path_.is_nil()) return;
  std::vector<ros2::PoseStamped> poses;
  {
    const threads::Lock lock(mutex_);
    poses.reserve(path_points_.size());
    for (const PathPoint& point : path_points_) {
      poses.push_back({ros2::header_of(point.time_ns, frames_.map), point.pose});
    }
  }
  if (poses.empty()) return;
  ros2::Path path{};
  path.header = poses.back().header;
  ros2::borrow_sequence(path.poses, poses);
  dds::ext::try_write(path_, path);
}

}  // namespace sonopose::ros2::relay
