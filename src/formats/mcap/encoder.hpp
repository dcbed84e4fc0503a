#pragma once
/// \file
/// Appends the types of the format to bytes: little-endian, texts and maps with a 32-bit length.

#include "mcap/records.hpp"

#include <bit>
#include <concepts>
#include <cstring>
#include <string_view>
#include <vector>

namespace sonopose::mcap {

using Bytes = std::vector<std::byte>;

template <std::unsigned_integral T>
void store(std::byte* to, T value) {
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(to, &value, sizeof value);
  } else {
    for (std::size_t i = 0; i < sizeof value; ++i) {
      to[i] = static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8 * i));
    }
  }
}

template <std::unsigned_integral T>
void put(Bytes& to, T value) {
  to.resize(to.size() + sizeof value);
  store(to.data() + to.size() - sizeof value, value);
}

inline void put_bytes(Bytes& to, std::span<const std::byte> bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

inline void put_text(Bytes& to, std::string_view text) {
  put(to, static_cast<std::uint32_t>(text.size()));
  put_bytes(to, std::as_bytes(std::span(text)));
}

/// Appends a record: the prefix with the length of what `content` appends, and that content.
template <class Content>
void put_record(Bytes& to, Opcode opcode, const Content& content) {
  put(to, static_cast<std::uint8_t>(opcode));
  const std::size_t length_at = to.size();
  put(to, std::uint64_t{0});
  content();
  store(to.data() + length_at, std::uint64_t{to.size() - length_at - sizeof(std::uint64_t)});
}

/// Appends a map or array: the length in bytes of what `content` appends, and that content.
template <class Content>
void put_sized(Bytes& to, const Content& content) {
  const std::size_t length_at = to.size();
  put(to, std::uint32_t{0});
  content();
  store(to.data() + length_at, static_cast<std::uint32_t>(to.size() - length_at - sizeof(std::uint32_t)));
}

inline void put_map(Bytes& to, const TextMap& map) {
  put_sized(to, [&] {
    for (const auto& [key, value] : map) {
      put_text(to, key);
      put_text(to, value);
    }
  });
}

/// Appends log times. An empty span is written as 0.
inline void put_times(Bytes& to, const TimeSpan& times) {
  put(to, times.is_empty() ? std::uint64_t{0} : times.start_ns);
  put(to, times.end_ns);
}

}  // namespace sonopose::mcap
