#include "ros2/bag/truth_input.hpp"

#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/messages/time.hpp>
#include <sonopose/text/count_text.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace sonopose::ros2::bag {
namespace {

/// Pose of a frame as that of the IMU on it; NaN where the orientation is unknown.
TruthSample truth_of(const Pose& pose, const Mount& mount) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const auto& [x, y, z, w] = pose.orientation;
  Quaterniond q_base_to_world(w, x, y, z);
  const bool is_rotation = std::abs(q_base_to_world.squaredNorm() - 1) < 0.02;  // false for NaN
  if (is_rotation) q_base_to_world.normalize();
  const bool needs_rotation = !mount.imu_in_base_m.isZero(0);
  TruthSample truth;
  truth.position_world_m = {pose.position.x, pose.position.y, pose.position.z};
  if (needs_rotation) truth.position_world_m += q_base_to_world * mount.imu_in_base_m;
  truth.q_body_to_world = q_base_to_world * mount.q_imu_to_base;
  if (!is_rotation) truth.q_body_to_world = {unknown, unknown, unknown, unknown};
  if (!is_rotation && needs_rotation) truth.position_world_m.setConstant(unknown);
  truth.velocity_world_mps.setConstant(unknown);
  return truth;
}

std::optional<TruthSample> at(TruthSample truth, BeaconAddress address, std::optional<TimeNs> time_ns) {
  if (!time_ns) return std::nullopt;
  truth.address = address;
  truth.time_ns = *time_ns;
  return truth;
}

}  // namespace

std::optional<TruthSample> TruthInput::on(const PoseStamped& message, BeaconAddress address,
                                          TimeNs received_ns) {
  return at(truth_of(message.pose, imu_in({}, address)), address, time_of(message.header, received_ns));
}

std::optional<TruthSample> TruthInput::on(const PoseWithCovarianceStamped& message, BeaconAddress address,
                                          TimeNs received_ns) {
  return at(truth_of(message.pose.pose, imu_in({}, address)), address, time_of(message.header, received_ns));
}

std::optional<TruthSample> TruthInput::on(const Odometry& message, BeaconAddress address,
                                          TimeNs received_ns) {
  const Mount mount = imu_in(message.child_frame_id, address);
  const auto& [linear, angular] = message.twist.twist;
  TruthSample truth = truth_of(message.pose.pose, mount);
  const Vector3d velocity_base_mps = Vector3d(linear.x, linear.y, linear.z) +
                                     Vector3d(angular.x, angular.y, angular.z).cross(mount.imu_in_base_m);
  truth.velocity_world_mps = truth.q_body_to_world * (mount.q_imu_to_base.conjugate() * velocity_base_mps);
  return at(truth, address, time_of(message.header, received_ns));
}

Mount TruthInput::imu_in(const std::string& frame, BeaconAddress address) {
  const Mount mount = frames_.mount(address).value_or(Mount{});
  const auto in_base = frames_.in_base(address, frame);
  if (!in_base) {
    if (unconnected_.size() < max_frames) unconnected_.insert(frame);
    return mount;
  }
  const auto& [imu_m, q_imu] = inverse_of(*in_base) * Transform{mount.imu_in_base_m, mount.q_imu_to_base};
  return {.imu_in_base_m = imu_m, .q_imu_to_base = q_imu};
}

std::optional<TimeNs> TruthInput::time_of(const Header& header, TimeNs received_ns) {
  if (stated_.size() < max_frames) stated_.emplace(without_slash(header.frame_id));
  if (header.stamp.sec != 0 || header.stamp.nanosec != 0) return from_ros(header.stamp);
  ++unstamped_;
  return received_ns;
}

std::vector<std::string> TruthInput::assumptions(const std::string& fix_frame) const {
  std::vector<std::string> texts;
  if (unstamped_ > 0) {
    texts.push_back(fmt::format("has {} without a stamp: they count as measured when they were received",
                                text::count_text(unstamped_, "message")));
  }
  for (const std::string& frame : stated_) {
    if (frame.empty() || fix_frame.empty() || frame == fix_frame) continue;  // empty: the map
    texts.push_back(fmt::format("is in frame '{}', the fixes in '{}': they count as one frame",
                                text::escaped(frame), text::escaped(fix_frame)));
  }
  for (const std::string& frame : unconnected_) {
    texts.push_back(
        fmt::format("is of '{}', which /tf_static does not connect with the base: it counts as the base; "
                    "--base-frame names another base",
                    text::escaped(frame)));
  }
  return texts;
}

}  // namespace sonopose::ros2::bag
