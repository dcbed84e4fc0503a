#include "ros2/inputs/wheels_file.hpp"

#include "files/error.hpp"
#include "toml/leaves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <variant>

namespace sonopose::ros2 {

Wheels read_wheels(const std::filesystem::path& file) {
  Wheels wheels;
  for (const toml::Leaf& leaf : toml::read_leaves(file)) {
    const auto fail = [&](const std::string& why) {
      throw files::IoError(fmt::format("{}:{}: {} {}", file.string(), leaf.line, leaf.key, why));
    };
    const bool is_joints = leaf.key == "left_joints" || leaf.key == "right_joints";
    if (is_joints) {
      const auto* words = std::get_if<toml::Words>(&leaf.value);
      if (words == nullptr || words->empty()) fail("must be a list of joints, as [\"left_wheel_joint\"]");
      (leaf.key == "left_joints" ? wheels.left_joints : wheels.right_joints) = *words;
    } else if (leaf.key == "radius_m" || leaf.key == "track_m") {
      const auto* whole = std::get_if<std::int64_t>(&leaf.value);
      const auto* real = std::get_if<double>(&leaf.value);
      const double value_m = real != nullptr ? *real : whole != nullptr ? static_cast<double>(*whole) : -1.0;
      if (!(value_m > 0.0 && value_m <= 100.0)) fail("must be a number above 0 and up to 100 m");
      (leaf.key == "radius_m" ? wheels.radius_m : wheels.track_m) = value_m;
    } else {
      fail("is unknown; keys are left_joints, right_joints, radius_m, track_m");
    }
  }
  const char* const missing = wheels.left_joints.empty()    ? "left_joints"
                              : wheels.right_joints.empty() ? "right_joints"
                              : wheels.radius_m == 0.0      ? "radius_m"
                              : wheels.track_m == 0.0       ? "track_m"
                                                            : nullptr;
  if (missing != nullptr) throw files::IoError(fmt::format("{}: {} is missing", file.string(), missing));
  for (const std::string& joint : wheels.left_joints) {
    if (std::ranges::find(wheels.right_joints, joint) == wheels.right_joints.end()) continue;
    throw files::IoError(fmt::format("{}: the joint \"{}\" is left and right", file.string(), joint));
  }
  return wheels;
}

}  // namespace sonopose::ros2
