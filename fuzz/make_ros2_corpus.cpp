#include "make_corpus.hpp"
#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/service_types.hpp>
#include <sonopose/ros2/messages/static_transforms.hpp>

#include <limits>

namespace sonopose::fuzz {
namespace {

// ROS 2. The indices are those of the fuzzer's readers.

const std::string map_frame = "map";

template <class Message>
Message with_header(Message message, std::int32_t sec = 1'700'000'000, std::uint32_t nanosec = 5) {
  message.header.stamp = {sec, nanosec};
  message.header.frame_id = ros2::borrow_string(map_frame);
  return message;
}

void write_ros2_measurements(const fs::path& folder) {
  constexpr std::uint32_t too_many_ns = 1'000'000'000;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  write_sample(folder, 0, with_header(ros2::Imu{}));
  write_sample(folder, 0, with_header(ros2::Imu{}, 0, 0), "imu_without_time");
  write_sample(folder, 0, with_header(ros2::Imu{}, 1, too_many_ns), "imu_wrong_time");
  ros2::Imu imu{};
  imu.angular_velocity.x = nan;
  write_sample(folder, 0, with_header(imu), "imu_nan");
  write_sample(folder, 1, with_header(ros2::PointStamped{}));
  write_sample(folder, 1, with_header(ros2::PointStamped{}, 1, too_many_ns), "point_wrong_time");
  ros2::PoseWithCovarianceStamped pose{};
  write_sample(folder, 2, with_header(pose), "pose_unknown_covariance");
  pose.pose.covariance[0] = 0.04;
  write_sample(folder, 2, with_header(pose));
  pose.pose.covariance[1] = pose.pose.covariance[6] = 1;
  write_sample(folder, 2, with_header(pose), "pose_no_covariance");
  pose.pose.pose.position.x = nan;
  write_sample(folder, 2, with_header(pose), "pose_nan");
  write_sample(folder, 4, ros2::Clock{});
}

void write_ros2_transforms(const fs::path& folder) {
  const std::string mount = "mount";
  const std::string beacon = "beacon";
  const auto transform = [](const std::string& parent, const std::string& child, double w) {
    ros2::TransformStamped one{};
    one.header.frame_id = ros2::borrow_string(parent);
    one.child_frame_id = ros2::borrow_string(child);
    one.transform.rotation.w = w;
    return one;
  };
  const auto write_tree = [&](const char* name, std::vector<ros2::TransformStamped> transforms) {
    ros2::TFMessage message{};
    ros2::borrow_sequence(message.transforms, transforms);
    write_sample(folder, 3, message, name);
  };
  write_tree("transforms", {transform(map_frame, mount, 1), transform(mount, beacon, 1)});
  write_tree("transforms_cycle", {transform(beacon, mount, 1), transform(mount, beacon, 1)});
  write_tree("transforms_no_rotation", {transform(map_frame, mount, 0), transform(map_frame, beacon, 1)});
  const std::string longest(ros2::StaticTransforms::max_name_length, 'x');
  write_tree("transforms_long_name", {transform(longest, mount, 1), transform(longest + "x", beacon, 1)});
}

/// Writes a request whose sequence of texts `member` is `texts`.
template <class Request, class Member>
void write_texts(const fs::path& folder, int index, Request request, Member Request::*member,
                 const std::vector<std::string>& texts, const std::string& name) {
  std::vector<char*> views;
  for (const std::string& text : texts) views.push_back(ros2::borrow_string(text));
  ros2::borrow_sequence(request.*member, views);
  write_sample(folder, index, request, name);
}

void write_ros2_parameters(const fs::path& folder) {
  // Settings of the fuzzer's effective(), other settings, and unknown names.
  const std::vector<std::string> names{"documented.trust.n_min",
                                       "fusion.engine",
                                       "beacon_7.documented.trust.n_min",
                                       "beacon_7.documented.drift.jump_alpha",
                                       "beacon_7.documented.trust.n_base",
                                       "beacon_8.documented.trust.n_min",
                                       "beacon_65535.documented.trust.n_min",
                                       "beacon_07.documented.trust.n_min",
                                       "beacon_x",
                                       "beacon_7",
                                       "beacon_7.none",
                                       "none"};
  write_texts(folder, 7, ros2::GetParameters::Request{}, &ros2::GetParameters::Request::names, names, "get");
  write_texts(folder, 9, ros2::DescribeParameters::Request{}, &ros2::DescribeParameters::Request::names,
              names, "describe");
  write_texts(folder, 10, ros2::GetParameterTypes::Request{}, &ros2::GetParameterTypes::Request::names, names,
              "types");
  const auto write_list = [&folder](std::uint64_t depth, const std::vector<std::string>& prefixes,
                                    const std::string& name) {
    ros2::ListParameters::Request request{};
    request.depth = depth;
    write_texts(folder, 8, request, &ros2::ListParameters::Request::prefixes, prefixes, name);
  };
  write_list(0, {}, "list_all");
  write_list(1, {}, "list_flat");
  write_list(2, {"documented.trust", "beacon_7", "documented.trust.n_min", "none"}, "list_prefixes");

  std::vector<ros2::Parameter> parameters(6);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    parameters[i].name = ros2::borrow_string(names[i]);
    parameters[i].value.type = static_cast<std::uint8_t>(i);  // from no type to one that no setting has
    parameters[i].value.string_value = ros2::borrow_string(names[i]);
  }
  ros2::SetParameters::Request request{};
  ros2::borrow_sequence(request.parameters, parameters);
  write_sample(folder, 6, request);
  ros2::SetParametersAtomically::Request at_once{};
  ros2::borrow_sequence(at_once.parameters, parameters);
  write_sample(folder, 11, at_once, "set_at_once");
}

}  // namespace

void write_ros2_corpus(const fs::path& folder) {
  write_ros2_measurements(folder);
  write_ros2_transforms(folder);
  write_ros2_parameters(folder);
}

}  // namespace sonopose::fuzz
