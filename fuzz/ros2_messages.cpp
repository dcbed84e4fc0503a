// Serialized messages of ROS 2 drivers and clients, and their conversion to native types. Byte 0 selects the
// type.

#include "cdr_type.hpp"
#include "ros2/relay/parameter_messages.hpp"
#include "support.hpp"
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/input.hpp>
#include <sonopose/ros2/messages/service_types.hpp>

#include <Eigen/Eigenvalues>

#include <array>

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

void use(const ros2::Imu& imu) {
  const auto sample = ros2::imu_sample(imu, address, received_ns);
  promise(!sample || (sample->angular_velocity_body_radps.allFinite() &&
                      sample->specific_force_body_mps2.allFinite()),
          "an IMU sample is finite");
}
void use(const ros2::PointStamped& point) {
  check_fix(ros2::fix(point, address, received_ns));
}
void use(const ros2::PoseWithCovarianceStamped& pose) {
  check_fix(ros2::fix(pose, address, received_ns));
}
void use(const ros2::SetParameters::Request& request) {
  for (std::uint32_t i = 0; i < request.parameters._length; ++i) {
    ros2::relay::value_text(request.parameters._buffer[i].value);
  }
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
                               read_as<ros2::ListParameters::Request>};
  if (size == 0) return 0;
  readers.at(data[0] % readers.size())({data + 1, size - 1});
  return 0;
}
