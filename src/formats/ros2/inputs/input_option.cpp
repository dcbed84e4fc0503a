#include "ros2/inputs/input_option.hpp"

#include <sonopose/ros2/messages/idl_types.hpp>

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace sonopose::ros2 {
namespace {

const char* option_name(Input::Kind kind) {
  return kind == Input::Kind::imu ? "--imu-in" : "--fix-in";
}

struct FixTypeName {
  FixType type;
  std::string_view name;  ///< name in geometry_msgs
  const char* dds_name;
};

const std::array<FixTypeName, 2>& fix_type_names() {
  static const std::array names{
      FixTypeName{FixType::point, "PointStamped", dds::TopicTraits<PointStamped>::descriptor().m_typename},
      FixTypeName{FixType::pose, "PoseWithCovarianceStamped",
                  dds::TopicTraits<PoseWithCovarianceStamped>::descriptor().m_typename}};
  return names;
}

constexpr std::string_view px4_imu = "SensorCombined";

/// Parses a name with or without the package: "PointStamped", "geometry_msgs/PointStamped" or
/// "geometry_msgs/msg/PointStamped".
std::optional<FixType> parse_fix_type(std::string_view text) {
  for (const std::string_view package : {"geometry_msgs/", "msg/"}) {
    if (text.starts_with(package)) text.remove_prefix(package.size());
  }
  for (const FixTypeName& known : fix_type_names()) {
    if (text == known.name) return known.type;
  }
  return std::nullopt;
}

/// Parses "0.2,0,0.5". Empty for anything else.
std::optional<Vector3d> parse_place(std::string_view text) {
  constexpr double max_m = 1000;
  Vector3d place_m;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int axis = 0; axis < 3; ++axis) {
    const auto [rest, error] = std::from_chars(at, end, place_m[axis]);
    if (error != std::errc() || !(std::abs(place_m[axis]) <= max_m)) return std::nullopt;
    at = rest;
    if (axis < 2 && (at == end || *at++ != ',')) return std::nullopt;
  }
  return at == end ? std::optional(place_m) : std::nullopt;
}

/// Removes "@tag_link" from "/tag/pose=7@tag_link" and stores it.
std::string_view take_place(std::string_view text, Input& input) {
  const std::size_t equals = text.rfind('=');
  const std::size_t at = equals == std::string_view::npos ? equals : text.find('@', equals);
  if (at == std::string_view::npos) return text;
  const std::string_view place = text.substr(at + 1);
  input.tag_base_m = parse_place(place);
  if (!input.tag_base_m) input.tag_frame = place;
  if (place.empty() || (!input.tag_base_m && place.find(',') != std::string_view::npos)) {
    throw std::invalid_argument(
        fmt::format("{} {}: '{}' is neither a frame nor a place x,y,z on the base within 1000 m",
                    option_name(input.kind), text, place));
  }
  return text.substr(0, at);
}

bool has_place(const Input& input) {
  return input.tag_base_m || !input.tag_frame.empty();
}

void check_pair(const Input& one, const Input& other) {
  if (one.kind != other.kind || one.address != other.address) return;
  if (one.kind == Input::Kind::imu && one.topic != other.topic) return;  // accelerometer and gyroscope
  if (one.kind == Input::Kind::fix && one.topic != other.topic && (has_place(one) || has_place(other)))
    return;
  throw std::invalid_argument(fmt::format(
      "{} and {}: beacon {} can have only one source of {}", text_of(one), text_of(other), one.address,
      one.kind == Input::Kind::imu ? "IMU samples"
                                   : "fixes, unless its tags have places: /tag/pose=7@tag_link"));
}

}  // namespace

std::string text_of(const Input& input) {
  std::string type;
  for (const FixTypeName& known : fix_type_names()) {
    if (input.fix_type == known.type) type = fmt::format(":{}", known.name);
  }
  if (input.imu_type == ImuType::px4) type = fmt::format(":{}", px4_imu);
  return fmt::format("{} {}{}={}", option_name(input.kind), input.topic, type, input.address);
}

std::string message_type_of(const Input& input) {
  if (input.kind == Input::Kind::imu && input.imu_type == ImuType::px4) {
    return dds::TopicTraits<SensorCombined>::descriptor().m_typename;
  }
  if (input.kind == Input::Kind::imu) return dds::TopicTraits<Imu>::descriptor().m_typename;
  for (const FixTypeName& known : fix_type_names()) {
    if (input.fix_type == known.type) return known.dds_name;
  }
  return {};
}

std::optional<FixType> fix_type_named(std::string_view dds_type_name) {
  for (const FixTypeName& known : fix_type_names()) {
    if (dds_type_name == known.dds_name) return known.type;
  }
  return std::nullopt;
}

TopicOfBeacon parse_topic(std::string_view option, std::string_view text, std::string_view example) {
  const std::size_t equals = text.rfind('=');
  const auto fail = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("{} {}: {}; example: {}", option, text, why, example));
  };
  if (equals == std::string_view::npos || equals == 0) fail("expected TOPIC=ADDRESS");
  const std::string_view number = text.substr(equals + 1);
  std::uint32_t address = 0;
  const auto [rest, error] = std::from_chars(number.data(), number.data() + number.size(), address);
  if (error != std::errc() || rest != number.data() + number.size() || address >= all_beacons) {
    fail(fmt::format("'{}' is not an address from 0 to {}", number, all_beacons - 1));
  }
  return {.topic = std::string(text.substr(0, equals)), .address = static_cast<BeaconAddress>(address)};
}

Input Input::parse(Kind kind, std::string_view text) {
  Input input;
  input.kind = kind;
  if (kind == Kind::fix) text = take_place(text, input);
  TopicOfBeacon of = parse_topic(option_name(kind), text, "/imu/data=7");
  input.topic = std::move(of.topic);
  input.address = of.address;
  const std::size_t colon = input.topic.find(':');
  if (kind == Kind::fix && colon != std::string::npos) {
    input.fix_type = parse_fix_type(std::string_view(input.topic).substr(colon + 1));
    if (!input.fix_type) {
      throw std::invalid_argument(fmt::format("{} {}: '{}' is not PointStamped or PoseWithCovarianceStamped",
                                              option_name(kind), text, input.topic.substr(colon + 1)));
    }
    input.topic.resize(colon);
  }
  if (kind == Kind::imu && colon != std::string::npos) {
    const std::string type = input.topic.substr(colon + 1);
    const bool is_px4 =
        type == px4_imu || type == "px4_msgs/SensorCombined" || type == "px4_msgs/msg/SensorCombined";
    if (!is_px4 && type != "Imu") {
      throw std::invalid_argument(
          fmt::format("{} {}: '{}' is not Imu or {}", option_name(kind), text, type, px4_imu));
    }
    if (is_px4) input.imu_type = ImuType::px4;
    input.topic.resize(colon);
  }
  return input;
}

void check(const std::vector<Input>& inputs) {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    int imus = inputs[i].kind == Input::Kind::imu ? 1 : 0;
    for (std::size_t j = i + 1; j < inputs.size(); ++j) {
      check_pair(inputs[i], inputs[j]);
      imus += inputs[j].kind == Input::Kind::imu && inputs[j].address == inputs[i].address ? 1 : 0;
    }
    if (inputs[i].kind != Input::Kind::imu || imus <= 2) continue;
    throw std::invalid_argument(fmt::format(
        "{}: beacon {} can have two topics of IMU samples, the accelerometer's and the gyroscope's, not {}",
        text_of(inputs[i]), inputs[i].address, imus));
  }
}

std::string advice_on_type(std::string_view topic, std::string_view type) {
  for (const std::string_view pose : {"PoseStamped", "Odometry"}) {
    if (type.ends_with("/" + std::string(pose)))
      return fmt::format("; --pose-in {}:{} takes it, with its orientation", topic, pose);
  }
  return {};
}

}  // namespace sonopose::ros2
