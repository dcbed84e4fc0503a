#include "mcap/record_file.hpp"

#include "mcap/compression.hpp"
#include "mcap/decompression.hpp"
#include <sonopose/text/escaped.hpp>

namespace sonopose::mcap {

namespace {

/// The records of a chunk, or a run of records of the file.
class BlockWalk {
public:
  BlockWalk(LoadedBlock& block, Place start, bool is_cut, Definitions* definitions)
      : block_{block}, start_{start}, is_cut_{is_cut}, definitions_{definitions} {}

  void walk() {
    const std::span<const std::byte> bytes = block_.records;
    std::size_t at = 0;
    while (at < bytes.size()) {
      Place place = start_;
      place.offset += at;
      const auto rest = bytes.subspan(at);
      if (is_cut_ && is_beyond(rest)) return;
      if (rest.size() < record_prefix_bytes) {
        place.fail("a record needs 9 bytes, but only " + std::to_string(rest.size()) + " are left");
      }
      const Prefix prefix = decode_prefix(rest.data(), rest.size(), place);
      const std::size_t content_at = at + record_prefix_bytes;
      visit(prefix, content_at, place);
      at = content_at + static_cast<std::size_t>(prefix.length);
    }
  }

private:
  static bool is_beyond(std::span<const std::byte> rest) {
    return rest.size() < record_prefix_bytes ||
           load<std::uint64_t>(rest.data() + 1) > rest.size() - record_prefix_bytes;
  }

  void visit(const Prefix& prefix, std::size_t content_at, const Place& place) {
    const auto length = static_cast<std::size_t>(prefix.length);
    Fields fields(std::span(block_.records).subspan(content_at, length), prefix.opcode, place);
    switch (prefix.opcode) {
      case Opcode::message: {
        const Message message = decode_message(fields);
        block_.messages.push_back({message.log_time_ns, static_cast<std::uint32_t>(content_at),
                                   static_cast<std::uint32_t>(length), message.channel_id});
        break;
      }
      case Opcode::schema:
        if (definitions_ != nullptr) definitions_->on(decode_schema(fields), place);
        break;
      case Opcode::channel:
        if (definitions_ != nullptr) add_channel(fields, place);
        break;
      default:
        if (start_.chunk_offset && prefix.opcode <= Opcode::data_end) {
          place.fail(std::string(name_of(prefix.opcode)) + " inside of a chunk");
        }
    }
  }

  void add_channel(Fields fields, const Place& place) {
    definitions_->on(decode_channel(fields), place);
    if (const auto damage = fields.repeated_key()) definitions_->on_damage(*damage);
  }

  LoadedBlock& block_;
  Place start_;
  bool is_cut_;
  Definitions* definitions_;  ///< null: not wanted
};

void check_decompressed(Decompressed result, const ChunkFields& chunk, std::span<const std::byte> records,
                        const Fields& fields) {
  if (result != Decompressed::complete) {
    fields.fail("records", "are not a complete stream of " + chunk.compression);
  }
  if (records.size() != chunk.uncompressed_size) {
    fields.fail("uncompressed_size", "is " + std::to_string(chunk.uncompressed_size) + ", but there are " +
                                         std::to_string(records.size()) + " bytes");
  }
  if (chunk.uncompressed_crc != 0 && chunk.uncompressed_crc != crc32(records)) {
    fields.fail("uncompressed_crc", "does not match the records");
  }
}

}  // namespace

Message LoadedBlock::message(const Item& item) const {
  Message message =
      decode_message(Fields(std::span(records).subspan(item.offset, item.size), Opcode::message, Place{}));
  message.channel_id = item.channel_id;
  return message;
}

Bytes RecordFile::bytes(std::uint64_t offset, std::uint64_t count) const {
  if (offset > size() || count > size() - offset) {
    place(offset).fail("needs " + std::to_string(count) + " bytes, but the file ends at byte " +
                       std::to_string(size()));
  }
  if (count > max_record_bytes) {
    place(offset).fail("a record of " + std::to_string(count) + " bytes, the limit is " +
                       std::to_string(max_record_bytes));
  }
  Bytes bytes(static_cast<std::size_t>(count));
  source_->read(offset, bytes);
  return bytes;
}

Prefix RecordFile::prefix(std::uint64_t offset, std::uint64_t end) const {
  if (end < record_prefix_bytes || offset > end - record_prefix_bytes) {
    place(offset).fail("a record needs 9 bytes, but only " + std::to_string(end - offset) + " are left");
  }
  std::array<std::byte, record_prefix_bytes> bytes{};
  source_->read(offset, bytes);
  return decode_prefix(bytes.data(), end - offset, place(offset));
}

Bytes RecordFile::content(const Extent& record, Opcode opcode) const {
  if (record.offset > size()) place(record.offset).fail("is behind the end of the file");
  const std::uint64_t found = prefix(record.offset, size()).record_length();
  if (found != record.length) {
    place(record.offset)
        .fail("the length is " + std::to_string(found) + " with the prefix, but its index says " +
              std::to_string(record.length));
  }
  return content(record.offset, opcode);
}

Bytes RecordFile::content(std::uint64_t offset, Opcode opcode) const {
  if (offset > size()) place(offset).fail("is behind the end of the file");
  const Prefix found = prefix(offset, size());
  if (found.opcode != opcode) {
    place(offset).fail("opcode is " + std::to_string(static_cast<int>(found.opcode)) + " instead of " +
                       std::string(name_of(opcode)));
  }
  return bytes(offset + record_prefix_bytes, found.length);
}

LoadedBlock RecordFile::load(const Block& block, Definitions* definitions) const {
  if (block.kind != Block::Kind::plain) return load_chunk(block, definitions);
  LoadedBlock loaded;
  loaded.records = bytes(block.offset, block.length);
  BlockWalk(loaded, place(block.offset), false, definitions).walk();
  return loaded;
}

LoadedBlock RecordFile::load_chunk(const Block& block, Definitions* definitions) const {
  const bool is_cut = block.kind == Block::Kind::cut;
  const Place at = place(block.offset);
  const Bytes record = is_cut ? bytes(block.offset + record_prefix_bytes, block.length - record_prefix_bytes)
                              : content(Extent{block.offset, block.length}, Opcode::chunk);
  Fields fields(record, Opcode::chunk, at);
  const ChunkFields chunk = decode_chunk(fields);
  const auto compression = compression_named(chunk.compression);
  if (!compression)
    fields.fail("compression", "is \"" + text::escaped(chunk.compression) + "\"; known: lz4, zstd, none");
  if (chunk.uncompressed_size > max_chunk_bytes) {
    fields.fail("uncompressed_size", "is " + std::to_string(chunk.uncompressed_size) + ", the limit is " +
                                         std::to_string(max_chunk_bytes));
  }
  const auto compressed = is_cut ? fields.rest() : fields.take(chunk.compressed_size, "records");
  LoadedBlock loaded;
  const Decompressed result =
      decompress(*compression, compressed, static_cast<std::size_t>(chunk.uncompressed_size), loaded.records);
  const auto count = [&] { expansion_.add(at, size(), loaded.records.size(), loaded.messages.size()); };
  try {
    if (!is_cut) check_decompressed(result, chunk, loaded.records, fields);
    BlockWalk(loaded, {name(), 0, block.offset}, is_cut, definitions).walk();
  } catch (const FormatError&) {
    count();  // damaged chunks take their time too
    throw;
  }
  count();
  return loaded;
}

}  // namespace sonopose::mcap
