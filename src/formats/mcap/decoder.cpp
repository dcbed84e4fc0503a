#include "mcap/decoder.hpp"

namespace sonopose::mcap {

std::string Place::text() const {
  std::string text = std::string(file) + ": byte " + std::to_string(offset);
  if (chunk_offset) text += " of the chunk at byte " + std::to_string(*chunk_offset);
  return text;
}

void Place::fail(const std::string& what) const {
  throw FormatError(text() + ": " + what);
}

std::string_view name_of(Opcode opcode) {
  constexpr std::array<std::string_view, 16> names{
      "record",   "Header",        "Footer",        "Schema",     "Channel",         "Message",
      "Chunk",    "MessageIndex",  "ChunkIndex",    "Attachment", "AttachmentIndex", "Statistics",
      "Metadata", "MetadataIndex", "SummaryOffset", "DataEnd"};
  const auto number = static_cast<std::size_t>(opcode);
  return number < names.size() ? names[number] : names[0];
}

Prefix decode_prefix(const std::byte* bytes, std::uint64_t available, const Place& place) {
  const Prefix prefix{static_cast<Opcode>(load<std::uint8_t>(bytes)), load<std::uint64_t>(bytes + 1)};
  if (prefix.opcode == Opcode{}) place.fail("opcode 0 is not a record");
  const std::uint64_t limit = available - record_prefix_bytes;
  if (prefix.length > limit) {
    place.fail(std::string(name_of(prefix.opcode)) + " length is " + std::to_string(prefix.length) +
               ", but only " + std::to_string(limit) + " bytes follow");
  }
  return prefix;
}

void Fields::fail(std::string_view field, const std::string& what) const {
  place_.fail(std::string(name_of(opcode_)) + " " + std::string(field) + " " + what);
}

std::span<const std::byte> Fields::take(std::uint64_t count, std::string_view field) {
  if (count > rest_.size()) {
    fail(field, "needs " + std::to_string(count) + " bytes, but only " + std::to_string(rest_.size()) +
                    " are left in the record");
  }
  const auto taken = rest_.first(static_cast<std::size_t>(count));
  rest_ = rest_.subspan(static_cast<std::size_t>(count));
  return taken;
}

std::string Fields::text(std::string_view field) {
  const auto bytes = take(number<std::uint32_t>(field), field);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Fields Fields::sized(std::string_view field) {
  return {take(number<std::uint32_t>(field), field), opcode_, place_};
}

TextMap Fields::map(std::string_view field) {
  TextMap map;
  Fields entries = sized(field);
  while (!entries.is_at_end()) {
    std::string key = entries.text(field);
    std::string value = entries.text(field);
    if (!map.emplace(std::move(key), std::move(value)).second) has_repeated_key_ = true;
    if (map.size() > max_map_entries) {
      fail(field, "has more than " + std::to_string(max_map_entries) + " entries");
    }
  }
  return map;
}

std::optional<std::string> Fields::repeated_key() const {
  if (!has_repeated_key_) return std::nullopt;
  return place_.text() + ": " + std::string(name_of(opcode_)) +
         " metadata has a key twice; its first value is used";
}

void Fields::skip_times() {
  take(sizeof(std::uint64_t), "message_start_time");
  take(sizeof(std::uint64_t), "message_end_time");
}

Header decode_header(Fields fields) {
  Header header;
  header.profile = fields.text("profile");
  header.library = fields.text("library");
  return header;
}

Footer decode_footer(Fields fields) {
  Footer footer;
  footer.summary_start = fields.number<std::uint64_t>("summary_start");
  fields.number<std::uint64_t>("summary_offset_start");  // not used
  footer.summary_crc = fields.number<std::uint32_t>("summary_crc");
  return footer;
}

Schema decode_schema(Fields fields) {
  Schema schema;
  schema.id = fields.number<std::uint16_t>("id");
  schema.name = fields.text("name");
  schema.encoding = fields.text("encoding");
  schema.data = fields.text("data");
  return schema;
}

Channel decode_channel(Fields& fields) {
  Channel channel;
  channel.id = fields.number<std::uint16_t>("id");
  channel.schema_id = fields.number<std::uint16_t>("schema_id");
  channel.topic = fields.text("topic");
  channel.message_encoding = fields.text("message_encoding");
  channel.metadata = fields.map("metadata");
  return channel;
}

Message decode_message(Fields fields) {
  Message message;
  message.channel_id = fields.number<std::uint16_t>("channel_id");
  message.sequence = fields.number<std::uint32_t>("sequence");
  message.log_time_ns = fields.number<std::uint64_t>("log_time");
  message.publish_time_ns = fields.number<std::uint64_t>("publish_time");
  message.data = fields.rest();
  return message;
}

ChunkFields decode_chunk(Fields& fields) {
  ChunkFields chunk;
  fields.skip_times();
  chunk.uncompressed_size = fields.number<std::uint64_t>("uncompressed_size");
  chunk.uncompressed_crc = fields.number<std::uint32_t>("uncompressed_crc");
  chunk.compression = fields.text("compression");
  chunk.compressed_size = fields.number<std::uint64_t>("records");
  return chunk;
}

Extent decode_chunk_index(Fields fields) {
  fields.skip_times();
  Extent chunk;
  chunk.offset = fields.number<std::uint64_t>("chunk_start_offset");
  chunk.length = fields.number<std::uint64_t>("chunk_length");
  return chunk;
}

MessageIndex decode_message_index(Fields fields) {
  MessageIndex index;
  index.channel_id = fields.number<std::uint16_t>("channel_id");
  Fields records = fields.sized("records");
  while (!records.is_at_end()) {
    index.log_times_ns.push_back(records.number<std::uint64_t>("records"));
    records.number<std::uint64_t>("records");  // the place in the chunk
  }
  return index;
}

Statistics decode_statistics(Fields fields) {
  Statistics statistics;
  statistics.message_count = fields.number<std::uint64_t>("message_count");
  statistics.schema_count = fields.number<std::uint16_t>("schema_count");
  statistics.channel_count = fields.number<std::uint32_t>("channel_count");
  statistics.attachment_count = fields.number<std::uint32_t>("attachment_count");
  statistics.metadata_count = fields.number<std::uint32_t>("metadata_count");
  statistics.chunk_count = fields.number<std::uint32_t>("chunk_count");
  fields.skip_times();
  Fields counts = fields.sized("channel_message_counts");
  while (!counts.is_at_end()) {
    const auto channel_id = counts.number<std::uint16_t>("channel_message_counts");
    statistics.channel_message_counts[channel_id] = counts.number<std::uint64_t>("channel_message_counts");
  }
  return statistics;
}

Metadata decode_metadata(Fields& fields) {
  Metadata metadata;
  metadata.name = fields.text("name");
  metadata.values = fields.map("metadata");
  return metadata;
}

AttachmentFields decode_attachment(Fields fields) {
  const std::size_t length = fields.rest().size();
  AttachmentFields attachment;
  attachment.log_time_ns = fields.number<std::uint64_t>("log_time");
  attachment.create_time_ns = fields.number<std::uint64_t>("create_time");
  attachment.name = fields.text("name");
  attachment.media_type = fields.text("media_type");
  attachment.data_size = fields.number<std::uint64_t>("data");
  fields.take(attachment.data_size, "data");
  attachment.crc_at = length - fields.rest().size();
  attachment.crc = fields.number<std::uint32_t>("crc");
  return attachment;
}

Extent decode_record_index(Fields fields) {
  Extent record;
  record.offset = fields.number<std::uint64_t>("offset");
  record.length = fields.number<std::uint64_t>("length");
  return record;
}

namespace {

std::uint64_t memory_of(const TextMap& map) {
  constexpr std::uint64_t tree_node_bytes = 32;
  std::uint64_t bytes = 0;
  for (const auto& entry : map) {
    bytes += tree_node_bytes + sizeof entry + entry.first.size() + entry.second.size();
  }
  return bytes;
}

}  // namespace

std::uint64_t memory_of(const Schema& schema) {
  return sizeof schema + schema.name.size() + schema.encoding.size() + schema.data.size();
}

std::uint64_t memory_of(const Channel& channel) {
  return sizeof channel + channel.topic.size() + channel.message_encoding.size() +
         memory_of(channel.metadata);
}

std::uint64_t memory_of(const Metadata& metadata) {
  return sizeof metadata + metadata.name.size() + memory_of(metadata.values);
}

void MemoryLimit::reserve(std::uint64_t bytes, std::string_view what, const Place& place) {
  if (bytes > max_bytes - bytes_) {
    place.fail(std::string(what) + " more than " + std::to_string(max_bytes) + " bytes");
  }
  bytes_ += bytes;
}

}  // namespace sonopose::mcap
