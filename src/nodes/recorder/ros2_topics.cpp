#include "recorder/ros2_topics.hpp"

#include "logging/log.hpp"
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/ros2/messages/serialized_types.hpp>
#include <sonopose/text/escaped.hpp>

#include <algorithm>

namespace sonopose::recorder {

namespace {

bool is_latched(const dds::Qos& qos) {
  return qos.policy_or_default<dds::policy::Durability>() == dds::policy::Durability::TransientLocal();
}

}  // namespace

void Ros2Topics::update(const std::vector<dds::FoundEndpoint>& writers) {
  for (const dds::FoundEndpoint& writer : writers) {
    const auto name = ros2::name_in_ros(writer.topic_name);
    if (name && !contains(writer.topic_name)) add(writer, *name);
  }
}

void Ros2Topics::add(const dds::FoundEndpoint& writer, const std::string& name) {
  const auto types = ros2::serialized_types();
  const auto type = std::find_if(types.begin(), types.end(), [&](const ros2::SerializedType& each) {
    return each.dds_name == writer.type_name;
  });
  if (type == types.end()) return;
  topics_.insert(writer.topic_name);
  const std::uint16_t channel_id =
      pipeline_.add_channel({.topic = name,
                             .message_encoding = "cdr",
                             .schema_name = ros2::type_name_in_ros(writer.type_name),
                             .schema_encoding = "ros2msg",
                             .schema_data = std::string(ros2::message_definition(writer.type_name)),
                             .metadata = {{"offered_qos_profiles", ros2::qos_in_yaml(writer.qos)}},
                             .is_latched = is_latched(writer.qos)});
  const dds::Qos qos = ros2::matching_reader_qos(qos_, writer.qos);
  try {
    pipeline_.record({.name = name}, channel_id,
                     [&](dds::sub::DataReaderListener<dds::Serialized>* listener) {
                       return type->make_reader(participant_, writer.topic_name, qos, listener);
                     });
  } catch (const dds::core::Exception& error) {  // DDS or its security refuses the topic
    logging::warning(text::escaped(name) + " of ROS 2 cannot be recorded: " + text::escaped(error.what()));
    return;
  }
  logging::info("recording " + text::escaped(name) + " of ROS 2");
}

}  // namespace sonopose::recorder
