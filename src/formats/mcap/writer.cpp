#include "mcap/writer.hpp"

#include "mcap/decoder.hpp"
#include "mcap/encoder.hpp"

#include <algorithm>
#include <exception>
#include <stdexcept>

namespace sonopose::mcap {

namespace {

/// Space kept free on a full disk, so that a program can still note how its recording ended.
constexpr std::uint64_t reserve_bytes = 64U << 10U;

constexpr std::size_t data_end_bytes = record_prefix_bytes + 4;
constexpr std::size_t summary_offset_bytes = record_prefix_bytes + 1 + 8 + 8;
constexpr std::size_t groups = 5;  // without that of attachments, which is rare
/// Size of a channel's entry in the statistics.
constexpr std::size_t channel_count_bytes = 2 + 8;

void put_schema(Bytes& to, const Schema& schema) {
  put_record(to, Opcode::schema, [&] {
    put(to, schema.id);
    put_text(to, schema.name);
    put_text(to, schema.encoding);
    put_text(to, schema.data);
  });
}

void put_channel(Bytes& to, const Channel& channel) {
  put_record(to, Opcode::channel, [&] {
    put(to, channel.id);
    put(to, channel.schema_id);
    put_text(to, channel.topic);
    put_text(to, channel.message_encoding);
    put_map(to, channel.metadata);
  });
}

void put_data_end(Bytes& to, std::uint32_t crc) {
  put_record(to, Opcode::data_end, [&] { put(to, crc); });
}

/// Appends the footer. Its checksum covers `to` from `summary_at` on.
void put_footer(Bytes& to, std::size_t summary_at, std::uint64_t summary_start, std::uint64_t offset_start) {
  put_record(to, Opcode::footer, [&] {
    put(to, summary_start);
    put(to, offset_start);
    // The length is normally set after the content, but the checksum covers it.
    store(to.data() + to.size() - 16 - sizeof(std::uint64_t),
          std::uint64_t{footer_bytes - record_prefix_bytes});
    put(to, summary_start == 0 ? 0 : crc32(std::span(to).subspan(summary_at)));
  });
  put_bytes(to, std::as_bytes(std::span(magic)));
}

/// Returns the id after the last one.
template <class Items>
std::uint16_t next_id(const Items& items, const char* what) {
  if (items.size() == std::numeric_limits<std::uint16_t>::max()) {
    throw std::invalid_argument(std::string("a file has at most 65535 ") + what);
  }
  return static_cast<std::uint16_t>(items.size() + 1);
}

}  // namespace

Writer::Writer(ByteSink& sink, WriterOptions options)
    : sink_{sink}, chunk_size_bytes_{options.chunk_size_bytes}, compressor_{options.compression} {
  Bytes start;
  put_bytes(start, std::as_bytes(std::span(magic)));
  put_record(start, Opcode::header, [&] {
    put_text(start, options.profile);
    put_text(start, options.library);
  });
  append(start);
}

Writer::~Writer() {
  try {
    close();
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch)
  }
}

void Writer::require_open() const {
  if (is_closed_) throw std::logic_error("the MCAP file is closed");
}

void Writer::append(std::span<const std::byte> bytes) {
  sink_.append(bytes);
  bytes_written_ += bytes.size();
  data_crc_ = crc32(bytes, data_crc_);
}

void Writer::reserve(std::uint64_t record_bytes, std::uint64_t more_closing_bytes) {
  sink_.reserve(record_bytes + closing_bytes() + more_closing_bytes + reserve_bytes);
}

std::uint16_t Writer::add_schema(std::string_view name, std::string_view encoding, std::string_view data) {
  require_open();
  const auto known = std::find_if(schemas_.begin(), schemas_.end(), [&](const Schema& schema) {
    return schema.name == name && schema.encoding == encoding && schema.data == data;
  });
  if (known != schemas_.end()) return known->id;
  const Schema schema{next_id(schemas_, "schemas"), std::string(name), std::string(encoding),
                      std::string(data)};
  Bytes record;
  put_schema(record, schema);
  reserve(record.size(), record.size());
  append(record);
  schemas_.push_back(schema);
  put_bytes(schema_group_.records, record);
  ++statistics_.schema_count;
  return schema.id;
}

std::uint16_t Writer::add_channel(std::uint16_t schema_id, std::string_view topic,
                                  std::string_view message_encoding, const TextMap& metadata) {
  require_open();
  if (schema_id > schemas_.size()) {
    throw std::invalid_argument("channel " + std::string(topic) + ": no schema " + std::to_string(schema_id));
  }
  const auto known = std::find_if(channels_.begin(), channels_.end(), [&](const Channel& channel) {
    return channel.topic == topic && channel.schema_id == schema_id &&
           channel.message_encoding == message_encoding && channel.metadata == metadata;
  });
  if (known != channels_.end()) return known->id;
  const Channel channel{next_id(channels_, "channels"), schema_id, std::string(topic),
                        std::string(message_encoding), metadata};
  Bytes record;
  put_channel(record, channel);
  reserve(record.size(), record.size() + channel_count_bytes);
  append(record);
  channels_.push_back(channel);
  put_bytes(channel_group_.records, record);
  ++statistics_.channel_count;
  return channel.id;
}

void Writer::write(const Message& message, std::span<const std::byte> head) {
  require_open();
  if (message.channel_id == 0 || message.channel_id > channels_.size()) {
    throw std::invalid_argument("no channel " + std::to_string(message.channel_id));
  }
  current_.add(message, head);
  if (current_.records().size() >= chunk_size_bytes_) end_chunk();
}

void Writer::write(const Chunk& chunk) {
  end_chunk();
  require_channels(chunk);
  append_chunk(chunk);
}

void Writer::end_chunk() {
  require_open();
  if (current_.is_empty()) return;
  try {
    append_chunk(current_);
  } catch (...) {
    current_.clear();
    throw;
  }
  current_.clear();
}

void Writer::require_channels(const Chunk& chunk) const {
  for (const Chunk::Entry& entry : chunk.entries()) {
    if (entry.channel_id != 0 && entry.channel_id <= channels_.size()) continue;
    throw std::invalid_argument("no channel " + std::to_string(entry.channel_id));
  }
}

void Writer::append_chunk(const Chunk& chunk) {
  if (chunk.is_empty()) return;
  try {
    const std::uint64_t compressed_size = build_chunk(chunk);
    const Bytes index = build_index(chunk, compressed_size);
    reserve(block_.size(), index.size());
    append(block_);
    put_bytes(chunk_index_group_.records, index);
  } catch (...) {
    lost_messages_ += chunk.message_count();
    throw;
  }
  ++statistics_.chunk_count;
  statistics_.message_count += chunk.message_count();
  statistics_.log_times.include(chunk.log_times());
  for (const Chunk::Entry& entry : chunk.entries()) ++statistics_.channel_message_counts[entry.channel_id];
}

std::uint64_t Writer::build_chunk(const Chunk& chunk) {
  block_.clear();
  std::uint64_t compressed_size = 0;
  put_record(block_, Opcode::chunk, [&] {
    put_times(block_, chunk.log_times());
    put(block_, std::uint64_t{chunk.records().size()});
    put(block_, crc32(chunk.records()));
    put_text(block_, name_of(compressor_.compression()));
    const std::size_t size_at = block_.size();
    put(block_, std::uint64_t{0});
    const std::size_t records_at = block_.size();
    block_.resize(records_at + compressor_.bound(chunk.records().size()));
    compressed_size = compressor_.compress(chunk.records(), std::span(block_).subspan(records_at));
    block_.resize(records_at + compressed_size);
    store(block_.data() + size_at, compressed_size);
  });
  return compressed_size;
}

std::vector<std::byte> Writer::build_index(const Chunk& chunk, std::uint64_t compressed_size) {
  const std::uint64_t chunk_length = block_.size();
  std::map<std::uint16_t, std::vector<const Chunk::Entry*>> channels;
  for (const Chunk::Entry& entry : chunk.entries()) channels[entry.channel_id].push_back(&entry);
  std::map<std::uint16_t, std::uint64_t> offsets;
  for (const auto& [channel_id, entries] : channels) {
    offsets[channel_id] = bytes_written_ + block_.size();
    put_record(block_, Opcode::message_index, [&, id = channel_id, &of_channel = entries] {
      put(block_, id);
      put_sized(block_, [&] {
        for (const Chunk::Entry* entry : of_channel) {
          put(block_, entry->log_time_ns);
          put(block_, entry->offset);
        }
      });
    });
  }
  Bytes record;
  put_record(record, Opcode::chunk_index, [&] {
    put_times(record, chunk.log_times());
    put(record, bytes_written_);
    put(record, chunk_length);
    put_sized(record, [&] {
      for (const auto& [channel_id, offset] : offsets) {
        put(record, channel_id);
        put(record, offset);
      }
    });
    put(record, std::uint64_t{block_.size()} - chunk_length);
    put_text(record, name_of(compressor_.compression()));
    put(record, compressed_size);
    put(record, std::uint64_t{chunk.records().size()});
  });
  return record;
}

void Writer::write_metadata(const Metadata& metadata) {
  append_metadata(metadata, false);
}

void Writer::write_last_metadata(const Metadata& metadata) {
  append_metadata(metadata, true);
}

void Writer::append_metadata(const Metadata& metadata, bool is_last) {
  require_open();
  Bytes record;
  put_record(record, Opcode::metadata, [&] {
    put_text(record, metadata.name);
    put_map(record, metadata.values);
  });
  Bytes index;
  put_record(index, Opcode::metadata_index, [&] {
    put(index, bytes_written_);
    put(index, std::uint64_t{record.size()});
    put_text(index, metadata.name);
  });
  if (!is_last) reserve(record.size(), index.size());
  append(record);
  ++statistics_.metadata_count;
  put_bytes(metadata_index_group_.records, index);
}

void Writer::write_attachment(std::span<const std::byte> content) {
  require_open();
  const AttachmentFields fields =
      decode_attachment(Fields(content, Opcode::attachment, {"attachment", 0, {}}));
  Bytes record;
  put_record(record, Opcode::attachment, [&] { put_bytes(record, content); });
  Bytes index;
  put_record(index, Opcode::attachment_index, [&] {
    put(index, bytes_written_);
    put(index, std::uint64_t{record.size()});
    put(index, fields.log_time_ns);
    put(index, fields.create_time_ns);
    put(index, fields.data_size);
    put_text(index, fields.name);
    put_text(index, fields.media_type);
  });
  reserve(record.size(), index.size() + summary_offset_bytes);
  append(record);
  ++statistics_.attachment_count;
  put_bytes(attachment_index_group_.records, index);
}

std::vector<std::byte> Writer::statistics_record() const {
  Bytes record;
  put_record(record, Opcode::statistics, [&] {
    put(record, statistics_.message_count);
    put(record, statistics_.schema_count);
    put(record, statistics_.channel_count);
    put(record, statistics_.attachment_count);
    put(record, statistics_.metadata_count);
    put(record, statistics_.chunk_count);
    put_times(record, statistics_.log_times);
    put_sized(record, [&] {
      for (const auto& [channel_id, count] : statistics_.channel_message_counts) {
        put(record, channel_id);
        put(record, count);
      }
    });
  });
  return record;
}

std::uint64_t Writer::closing_bytes() const {
  // A channel without messages has no count in the statistics yet.
  const std::size_t counts =
      channel_count_bytes * (channels_.size() - statistics_.channel_message_counts.size()) +
      statistics_record().size();
  return data_end_bytes + schema_group_.records.size() + channel_group_.records.size() +
         chunk_index_group_.records.size() + metadata_index_group_.records.size() +
         attachment_index_group_.records.size() + counts +
         (groups + (statistics_.attachment_count > 0 ? 1 : 0)) * summary_offset_bytes + footer_bytes +
         magic.size();
}

std::uint64_t Writer::max_bytes_of(const Chunk& chunk) const {
  constexpr std::uint64_t bytes_of_records = 256;  // Chunk and ChunkIndex without their variable parts
  constexpr std::uint64_t bytes_of_channel = record_prefix_bytes + 2 + 4 + 2 + 8;
  constexpr std::uint64_t bytes_of_place = 8 + 8;
  return compressor_.bound(chunk.records().size()) + bytes_of_records + channels_.size() * bytes_of_channel +
         chunk.message_count() * bytes_of_place;
}

std::vector<std::byte> Writer::summary() const {
  Bytes end;
  put_data_end(end, data_crc_);
  const std::size_t summary_at = end.size();
  const Group statistics{Opcode::statistics, statistics_record()};
  Bytes offsets;
  for (const Group* group : {&schema_group_, &channel_group_, &statistics, &chunk_index_group_,
                             &metadata_index_group_, &attachment_index_group_}) {
    if (group->records.empty()) continue;
    put_record(offsets, Opcode::summary_offset, [&] {
      put(offsets, static_cast<std::uint8_t>(group->opcode));
      put(offsets, bytes_written_ + end.size());
      put(offsets, std::uint64_t{group->records.size()});
    });
    put_bytes(end, group->records);
  }
  const std::uint64_t offset_start = bytes_written_ + end.size();
  put_bytes(end, offsets);
  put_footer(end, summary_at, bytes_written_ + summary_at, offset_start);
  return end;
}

void Writer::close() {
  if (is_closed_) return;
  std::exception_ptr first_error;
  try {
    end_chunk();
  } catch (...) {
    first_error = std::current_exception();
  }
  is_closed_ = true;
  const Bytes end = summary();
  try {
    append(end);
  } catch (...) {
    if (!first_error) first_error = std::current_exception();
    Bytes ending;
    put_data_end(ending, data_crc_);
    put_footer(ending, 0, 0, 0);
    try {
      append(ending);
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): the first error says why
    }
  }
  if (first_error) std::rethrow_exception(first_error);
}

}  // namespace sonopose::mcap
