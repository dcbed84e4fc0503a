#pragma once
/// \file
/// Accesses fields of serialized samples, by the IDL type T of their topic.

#include "dds/topics/cdr_cursor.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/idl/field_visitors.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <iterator>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace sonopose::dds::topics {

template <std::size_t Size>
using UnsignedOf = std::conditional_t<
    Size == 8, std::uint64_t,
    std::conditional_t<Size == 4, std::uint32_t, std::conditional_t<Size == 2, std::uint16_t, std::uint8_t>>>;

/// Walks over a value of a final type. Calls `on_number(name, value, raw)` for each number with its field
/// name, an instance of its type, and its bits. Returns false at the first sequence, or if bytes are missing.
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

/// Shifts all times of a sample. In the IDL, every signed 64-bit number is a time, and no time follows a
/// sequence.
template <class T>
bool shift_times(std::span<std::byte> sample, TimeNs shift_ns) {
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

/// Returns true if a field is part of the key of T.
template <class T>
bool is_key(std::string_view name) {
  const dds_topic_descriptor_t& type = TopicTraits<T>::descriptor();
  return std::any_of(type.m_keys, type.m_keys + type.m_nkeys,
                     [name](const dds_key_descriptor_t& key) { return name == key.m_name; });
}

template <class T>
std::vector<KeyField> key_fields(std::span<const std::byte> key) {
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

}  // namespace sonopose::dds::topics
