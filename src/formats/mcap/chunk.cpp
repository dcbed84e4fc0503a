#include "mcap/chunk.hpp"

#include "mcap/encoder.hpp"

namespace sonopose::mcap {

Chunk::Chunk(std::size_t byte_count, std::size_t message_count) {
  records_.reserve(byte_count);
  entries_.reserve(message_count);
}

void Chunk::add(const Message& message, std::span<const std::byte> head) {
  const std::size_t offset = records_.size();
  entries_.push_back({message.channel_id, message.log_time_ns, offset});
  std::array<std::byte, record_prefix_bytes + message_field_bytes> fields{};
  std::byte* to = fields.data();
  const auto put_next = [&to](auto value) {
    store(to, value);
    to += sizeof value;
  };
  put_next(static_cast<std::uint8_t>(Opcode::message));
  put_next(std::uint64_t{message_field_bytes + head.size() + message.data.size()});
  put_next(message.channel_id);
  put_next(message.sequence);
  put_next(message.log_time_ns);
  put_next(message.publish_time_ns);
  put_bytes(records_, fields);
  put_bytes(records_, head);
  put_bytes(records_, message.data);
  log_times_.include(message.log_time_ns);
}

void Chunk::clear() {
  records_.clear();
  entries_.clear();
  log_times_ = {};
}

}  // namespace sonopose::mcap
