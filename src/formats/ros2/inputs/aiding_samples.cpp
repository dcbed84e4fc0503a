#include "ros2/inputs/aiding_samples.hpp"

#include <sonopose/geometry/rotation.hpp>
#include <sonopose/ros2/messages/input.hpp>
#include <sonopose/ros2/messages/pose_input.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::ros2 {
namespace {

using Kind = AidingInput::Kind;

/// Reason why the speeds of the wheels cannot be used, though the mount is known.
std::string fault_of(const JointState& state, const Wheels& wheels) {
  constexpr std::size_t max_listed = 8;
  std::vector<std::string_view> names;
  for (std::uint32_t i = 0; i < state.name._length; ++i) names.emplace_back(state.name._buffer[i]);
  for (const auto* const joints : {&wheels.left_joints, &wheels.right_joints}) {
    for (const std::string& joint : *joints) {
      const auto found = std::ranges::find(names, joint);
      if (found == names.end()) {
        names.resize(std::min(names.size(), max_listed));
        return fmt::format("they have no joint '{}' of --wheels; they have: {}", joint,
                           text::escaped(fmt::format("{}", fmt::join(names, ", "))));
      }
      if (static_cast<std::uint32_t>(found - names.begin()) >= state.velocity._length)
        return fmt::format("they have no velocity of the joint '{}'", joint);
    }
  }
  return "a velocity or stamp is invalid, or the mount is oblique";
}

std::string not_in_base(const std::string& frame) {
  return fmt::format(
      "/tf_static does not connect their frame '{}' with the base; --base-frame names another base", frame);
}

/// Samples of a velocity that `twist_of` finds for the mount of the IMU in the frame of the velocity.
AidingSamples of_twist(const std::string& frame, const AidingInput& input, const InputFrames& frames,
                       const auto& twist_of) {
  AidingSamples samples;
  const auto mount = frames.mount(input.address);
  const auto in_base = frames.in_base(input.address, frame);
  if (mount && in_base) {
    const auto& [imu_m, q_imu] = inverse_of(*in_base) * Transform{mount->imu_in_base_m, mount->q_imu_to_base};
    samples.twist = twist_of(Mount{.imu_in_base_m = imu_m, .q_imu_to_base = q_imu});
  }
  if (!mount) {
    samples.unused = mount_unknown;
  } else if (!in_base) {
    samples.unused = not_in_base(frame);
  } else if (!samples.twist) {
    samples.unused =
        "a value or stamp is invalid, no axis is measured, or not all three are and the mount is oblique";
  }
  return samples;
}

/// Says that an axis is left out because its variance is no number.
AidingSamples with_variances(AidingSamples samples, const double* covariance) {
  constexpr std::size_t next_diagonal = 7;
  bool are_numbers = true;
  for (std::size_t axis = 0; axis < 3; ++axis)
    are_numbers = are_numbers && !std::isnan(covariance[axis * next_diagonal]);
  if (!are_numbers && samples.twist) samples.unused = "a variance is no number: its axis is not measured";
  return samples;
}

/// Frames of a pose; empty with the reason if tf does not connect them.
std::optional<PoseFrames> frames_of(const InputFrames& frames, BeaconAddress address,
                                    const std::string& stated, const std::string& measured,
                                    std::string& unused) {
  const auto stated_in_map = frames.in_map(address, stated);
  if (!stated_in_map) {
    unused = fmt::format("/tf_static does not connect their frame '{}' with the map", stated);
    return std::nullopt;
  }
  const auto measured_in_base = frames.in_base(address, measured);
  if (!measured_in_base) {
    unused = not_in_base(measured);
    return std::nullopt;
  }
  const auto mount = frames.mount(address);
  if (!mount) {
    unused = mount_unknown;
    return std::nullopt;
  }
  return PoseFrames{.stated_in_map = *stated_in_map, .measured_in_base = *measured_in_base, .mount = *mount};
}

/// Marks a pose as the user's word, from now on. The heading comes first, so that the estimate starts with
/// it.
void set_pose(AidingSamples& samples, const PoseWithCovarianceStamped& message, TimeNs received_ns) {
  constexpr TimeNs earlier_ns = 1'000'000;
  constexpr Eigen::Index at_z = 2;
  if (!samples.fix) {
    samples = {.unused = samples.unused.empty() ? "a value or stamp is invalid" : samples.unused};
    return;
  }
  if (const auto fault = covariance_fault(message)) {
    samples = {.unused = fmt::format("its covariance has {:g} m² in row {}, column {}: {}", fault->value_m2,
                                     fault->row + 1, fault->column + 1, fault->reason)};
    return;
  }
  if (!samples.heading) {
    samples = {.unused = samples.unused};
    return;
  }
  UltrasonicFix& fix = *samples.fix;
  fix.flags |= ultrasonic_flag_set_pose;
  if (fix.covariance_world_m2 &&
      message.pose.covariance[at_z * 7] == 0) {  // as a map on a screen has no height
    Eigen::Matrix3d covariance_m2 = fix.covariance_world_m2->matrix();
    covariance_m2.row(at_z).setZero();
    covariance_m2.col(at_z).setZero();
    covariance_m2(at_z, at_z) = max_fix_std_m * max_fix_std_m;
    fix.covariance_world_m2 = Covariance<3>::from_matrix(covariance_m2);
  }
  samples.heading->flags |= heading_flag_set_pose;
  fix.emission_time_ns = fix.received_time_ns = received_ns;
  fix.measured_delay_s = 0;
  samples.heading->emission_time_ns = samples.heading->received_time_ns = received_ns - earlier_ns;
}

AidingSamples of_pose(const PoseWithCovarianceStamped& message, const std::string& stated,
                      const std::string& measured, const AidingInput& input, const InputFrames& frames,
                      TimeNs received_ns) {
  AidingSamples samples;
  const auto placed = frames_of(frames, input.address, stated, measured, samples.unused);
  if (!placed) return samples;
  const auto received = heading(message, *placed, input.address, received_ns);
  samples.heading = received.heading;
  if (received.fault != nullptr) {
    samples.unused = received.heading ? fmt::format("their covariance counts as unknown: {}", received.fault)
                                      : fmt::format("headings: {}", received.fault);
  }
  if (input.kind == Kind::heading) return samples;
  samples.fix = fix(message, *placed, input.address, received_ns);
  if (!samples.fix) samples.heading.reset();
  if (!samples.fix && samples.unused.empty()) samples.unused = "a position or stamp is invalid";
  if (input.kind == Kind::set_pose) set_pose(samples, message, received_ns);
  return samples;
}

}  // namespace

AidingSamples samples_of(const Odometry& message, const AidingInput& input, const InputFrames& frames,
                         TimeNs received_ns) {
  if (!is_velocity(input.kind)) {
    return of_pose(as_pose(message), message.header.frame_id, message.child_frame_id, input, frames,
                   received_ns);
  }
  auto samples = of_twist(message.child_frame_id, input, frames, [&](const Mount& mount) {
    return twist_sample(message, input.address, mount, received_ns);
  });
  return with_variances(std::move(samples), &message.twist.covariance[0]);
}

AidingSamples samples_of(const TwistWithCovarianceStamped& message, const AidingInput& input,
                         const InputFrames& frames, TimeNs received_ns) {
  auto samples = of_twist(message.header.frame_id, input, frames, [&](const Mount& mount) {
    return twist_sample(message, input.address, mount, received_ns);
  });
  return with_variances(std::move(samples), &message.twist.covariance[0]);
}

AidingSamples samples_of(const TwistStamped& message, const AidingInput& input, const InputFrames& frames,
                         TimeNs received_ns) {
  return of_twist(message.header.frame_id, input, frames, [&](const Mount& mount) {
    return twist_sample(message, input.address, mount, received_ns);
  });
}

AidingSamples samples_of(const JointState& message, const AidingInput& input, const InputFrames& frames,
                         TimeNs received_ns) {
  auto samples = of_twist({}, input, frames, [&](const Mount& mount) {
    return twist_sample(message, input.wheels, input.address, mount, received_ns);
  });
  if (frames.mount(input.address) && !samples.twist) {
    samples.unused = fault_of(message, input.wheels);
  }
  return samples;
}

AidingSamples samples_of(const Imu& message, const AidingInput& input, const InputFrames& frames,
                         TimeNs received_ns) {
  const auto pose = as_pose(message);
  if (!pose) return {.unused = "they have no orientation: orientation_covariance[0] is -1"};
  return of_pose(*pose, {}, message.header.frame_id, input, frames, received_ns);
}

AidingSamples samples_of(const PoseWithCovarianceStamped& message, const AidingInput& input,
                         const InputFrames& frames, TimeNs received_ns) {
  return of_pose(message, message.header.frame_id, {}, input, frames, received_ns);
}

AidingSamples samples_of(const PoseStamped& message, const AidingInput& input, const InputFrames& frames,
                         TimeNs received_ns) {
  return of_pose(as_pose(message), message.header.frame_id, {}, input, frames, received_ns);
}

AidingSamples samples_of(const Float64& message, const AidingInput& input, const InputFrames& frames,
                         TimeNs received_ns) {
  return of_pose(as_pose(message), {}, {}, input, frames, received_ns);
}

InputMonitor::Line set_pose_line(const AidingInput& input, const AidingSamples& samples) {
  if (!samples.fix) {
    return {[address = input.address, topic = input.topic, why = samples.unused] {
      return fmt::format("beacon {}: the pose of {} is refused: {}", address, topic, why);
    }};
  }
  return {[address = input.address, topic = input.topic, at = samples.fix->position_world_m,
           yaw_rad = samples.heading->heading_world_rad] {
            return fmt::format(
                "beacon {}: {} sets the pose to ({:.3f}, {:.3f}) m, with the IMU's x axis towards {:.1f}°",
                address, topic, at.x(), at.y(), yaw_rad / geometry::radians_per_degree);
          },
          logging::Level::info};
}

}  // namespace sonopose::ros2
