#include "ros2/inputs/aiding_input.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cstddef>
#include <stdexcept>
#include <utility>

namespace sonopose::ros2 {
namespace {

using Kind = AidingInput::Kind;
using Type = AidingInput::Type;

struct TypeName {
  Type type;
  std::string_view name;
};

struct Option {
  const char* name;
  const char* source;  ///< measurements that only one topic of a beacon may give
  const char* example;
  std::vector<TypeName> types;  ///< the default first
};

/// Options in the order of Kind.
const Option& option_of(Kind kind) {
  constexpr TypeName odometry{Type::odometry, "Odometry"};
  constexpr TypeName twist_with_covariance{Type::twist_with_covariance, "TwistWithCovarianceStamped"};
  constexpr TypeName pose_with_covariance{Type::pose_with_covariance, "PoseWithCovarianceStamped"};
  static const std::array options{
      Option{"--odom-in", "velocities", "/odom=7", {odometry}},
      Option{"--twist-in",
             "velocities",
             "/wheel/twist=7 or /wheel/twist:TwistStamped=7",
             {twist_with_covariance, {Type::twist, "TwistStamped"}}},
      Option{"--wheel-in", "velocities", "/joint_states=7", {{Type::joints, "JointState"}}},
      Option{"--heading-in",
             "headings",
             "/compass=7 or /yaw:Float64=7",
             {{Type::imu, "Imu"}, pose_with_covariance, {Type::degrees, "Float64"}}},
      Option{"--pose-in",
             "poses",
             "/vision/pose=7 or /vision/odom:Odometry=7",
             {pose_with_covariance, {Type::pose, "PoseStamped"}, odometry}},
      Option{"--set-pose-in",
             "",
             "/initialpose=7 or /set_pose:SetPose=7",
             {pose_with_covariance, {Type::set_pose_service, "SetPose"}}}};
  return options.at(static_cast<std::size_t>(kind));
}

}  // namespace

bool is_velocity(Kind kind) {
  return kind == Kind::odometry || kind == Kind::twist || kind == Kind::wheels;
}

const char* option_name(Kind kind) {
  return option_of(kind).name;
}

std::string text_of(const AidingInput& input) {
  return fmt::format("{} {}={}", option_name(input.kind), input.topic, input.address);
}

Input monitored_as(const AidingInput& input) {
  const auto kind = is_velocity(input.kind)       ? Input::Kind::twist
                    : input.kind == Kind::heading ? Input::Kind::heading
                                                  : Input::Kind::pose;
  return {.kind = kind, .topic = input.topic, .address = input.address};
}

AidingInput AidingInput::parse(Kind kind, std::string_view text) {
  const Option& option = option_of(kind);
  TopicOfBeacon of = parse_topic(option.name, text, option.example);
  AidingInput input{
      .kind = kind, .type = option.types.front().type, .topic = std::move(of.topic), .address = of.address};
  const std::size_t colon = input.topic.find(':');
  if (colon == std::string::npos) return input;
  const std::string type = input.topic.substr(colon + 1);
  input.topic.resize(colon);
  std::vector<std::string_view> names;
  for (const TypeName& known : option.types) {
    names.push_back(known.name);
    if (type != known.name) continue;
    input.type = known.type;
    return input;
  }
  throw std::invalid_argument(
      fmt::format("{} {}: '{}' is not {}", option.name, text, type, fmt::join(names, " or ")));
}

void check(const std::vector<AidingInput>& inputs) {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    for (std::size_t j = i + 1; j < inputs.size(); ++j) {
      const AidingInput& one = inputs[i];
      const AidingInput& other = inputs[j];
      if (one.type == Type::set_pose_service && other.type == one.type && one.topic == other.topic) {
        throw std::invalid_argument(fmt::format("{} and {}: one service can set the pose of one beacon only",
                                                text_of(one), text_of(other)));
      }
      const bool are_alike = one.kind == other.kind || (is_velocity(one.kind) && is_velocity(other.kind));
      const bool is_set = one.kind == Kind::set_pose && (one.topic != other.topic || one.type != other.type);
      if (one.address != other.address || !are_alike || is_set) continue;
      throw std::invalid_argument(fmt::format(
          "{} and {}: beacon {} can have only one source of {}", text_of(one), text_of(other), one.address,
          one.kind == Kind::set_pose ? "poses on this topic" : option_of(one.kind).source));
    }
  }
}

}  // namespace sonopose::ros2
