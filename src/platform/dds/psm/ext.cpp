#include "dds/binding/participant.hpp"
#include <sonopose/dds/psm/ext.hpp>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace sonopose::dds::ext {
namespace {

using core::detail::check;
using Endpoint = std::unique_ptr<dds_builtintopic_endpoint_t, void (*)(dds_builtintopic_endpoint_t*)>;

/// Retries while matches appear faster than the buffer grows.
template <class Call>
std::vector<core::InstanceHandle> matched(const char* name, Call call, dds_entity_t entity) {
  std::vector<dds_instance_handle_t> handles(8);
  std::size_t count = 0;
  while ((count = static_cast<std::size_t>(check(name, call(entity, handles.data(), handles.size())))) >
         handles.size()) {
    handles.resize(count);
  }
  return {handles.begin(), handles.begin() + static_cast<std::ptrdiff_t>(count)};
}

std::optional<EndpointData> data_of(const Endpoint& endpoint) {
  if (!endpoint) return std::nullopt;
  core::policy::UserData user_data;
  core::detail::read(user_data, endpoint->qos);
  return EndpointData{endpoint->participant_key, user_data.value()};
}

/// The QoS of a publisher or subscriber, with the partition of its endpoint if the options have none.
template <class OuterQos>
OuterQos with_partition_of(const Qos& endpoint, OuterQos by_options) {
  const auto partition = endpoint.policy<policy::Partition>();
  if (partition && by_options == OuterQos()) by_options << *partition;
  return by_options;
}

}  // namespace

dds_guid_t guid_of(const core::Entity& entity) {
  dds_guid_t guid{};
  check("dds_get_guid", dds_get_guid(handle(entity), &guid));
  return guid;
}

std::string text_of(const dds_guid_t& guid) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : guid.v) {
    text += digits[byte >> 4U];
    text += digits[byte & 15U];
  }
  return text;
}

domain::DomainParticipant participant(const DomainOptions& options, const Qos& qos) try {
  Qos secured(qos);
  const auto membership = std::make_shared<Membership>(options, secured.get());
  auto node = core::detail::Node::make<domain::detail::ParticipantNode>(nullptr);
  node->domain_id = membership->domain_id();
  node->qos = qos;
  node->partition = core::policy::Partition(options.partition);
  node->membership = membership;
  node->handle(membership->handle());
  return domain::DomainParticipant(std::move(node));
} catch (const Error& error) {
  core::detail::fail(error.what(), error.code());
} catch (const core::Exception&) {
  throw;
} catch (const std::invalid_argument& error) {
  throw core::InvalidArgumentError(error.what());
}

pub::Publisher publisher_of(const domain::DomainParticipant& participant, const Qos& writer_qos) {
  return {participant, with_partition_of(writer_qos, participant.default_publisher_qos())};
}

sub::Subscriber subscriber_of(const domain::DomainParticipant& participant, const Qos& reader_qos) {
  return {participant, with_partition_of(reader_qos, participant.default_subscriber_qos())};
}

std::chrono::nanoseconds to_chrono(const core::Duration& duration) {
  return std::chrono::nanoseconds(core::detail::to_c(duration));
}

core::Duration to_duration(std::chrono::nanoseconds duration) {
  return core::detail::to_duration(std::max(duration, std::chrono::nanoseconds::zero()).count());
}

bool wait(const core::cond::WaitSet& waitset, std::chrono::nanoseconds timeout) {
  const auto left = std::max(timeout, std::chrono::nanoseconds::zero());
  return check("dds_waitset_wait", dds_waitset_wait(handle(waitset), nullptr, 0, left.count())) > 0;
}

std::vector<core::InstanceHandle> matched_publications(const sub::AnyDataReader& reader) {
  return matched("dds_get_matched_publications", dds_get_matched_publications, handle(reader));
}

std::vector<core::InstanceHandle> matched_subscriptions(const pub::AnyDataWriter& writer) {
  return matched("dds_get_matched_subscriptions", dds_get_matched_subscriptions, handle(writer));
}

std::optional<EndpointData> matched_publication_data(const sub::AnyDataReader& reader,
                                                     const core::InstanceHandle& publication) {
  return data_of({dds_get_matched_publication_data(handle(reader), publication.c_value()),
                  dds_builtintopic_free_endpoint});
}

std::optional<EndpointData> matched_subscription_data(const pub::AnyDataWriter& writer,
                                                      const core::InstanceHandle& subscription) {
  return data_of({dds_get_matched_subscription_data(handle(writer), subscription.c_value()),
                  dds_builtintopic_free_endpoint});
}

bool wait_for_acknowledgments(const pub::AnyDataWriter& writer, std::chrono::nanoseconds timeout) {
  const ReturnCode code = dds_wait_for_acks(handle(writer), timeout.count());
  return code != DDS_RETCODE_TIMEOUT && check("dds_wait_for_acks", code) >= 0;
}

void set_filter(const topic::TopicDescription& topic, bool (*accepts)(const void* sample, void* argument),
                void* argument) {
  check("dds_set_topic_filter_and_arg", topic.name(),
        dds_set_topic_filter_and_arg(handle(topic), accepts, argument));
}

}  // namespace sonopose::dds::ext
