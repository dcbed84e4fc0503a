#include <sonopose/math/rotation.hpp>
#include <sonopose/ros2/frames.hpp>

#include <cmath>
#include <stdexcept>
#include <utility>

namespace sonopose::ros2 {
namespace {

const std::string placeholder = "{address}";

}  // namespace

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

void check(const FrameNames& patterns) {
  const std::array<std::pair<const char*, const std::string*>, 4> all{
      {{"map", &patterns.map}, {"odom", &patterns.odom}, {"base", &patterns.base}, {"imu", &patterns.imu}}};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& [frame, name] = all[i];
    const auto fail = [&, frame = frame, name = name](const std::string& why) {
      throw std::invalid_argument(std::string("the ") + frame + " frame '" + *name + "' " + why);
    };
    if (name->empty()) fail("needs a name");
    if (name->front() == '/') fail("must not begin with a slash");
    for (std::size_t before = 0; before < i; ++before) {
      if (*all[before].second == *name)
        fail(std::string("is called as the ") + all[before].first + " frame is");
    }
  }
}

bool tell_beacons_apart(const FrameNames& patterns, bool moves_odom) {
  const auto differs = [](const std::string& pattern) {
    return pattern.find(placeholder) != std::string::npos;
  };
  return differs(patterns.base) && differs(patterns.imu) && (differs(patterns.odom) || !moves_odom);
}

Mount mount_at(const std::array<double, 6>& place) {
  for (const double number : place) {
    if (!std::isfinite(number)) throw std::invalid_argument("the mount's numbers must be finite");
  }
  const auto radians = [](double degrees) { return degrees * math::radians_per_degree; };
  const math::EulerAngles<double> angles{radians(place[3]), radians(place[4]), radians(place[5])};
  return {{place[0], place[1], place[2]}, math::rotation_of(angles)};
}

Transform operator*(const Transform& outer, const Transform& inner) {
  return {outer.translation_m + outer.rotation * inner.translation_m, outer.rotation * inner.rotation};
}

Transform inverse_of(const Transform& transform) {
  const Quaterniond back = transform.rotation.conjugate();
  return {-(back * transform.translation_m), back};
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
