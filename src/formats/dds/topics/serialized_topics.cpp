#include "dds/topics/serialized_fields.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <algorithm>
#include <array>
#include <string_view>
#include <tuple>
#include <utility>

namespace sonopose::dds::topics {
namespace {

constexpr std::string_view prefix = "sonopose/";

template <std::size_t I>
SerializedReader make_reader_of(const domain::DomainParticipant& participant, const qos::Provider& qos,
                                sub::DataReaderListener<Serialized>* listener) {
  constexpr auto entry = std::get<I>(all);
  using T = typename decltype(entry)::Type;
  const topic::Topic<T> topic(participant, entry.name, qos.topic_qos(entry.profile));
  Qos reader_qos = qos.datareader_qos(entry.profile);
  reader_qos << policy::Deadline();
  return {ext::subscriber_of(participant, reader_qos), ext::serialized(topic), reader_qos, listener,
          core::status::StatusMask::all()};
}

template <std::size_t I>
SerializedWriter make_writer_of(const domain::DomainParticipant& participant, const qos::Provider& qos,
                                Delivery delivery) {
  constexpr auto entry = std::get<I>(all);
  using T = typename decltype(entry)::Type;
  const char* profile = profile_of(entry, delivery);
  const topic::Topic<T> topic(participant, entry.name, qos.topic_qos(profile));
  Qos writer_qos = qos.datawriter_qos(profile);
  // Offers the lease that readers request. A live fusion asserts its own, shorter one.
  writer_qos << policy::WriterDataLifecycle::ManuallyDisposeUnregisteredInstances()
             << qos.datareader_qos(profile).template policy_or_default<policy::Liveliness>();
  // Keeps all samples even with a live profile, whose own writers need only their latest sample.
  if (delivery == Delivery::lossless) writer_qos << policy::History::KeepAll() << policy::Lifespan();
  return {ext::publisher_of(participant, writer_qos), ext::serialized(topic), writer_qos};
}

template <std::size_t I>
bool is_latched_of(const qos::Provider& qos) {
  const Qos& reader_qos = qos.datareader_qos(std::get<I>(all).profile);
  return reader_qos.policy_or_default<policy::Durability>() == policy::Durability::TransientLocal();
}

template <std::size_t I>
bool is_exclusive_of(const qos::Provider& qos) {
  return is_exclusive(qos.datareader_qos(std::get<I>(all).profile));
}

template <std::size_t I>
SerializedTopic row() {
  constexpr auto entry = std::get<I>(all);
  using T = typename decltype(entry)::Type;
  constexpr bool has_beacon = requires(const T& sample) {
    sample.address;
  };
  return {.name = entry.name,
          .type_name = TopicTraits<T>::descriptor().m_typename,
          .has_beacon = has_beacon,
          .make_reader = make_reader_of<I>,
          .make_writer = make_writer_of<I>,
          .shift_times = shift_times<T>,
          .key_fields = key_fields<T>,
          .is_latched = is_latched_of<I>,
          .is_exclusive = is_exclusive_of<I>};
}

template <std::size_t... I>
std::array<SerializedTopic, sizeof...(I)> rows(std::index_sequence<I...> /*all*/) {
  return {row<I>()...};
}

}  // namespace

std::span<const SerializedTopic> serialized_topics() {
  static const auto table = rows(std::make_index_sequence<std::tuple_size_v<decltype(all)>>());
  return table;
}

std::string short_name(std::string_view topic) {
  if (topic.starts_with('/')) topic.remove_prefix(1);
  if (topic.starts_with(prefix)) topic.remove_prefix(prefix.size());
  return std::string(topic);
}

const SerializedTopic* find_topic(const std::string& name) {
  const auto topics = serialized_topics();
  const auto found = std::find_if(topics.begin(), topics.end(), [&](const SerializedTopic& topic) {
    return short_name(topic.name) == short_name(name);
  });
  return found == topics.end() ? nullptr : &*found;
}

}  // namespace sonopose::dds::topics
