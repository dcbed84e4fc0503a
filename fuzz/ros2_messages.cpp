// Deserializes messages of ROS 2 drivers and clients, and converts them to native types. Byte 0 selects the
// type.

#include "cdr_type.hpp"
#include "ros2/relay/parameter_messages.hpp"
#include "ros2/relay/parameters.hpp"
#include "support.hpp"
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/input.hpp>
#include <sonopose/ros2/messages/service_types.hpp>
#include <sonopose/ros2/messages/static_transforms.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <Eigen/Eigenvalues>

#include <array>
#include <cmath>
#include <string>
#include <vector>

using namespace sonopose;
using namespace sonopose::fuzz;

namespace {

using Bytes = std::span<const std::uint8_t>;
constexpr TimeNs received_ns = 1'700'000'000'000'000'000;
constexpr BeaconAddress address = 7;

void check_fix(const std::optional<UltrasonicFix>& fix) {
  if (!fix) return;
  promise(fix->position_world_m.allFinite(), "a fix is finite");
  promise(fix->emission_time_ns <= fix->received_time_ns, "a fix is received after its emission");
  if (!fix->covariance_world_m2) return;
  const Eigen::Matrix3d covariance = fix->covariance_world_m2->matrix();
  promise(covariance.allFinite() && covariance.diagonal().minCoeff() > 0, "variances are positive");
}

void check_imu(const std::optional<ros2::ReceivedImu>& imu) {
  promise(!imu || (imu->sample.angular_velocity_body_radps.allFinite() &&
                   imu->sample.specific_force_body_mps2.allFinite()),
          "an IMU sample is finite");
}

void use(const ros2::Imu& imu) {
  check_imu(ros2::imu_sample(imu, address, received_ns));
}
void use(const ros2::SensorCombined& imu) {
  check_imu(ros2::imu_sample(imu, address));
}
void use(const ros2::PointStamped& point) {
  check_fix(ros2::fix(point, address, received_ns));
}
void use(const ros2::PoseWithCovarianceStamped& pose) {
  check_fix(ros2::fix(pose, address, received_ns));
}
void use(const ros2::SetPose::Request& request) {
  check_fix(ros2::fix(request.pose, address, received_ns));
}
void use(const ros2::SetParameters::Request& request) {
  for (std::uint32_t i = 0; i < request.parameters._length; ++i) {
    ros2::relay::value_text(request.parameters._buffer[i].value);
  }
}
void use(const ros2::TFMessage& message) {
  ros2::StaticTransforms tree;
  tree.add(message);
  for (std::uint32_t i = 0; i < message.transforms._length; ++i) {
    const ros2::TransformStamped& one = message.transforms._buffer[i];
    ros2::from_ros(one.header.stamp);
    for (const char* const parent : {message.transforms._buffer[0].header.frame_id, one.header.frame_id}) {
      const auto found = tree.find(parent, one.child_frame_id);
      promise(!found || std::abs(found->rotation.norm() - 1) < 1e-6, "a transform has a rotation");
    }
  }
}
void use(const ros2::Clock& clock) {
  ros2::from_ros(clock.clock);
}

std::vector<std::string> texts_of(const auto& sequence) {
  return {sequence._buffer, sequence._buffer + sequence._length};
}

/// Returns settings of a fusion, some with invalid values.
const ros2::relay::SettingsByBeacon& effective() {
  static const ros2::relay::SettingsByBeacon settings{
      {all_beacons,
       {.values = {{"documented.trust.n_min", "4"},
                   {"fusion.engine", "kalman"},
                   {"output.rate_hz", "nonsense"}}}},
      {address,
       {.address = address,
        .values = {{"documented.trust.n_min", "5"}, {"documented.drift.jump_alpha", ""}}}}};
  return settings;
}

void look_up(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const auto setting = ros2::relay::setting_named(name);
    promise(!setting || ros2::relay::parameter_name(*setting) == name, "a parameter has one name");
    const auto value = ros2::relay::parameter_value(effective(), name);
    promise(!value || setting, "a value belongs to a setting");
  }
}
void use(const ros2::GetParameters::Request& request) {
  look_up(texts_of(request.names));
}
void use(const ros2::GetParameterTypes::Request& request) {
  look_up(texts_of(request.names));
}
void use(const ros2::DescribeParameters::Request& request) {
  look_up(texts_of(request.names));
}
void use(const ros2::SetParametersAtomically::Request& request) {
  for (std::uint32_t i = 0; i < request.parameters._length; ++i) {
    look_up({request.parameters._buffer[i].name});
    ros2::relay::value_text(request.parameters._buffer[i].value);
  }
}
void use(const ros2::ListParameters::Request& request) {
  const auto list = ros2::relay::list_parameters(effective(), texts_of(request.prefixes), request.depth);
  look_up(list.names);
  promise(list.names.size() <= 5, "only parameters that exist are listed");
}
void use(const auto& /*sample*/) {}

template <class T>
void read_as(Bytes bytes) {
  static const CdrType<T> type;
  type.read(bytes, [](const T& message) { use(message); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array readers{read_as<ros2::Imu>,
                               read_as<ros2::PointStamped>,
                               read_as<ros2::PoseWithCovarianceStamped>,
                               read_as<ros2::TFMessage>,
                               read_as<ros2::Clock>,
                               read_as<ros2::ParticipantEntitiesInfo>,
                               read_as<ros2::SetParameters::Request>,
                               read_as<ros2::GetParameters::Request>,
                               read_as<ros2::ListParameters::Request>,
                               read_as<ros2::DescribeParameters::Request>,
                               read_as<ros2::GetParameterTypes::Request>,
                               read_as<ros2::SetParametersAtomically::Request>,
                               read_as<ros2::Trigger::Request>,
                               read_as<ros2::SensorCombined>,
                               read_as<ros2::SetPose::Request>};
  if (size == 0) return 0;
  readers.at(data[0] % readers.size())({data + 1, size - 1});
  return 0;
}
