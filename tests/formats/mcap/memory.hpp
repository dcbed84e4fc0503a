#pragma once
/// \file
/// MCAP files in memory.

#include "mcap/byte_sink.hpp"
#include "mcap/encoder.hpp"
#include "mcap/reader.hpp"

#include <memory>
#include <string>
#include <vector>

namespace sonopose::test {

class MemorySink final : public mcap::ByteSink {
public:
  void append(std::span<const std::byte> bytes) override { mcap::put_bytes(content, bytes); }
  void reserve(std::uint64_t) override {}

  mcap::Bytes content;
};

class MemorySource final : public mcap::ByteSource {
public:
  explicit MemorySource(std::span<const std::byte> bytes) : bytes_(bytes.begin(), bytes.end()) {}

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }
  void read(std::uint64_t offset, std::span<std::byte> to) const override {
    if (offset > bytes_.size() || to.size() > bytes_.size() - offset)
      throw std::out_of_range("beyond the file");
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), to.size(), to.begin());
  }

private:
  std::string name_ = "memory.mcap";
  mcap::Bytes bytes_;
};

inline mcap::Reader reader_of(std::span<const std::byte> bytes) {
  return mcap::Reader(std::make_unique<MemorySource>(bytes));
}

inline std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

inline std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A message that owns its data.
struct OwnMessage {
  std::string topic;
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0;
  std::uint64_t publish_time_ns = 0;
  std::string data;

  bool operator==(const OwnMessage&) const = default;
};

inline std::vector<OwnMessage> messages_of(const mcap::Reader& reader, mcap::Selection selection = {}) {
  std::vector<OwnMessage> all;
  mcap::Messages messages(reader, std::move(selection));
  while (const auto message = messages.next()) {
    all.push_back({reader.channels().at(message->channel_id).topic, message->sequence, message->log_time_ns,
                   message->publish_time_ns, text_of(message->data)});
  }
  return all;
}

}  // namespace sonopose::test
