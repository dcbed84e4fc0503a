#pragma once
// Messages of the recorder's tests.

#include "mcap/reader.hpp"

#include <catch2/catch.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sonopose::recorder::test {

/// A message that owns its data.
struct OwnedMessage {
  std::string topic;
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0;
  std::uint64_t publish_time_ns = 0;
  std::vector<std::byte> data;

  [[nodiscard]] std::string text() const {
    return {reinterpret_cast<const char*>(data.data()), data.size()};  // NOLINT(*-reinterpret-cast): text
  }
  bool operator==(const OwnedMessage&) const = default;
};

/// All messages of a file, ordered by log time.
inline std::vector<OwnedMessage> messages_of(const std::filesystem::path& file) {
  const mcap::Reader reader(file);
  mcap::Messages messages(reader);
  std::vector<OwnedMessage> found;
  while (const auto message = messages.next()) {
    found.push_back({reader.channels().at(message->channel_id).topic,
                     message->sequence,
                     message->log_time_ns,
                     message->publish_time_ns,
                     {message->data.begin(), message->data.end()}});
  }
  return found;
}

inline std::vector<OwnedMessage> of_topic(const std::vector<OwnedMessage>& messages,
                                          const std::string& topic) {
  std::vector<OwnedMessage> found;
  std::copy_if(messages.begin(), messages.end(), std::back_inserter(found),
               [&](const OwnedMessage& message) { return message.topic == topic; });
  return found;
}

/// The last metadata record with this name.
inline mcap::TextMap metadata_of(const std::filesystem::path& file, const std::string& name) {
  mcap::TextMap found;
  for (const mcap::Metadata& metadata : mcap::Reader(file).metadata()) {
    if (metadata.name == name) found = metadata.values;
  }
  return found;
}

/// The little-endian CDR of a reset command: the smallest native type.
inline std::vector<std::byte> command_cdr(std::uint16_t address, std::uint64_t id) {
  std::vector<std::byte> bytes{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  const auto put = [&bytes](std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
  };
  put(address, 2);
  put(0, 6);
  put(id, 8);
  return bytes;
}

}  // namespace sonopose::recorder::test
