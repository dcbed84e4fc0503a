#include "dds/topics/cdr_cursor.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/idl/field_visitors.hpp>

#include <algorithm>
#include <array>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

namespace sonopose::dds::topics {
namespace {

constexpr std::string_view prefix = "sonopose/";

template <std::size_t I>
SerializedReader make_reader_of(const DomainParticipant& participant, const qos::Provider& qos,
                                DataReaderListener<Serialized>* listener) {
  constexpr auto entry = std::get<I>(all);
  using T = typename decltype(entry)::Type;
  const Topic<T> topic(participant, entry.name, qos.topic_qos(entry.profile));
  Qos reader_qos = qos.datareader_qos(entry.profile);
  reader_qos << policy::Deadline{infinite};
  join_partition(reader_qos, participant);
  return SerializedReader(participant, topic, reader_qos, listener);
}

template <std::size_t I>
SerializedWriter make_writer_of(const DomainParticipant& participant, const qos::Provider& qos) {
  constexpr auto entry = std::get<I>(all);
  using T = typename decltype(entry)::Type;
  const Topic<T> topic(participant, entry.name, qos.topic_qos(entry.profile));
  Qos writer_qos = qos.datawriter_qos(entry.profile);
  // The lease of the reader's profile, which a live fusion's is shorter than: nobody asserts this one.
  writer_qos << policy::WriterDataLifecycle{false}
             << qos.datareader_qos(entry.profile)
                    .template policy<policy::Liveliness>()
                    .value_or(policy::Liveliness{});
  join_partition(writer_qos, participant);
  return SerializedWriter(participant, topic, writer_qos);
}

/// Whether a field is a part of the key of T.
template <class T>
bool is_key(std::string_view name) {
  const dds_topic_descriptor_t& type = TopicTraits<T>::descriptor();
  return std::any_of(type.m_keys, type.m_keys + type.m_nkeys,
                     [name](const dds_key_descriptor_t& key) { return name == key.m_name; });
}

template <std::size_t I>
std::vector<KeyField> key_fields_of(std::span<const std::byte> key) {
  using T = typename std::tuple_element_t<I, std::remove_const_t<decltype(all)>>::Type;
  CdrCursor cursor(key);
  std::vector<KeyField> fields;
  idl::visit_fields(T{}, [&]<class Value>(const char* name, const Value& /*field*/) {
    if (!is_key<T>(name)) return;
    if constexpr (std::is_unsigned_v<Value> && !std::is_same_v<Value, bool>) {
      fields.push_back({name, std::uint64_t{cursor.template read<Value>()}});
    } else if constexpr (std::is_array_v<Value>) {
      fields.push_back({name, cursor.read_string()});
    }
  });
  return cursor.is_good() ? fields : std::vector<KeyField>{};
}

template <std::size_t I>
bool is_latched_of(const qos::Provider& qos) {
  const auto durability = qos.datareader_qos(std::get<I>(all).profile).template policy<policy::Durability>();
  return durability.value_or(policy::Durability{}).kind == policy::DurabilityKind::transient_local;
}

template <std::size_t I>
SerializedTopic row() {
  constexpr auto entry = std::get<I>(all);
  using T = typename decltype(entry)::Type;
  constexpr bool has_beacon = requires(const T& sample) {
    sample.address;
  };
  const dds_topic_descriptor_t& type = TopicTraits<T>::descriptor();
  return {entry.name,        type.m_typename,   has_beacon,       has_beacon && type.m_nkeys == 1,
          make_reader_of<I>, make_writer_of<I>, key_fields_of<I>, is_latched_of<I>};
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

std::string short_name(const std::string& topic) {
  return topic.starts_with(prefix) ? topic.substr(prefix.size()) : topic;
}

const SerializedTopic* find_topic(const std::string& name) {
  const auto topics = serialized_topics();
  const auto found = std::find_if(topics.begin(), topics.end(), [&](const SerializedTopic& topic) {
    return short_name(topic.name) == short_name(name);
  });
  return found == topics.end() ? nullptr : &*found;
}

std::optional<BeaconAddress> beacon_of(std::span<const std::byte> sample) {
  CdrCursor cursor(sample);
  const auto address = cursor.read<std::uint16_t>();
  return cursor.is_good() ? std::optional<BeaconAddress>(address) : std::nullopt;
}

}  // namespace sonopose::dds::topics
