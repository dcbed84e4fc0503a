#include <sonopose/geometry/rotation.hpp>
#include <sonopose/ros2/messages/frames.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <utility>

namespace sonopose::ros2 {
namespace {

const std::string placeholder = "{address}";

using FramesByName = std::array<std::pair<const char*, const std::string*>, 4>;

FramesByName by_frame(const FrameNames& names) {
  return {{{"map", &names.map}, {"odom", &names.odom}, {"base", &names.base}, {"imu", &names.imu}}};
}

/// Throws FrameError if two frames have the same name. `why` states the reason, given the other frame of that
/// name.
template <class Why>
void check_differ(const FrameNames& names, const Why& why) {
  const FramesByName all = by_frame(names);
  for (auto later = all.begin(); later != all.end(); ++later) {
    const auto taken =
        std::find_if(all.begin(), later, [&](const auto& each) { return *each.second == *later->second; });
    if (taken != later) throw FrameError(later->first, *later->second, why(taken->first));
  }
}

}  // namespace

std::string_view without_slash(std::string_view frame) {
  if (frame.starts_with('/')) frame.remove_prefix(1);
  return frame;
}

std::string for_beacon(const std::string& pattern, BeaconAddress address) {
  std::string name = pattern;
  const std::string number = std::to_string(address);
  for (std::size_t at = name.find(placeholder); at != std::string::npos; at = name.find(placeholder)) {
    name.replace(at, placeholder.size(), number);
  }
  return name;
}

FrameNames for_beacon(const FrameNames& patterns, BeaconAddress address) {
  return {for_beacon(patterns.map, address), for_beacon(patterns.odom, address),
          for_beacon(patterns.base, address), for_beacon(patterns.imu, address)};
}

FrameError::FrameError(std::string frame, const std::string& name, const std::string& why)
    : std::invalid_argument("the " + frame + " frame '" + name + "' " + why), frame_(std::move(frame)) {}

void check(const FrameNames& patterns) {
  for (const auto& [frame, name] : by_frame(patterns)) {
    if (name->empty()) throw FrameError(frame, *name, "needs a name");
    if (name->front() == '/') throw FrameError(frame, *name, "must not begin with a slash");
  }
  check_differ(patterns,
               [](const char* other) { return std::string("has the same name as the ") + other + " frame"; });
  const auto varies = [](const auto& each) { return each.second->find(placeholder) != std::string::npos; };
  const auto all = by_frame(patterns);
  if (std::none_of(all.begin(), all.end(), varies)) return;
  // Different templates can expand to the same name, such as b7 and b{address} for beacon 7.
  for (BeaconAddress address = 0; address < all_beacons; ++address) {
    check_differ(for_beacon(patterns, address), [address](const char* other) {
      return "of beacon " + std::to_string(address) + " has the same name as its " + other + " frame";
    });
  }
}

bool has_frames_per_beacon(const FrameNames& patterns, bool moves_odom) {
  const auto is_per_beacon = [](const std::string& pattern) {
    return pattern.find(placeholder) != std::string::npos;
  };
  return is_per_beacon(patterns.base) && is_per_beacon(patterns.imu) &&
         (is_per_beacon(patterns.odom) || !moves_odom);
}

Mount mount_at(const std::array<double, 6>& pose) {
  constexpr std::array<const char*, 6> names{"x", "y", "z", "roll", "pitch", "yaw"};
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const bool is_length = i < 3;
    const int limit = is_length ? 1000 : 360;
    if (std::abs(pose[i]) <= limit) continue;  // false for NaN
    std::ostringstream value;
    value << pose[i];
    throw std::invalid_argument(std::string(names[i]) + " is " + value.str() + ": it must be from -" +
                                std::to_string(limit) + " to " + std::to_string(limit) +
                                (is_length ? " m" : " deg"));
  }
  const auto radians = [](double degrees) { return degrees * geometry::radians_per_degree; };
  const geometry::EulerAngles<double> angles{radians(pose[3]), radians(pose[4]), radians(pose[5])};
  return {{pose[0], pose[1], pose[2]}, geometry::rotation_of(angles)};
}

Transform operator*(const Transform& outer, const Transform& inner) {
  return {outer.translation_m + outer.rotation * inner.translation_m, outer.rotation * inner.rotation};
}

Transform inverse_of(const Transform& transform) {
  const Quaterniond inverse = transform.rotation.conjugate();
  return {-(inverse * transform.translation_m), inverse};
}

BaseState base_state(const FusedPose& pose, const Mount& mount) {
  BaseState base;
  base.q_base_to_map = pose.q_body_to_world * mount.q_imu_to_base.conjugate();
  base.position_map_m = pose.position_world_m - base.q_base_to_map * mount.imu_in_base_m;
  base.angular_velocity_base_radps = mount.q_imu_to_base * pose.angular_velocity_body_radps;
  base.velocity_base_mps = base.q_base_to_map.conjugate() * pose.velocity_world_mps -
                           base.angular_velocity_base_radps.cross(mount.imu_in_base_m);
  return base;
}

}  // namespace sonopose::ros2
