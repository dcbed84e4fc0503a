#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/serialized_types.hpp>
#include <sonopose/ros2/messages/service_types.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <stdexcept>

namespace sonopose::ros2 {
namespace {

struct Definition {
  std::string_view dds_type_name;
  std::string_view text;
};

// The number of generated rows is not known here. NOLINTNEXTLINE(modernize-avoid-c-arrays)
constexpr Definition definitions[] = {
#include <sonopose/idl/ros2/message_definitions.inc>
};

template <class T>
dds::SerializedReader make_reader_of(const dds::domain::DomainParticipant& participant,
                                     const std::string& topic_in_dds, const dds::Qos& qos,
                                     dds::sub::DataReaderListener<dds::Serialized>* listener) {
  const dds::topic::Topic<T> topic(participant, topic_in_dds);
  const dds::sub::Subscriber subscriber(participant, qos);
  return {subscriber, dds::ext::serialized(topic), qos, listener, dds::core::status::StatusMask::all()};
}

template <class... T>
auto types_of() {
  return std::array{SerializedType{dds::TopicTraits<T>::descriptor().m_typename, make_reader_of<T>}...};
}

}  // namespace

std::span<const SerializedType> serialized_types() {
  static const auto types = types_of<Clock, PointStamped, PoseStamped, PoseWithCovarianceStamped,
                                     TwistStamped, TwistWithCovarianceStamped, Imu, JointState, MagneticField,
                                     Float64, Odometry, Path, TFMessage, DiagnosticArray, LogMessage,
                                     ParameterEvent, VehicleOdometry, SensorCombined, TimesyncStatus>();
  return types;
}

std::string_view message_definition(std::string_view dds_type_name) {
  const auto* const row =
      std::find_if(std::begin(definitions), std::end(definitions),
                   [&](const Definition& each) { return each.dds_type_name == dds_type_name; });
  if (row == std::end(definitions)) {
    throw std::invalid_argument("idl/ros2 has no message '" + std::string(dds_type_name) + "'");
  }
  return row->text;
}

std::optional<std::string> name_in_ros(const std::string& topic_in_dds) {
  if (!topic_in_dds.starts_with("rt/")) return std::nullopt;
  return topic_in_dds.substr(2);
}

dds::Qos matching_reader_qos(const dds::qos::Provider& qos, const dds::Qos& writer_qos) {
  namespace policy = dds::policy;
  dds::Qos reader = qos.datareader_qos("ros2::Default");
  if (writer_qos.policy_or_default<policy::Reliability>().kind() == policy::ReliabilityKind::BEST_EFFORT) {
    reader << policy::Reliability::BestEffort();
  }
  return reader << writer_qos.policy_or_default<policy::Durability>() << policy::Deadline();
}

std::string qos_in_yaml(const dds::Qos& writer_qos) {
  namespace policy = dds::policy;
  // The numbers are those of rmw_qos_history_policy_t and its siblings. Infinite durations are
  // RMW_DURATION_INFINITE.
  const auto history = writer_qos.policy_or_default<policy::History>();
  const auto reliability = writer_qos.policy_or_default<policy::Reliability>();
  const auto durability = writer_qos.policy_or_default<policy::Durability>();
  const std::string infinite = "\n    sec: 9223372036\n    nsec: 854775807\n";
  return fmt::format(
      "- history: {}\n  depth: {}\n  reliability: {}\n  durability: {}\n  deadline:{}  lifespan:{}"
      "  liveliness: 1\n  liveliness_lease_duration:{}  avoid_ros_namespace_conventions: false\n",
      history.kind() == policy::HistoryKind::KEEP_LAST ? 1 : 2, history.depth(),
      reliability.kind() == policy::ReliabilityKind::RELIABLE ? 1 : 2,
      durability.kind() == policy::DurabilityKind::TRANSIENT_LOCAL ? 1 : 2, infinite, infinite, infinite);
}

}  // namespace sonopose::ros2
