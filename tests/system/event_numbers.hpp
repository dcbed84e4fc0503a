#pragma once
/// \file
/// Event numbers in a recording, and those that a reader received.

#include "recorder/messages.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace sonopose::test {

/// Little-endian 8-byte number at `offset` of the CDR.
inline std::uint64_t number_at(const recorder::test::OwnedMessage& message, std::size_t offset) {
  REQUIRE(message.data.size() >= offset + 8);
  std::uint64_t number = 0;
  for (std::size_t i = 8; i-- > 0;)
    number = number << 8U | std::to_integer<std::uint64_t>(message.data[offset + i]);
  return number;
}

/// Event numbers by beacon.
using Numbers = std::map<int, std::vector<std::uint64_t>>;

/// Event numbers of IMU samples, fixes, headings and poses: the second field of their types, aligned to 8.
inline Numbers event_numbers(const std::vector<recorder::test::OwnedMessage>& messages) {
  Numbers numbers;
  for (const auto& message : messages) {
    numbers[dds::topics::beacon_of(message.data).value_or(0)].push_back(number_at(message, 4 + 8));
  }
  return numbers;
}

template <class Sample>
Numbers event_numbers(const std::vector<Sample>& samples) {
  Numbers numbers;
  for (const Sample& sample : samples) numbers[sample.address].push_back(sample.sequence);
  return numbers;
}

}  // namespace sonopose::test
