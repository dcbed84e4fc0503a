// The type-independent part of readers and writers.

#include <sonopose/dds/binding/data_reader.hpp>
#include <sonopose/dds/binding/data_writer.hpp>

#include <memory>

namespace sonopose::dds::detail {
namespace {

using EndpointData = std::unique_ptr<dds_builtintopic_endpoint_t, void (*)(dds_builtintopic_endpoint_t*)>;

/// Retries while matches appear faster than the buffer grows.
template <class Call>
std::vector<InstanceHandle> matched(const char* name, Call call, dds_entity_t entity) {
  std::vector<dds_instance_handle_t> handles(8);
  std::size_t count = 0;
  while ((count = static_cast<std::size_t>(check(name, call(entity, handles.data(), handles.size())))) >
         handles.size()) {
    handles.resize(count);
  }
  std::vector<InstanceHandle> result;
  result.reserve(count);
  for (std::size_t i = 0; i < count; ++i) result.push_back({handles[i]});
  return result;
}

/// The common part of matched readers and writers. Throws `Error` if `call` returned no endpoint.
template <class Data>
Data data_of(const char* call, const EndpointData& endpoint) {
  if (!endpoint) throw Error(call, DDS_RETCODE_BAD_PARAMETER);
  Data data;
  data.participant_key = endpoint->participant_key;
  if (auto user_data = policy::UserData::from(endpoint->qos)) data.user_data = std::move(user_data->value);
  return data;
}

}  // namespace

std::vector<InstanceHandle> matched_subscriptions(dds_entity_t writer) {
  return matched("dds_get_matched_subscriptions", dds_get_matched_subscriptions, writer);
}

std::vector<InstanceHandle> matched_publications(dds_entity_t reader) {
  return matched("dds_get_matched_publications", dds_get_matched_publications, reader);
}

PublicationData matched_publication_data(dds_entity_t reader, InstanceHandle publication) {
  const EndpointData endpoint(dds_get_matched_publication_data(reader, publication.value),
                              dds_builtintopic_free_endpoint);
  auto data = data_of<PublicationData>("dds_get_matched_publication_data", endpoint);
  data.topic_name = endpoint->topic_name;
  data.type_name = endpoint->type_name;
  data.key = endpoint->key;
  return data;
}

SubscriptionData matched_subscription_data(dds_entity_t writer, InstanceHandle subscription) {
  const EndpointData endpoint(dds_get_matched_subscription_data(writer, subscription.value),
                              dds_builtintopic_free_endpoint);
  return data_of<SubscriptionData>("dds_get_matched_subscription_data", endpoint);
}

}  // namespace sonopose::dds::detail
