#include "dds/topics/cdr_cursor.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/idl/field_visitors.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
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
SerializedWriter make_writer_of(const DomainParticipant& participant, const qos::Provider& qos,
                                Delivery delivery) {
  constexpr auto entry = std::get<I>(all);
  using T = typename decltype(entry)::Type;
  const char* profile = profile_of(entry, delivery);
  const Topic<T> topic(participant, entry.name, qos.topic_qos(profile));
  Qos writer_qos = qos.datawriter_qos(profile);
  // The lease that a reader asks for: longer than that of a live fusion, which asserts its own.
  const auto lease = qos.datareader_qos(profile).template policy<policy::Liveliness>();
  writer_qos << policy::WriterDataLifecycle{false} << lease.value_or(policy::Liveliness{});
  // Also where the profile is the live one, of topics whose own writers need only their latest sample.
  if (delivery == Delivery::lossless) writer_qos << policy::History::keep_all() << policy::Lifespan{};
  join_partition(writer_qos, participant);
  return SerializedWriter(participant, topic, writer_qos);
}

template <std::size_t Size>
using UnsignedOf = std::conditional_t<
    Size == 8, std::uint64_t,
    std::conditional_t<Size == 4, std::uint32_t, std::conditional_t<Size == 2, std::uint16_t, std::uint8_t>>>;

/// Reads over a value of a final type. `on_number(name, value, raw)` is called for each number with the name
/// of its field, an instance of its type, and its bits. False at the first sequence, and if bytes are
/// missing.
template <class Value, class OnNumber>
bool walk(CdrCursor& cursor, const char* name, const Value& value, const OnNumber& on_number) {
  if constexpr (std::is_array_v<Value> && std::is_same_v<std::remove_extent_t<Value>, char>) {
    cursor.read_string();
    return cursor.is_good();
  } else if constexpr (std::is_array_v<Value>) {
    return std::all_of(std::begin(value), std::end(value),
                       [&](const auto& element) { return walk(cursor, name, element, on_number); });
  } else if constexpr (std::is_arithmetic_v<Value>) {
    const auto raw = cursor.read<UnsignedOf<sizeof(Value)>>();
    if (cursor.is_good()) on_number(name, value, raw);
    return cursor.is_good();
  } else if constexpr (requires { value._buffer; }) {
    return false;
  } else {
    bool goes_on = true;
    idl::visit_fields(value, [&](const char* field_name, const auto& field) {
      goes_on = goes_on && walk(cursor, field_name, field, on_number);
    });
    return goes_on;
  }
}

/// In the IDL, every signed number of 64 bits is a time. No time follows a sequence.
template <std::size_t I>
bool shift_times_of(std::span<std::byte> sample, TimeNs shift_ns) {
  using T = typename std::tuple_element_t<I, std::remove_const_t<decltype(all)>>::Type;
  CdrCursor cursor(sample);
  walk(cursor, "", T{}, [&]<class Number>(const char* /*name*/, Number /*value*/, std::uint64_t raw) {
    if constexpr (std::is_same_v<Number, std::int64_t>) {
      const TimeNs moved = saturated_sum(std::bit_cast<std::int64_t>(raw), shift_ns);
      auto bytes = std::bit_cast<std::array<std::byte, sizeof(TimeNs)>>(moved);
      const bool is_native = cursor.is_little_endian() == (std::endian::native == std::endian::little);
      if (!is_native) std::reverse(bytes.begin(), bytes.end());
      const auto place = sample.subspan(cursor.offset_of_last(), bytes.size());
      std::copy(bytes.begin(), bytes.end(), place.begin());
    }
  });
  return cursor.is_good();
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
bool is_exclusive_of(const qos::Provider& qos) {
  const auto ownership = qos.datareader_qos(std::get<I>(all).profile).template policy<policy::Ownership>();
  return ownership.value_or(policy::Ownership{}).kind == policy::OwnershipKind::exclusive;
}

template <std::size_t I>
SerializedTopic row() {
  constexpr auto entry = std::get<I>(all);
  using T = typename decltype(entry)::Type;
  constexpr bool has_beacon = requires(const T& sample) {
    sample.address;
  };
  const dds_topic_descriptor_t& type = TopicTraits<T>::descriptor();
  return {.name = entry.name,
          .type_name = type.m_typename,
          .has_beacon = has_beacon,
          .has_beacon_key = has_beacon && type.m_nkeys == 1,
          .make_reader = make_reader_of<I>,
          .make_writer = make_writer_of<I>,
          .shift_times = shift_times_of<I>,
          .key_fields = key_fields_of<I>,
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

std::uint32_t status_of_pose(std::span<const std::byte> sample) {
  CdrCursor cursor(sample);
  std::uint32_t status = 0;
  walk(cursor, "", sonopose_FusedPose{}, [&](const char* name, auto /*value*/, std::uint64_t raw) {
    if (std::string_view(name) == "status") status = static_cast<std::uint32_t>(raw);
  });
  return status;
}

std::optional<BeaconAddress> beacon_of(std::span<const std::byte> sample) {
  CdrCursor cursor(sample);
  const auto address = cursor.read<std::uint16_t>();
  return cursor.is_good() ? std::optional<BeaconAddress>(address) : std::nullopt;
}

std::optional<std::uint64_t> event_sequence_of(std::span<const std::byte> sample) {
  CdrCursor cursor(sample);
  cursor.read<std::uint16_t>();  // the beacon
  const auto number = cursor.read<std::uint64_t>();
  return cursor.is_good() ? std::optional(number) : std::nullopt;
}

}  // namespace sonopose::dds::topics
