#include "mcap/summary.hpp"

#include "mcap/compression.hpp"
#include "mcap/scan.hpp"

#include <algorithm>
#include <utility>

namespace sonopose::mcap {

namespace {

/// The sections after the data.
class Summary {
public:
  explicit Summary(const RecordFile& file) : file_{file} {}

  SummaryReading read() {
    const Header header = read_header(file_);
    contents_.profile = header.profile;
    contents_.library = header.library;
    contents_.is_indexed = true;
    SummaryReading reading;
    try {
      if (has_all_messages()) reading.contents = std::move(contents_);
    } catch (const FormatError& error) {
      reading.damage = error.what();
    }
    reading.message_count = stated_count_;
    for (const Extent& record : records_) reading.record_offsets.push_back(record.offset);
    std::ranges::sort(reading.record_offsets);
    return reading;
  }

private:
  /// Returns false if the file must be read from start to end instead.
  bool has_all_messages() {
    const Footer footer = read_footer();
    if (footer.summary_start == 0) return false;
    read_records(footer);
    if (!is_sufficient()) return false;
    std::ranges::sort(records_, {}, &Extent::offset);
    require_separate();
    for (std::vector<Extent>* extents : {&contents_.metadata, &contents_.attachments}) {
      std::ranges::sort(*extents, {}, &Extent::offset);
    }
    std::ranges::sort(contents_.blocks, {}, &Block::offset);
    return read_between_records() && has_all_definitions();
  }

  Footer read_footer() {
    const std::uint64_t size = file_.size();
    const std::uint64_t end = magic.size() + footer_bytes;
    if (size < magic.size() + end) file_.place(size).fail("the file ends without a Footer: it was cut");
    if (!std::ranges::equal(file_.bytes(size - magic.size(), magic.size()),
                            std::as_bytes(std::span(magic)))) {
      file_.place(size - magic.size()).fail("the file does not end with the magic bytes: it was cut");
    }
    footer_at_ = size - end;
    const Bytes content = file_.content(footer_at_, Opcode::footer);
    const Footer footer = decode_footer(Fields(content, Opcode::footer, file_.place(footer_at_)));
    if (footer.summary_start > footer_at_) {
      file_.place(footer_at_)
          .fail("Footer summary_start is " + std::to_string(footer.summary_start) + ", the limit is " +
                std::to_string(footer_at_));
    }
    return footer;
  }

  void read_records(const Footer& footer) {
    summary_start_ = footer.summary_start;
    const Bytes section = file_.bytes(summary_start_, footer_at_ - summary_start_);
    if (footer.summary_crc != 0) {
      const Bytes start_of_footer = file_.bytes(footer_at_, footer_bytes - sizeof(std::uint32_t));
      if (crc32(start_of_footer, crc32(section)) != footer.summary_crc) {
        file_.place(footer_at_).fail("Footer summary_crc does not match the summary");
      }
    }
    std::size_t at = 0;
    while (at < section.size()) {
      const Place place = file_.place(summary_start_ + at);
      if (section.size() - at < record_prefix_bytes) place.fail("a record needs 9 bytes");
      const Prefix prefix = decode_prefix(section.data() + at, section.size() - at, place);
      at += record_prefix_bytes;
      const auto length = static_cast<std::size_t>(prefix.length);
      visit(prefix.opcode, Fields(std::span(section).subspan(at, length), prefix.opcode, place), place);
      at += length;
    }
  }

  void visit(Opcode opcode, Fields fields, const Place& place) {
    if (opcode == Opcode::schema) {
      Schema schema = decode_schema(fields);
      memory_.reserve(memory_of(schema), "the schemas and channels take", place);
      if (schema.id != no_schema) contents_.schemas.emplace(schema.id, std::move(schema));
    } else if (opcode == Opcode::channel) {
      Channel channel = decode_channel(fields);
      memory_.reserve(memory_of(channel), "the schemas and channels take", place);
      contents_.channels.emplace(channel.id, std::move(channel));
      if (auto damage = fields.repeated_key()) contents_.add_damage(std::move(*damage));
    } else if (opcode == Opcode::statistics) {
      contents_.statistics = decode_statistics(fields);
      stated_count_ = contents_.statistics.message_count;
    } else if (opcode == Opcode::chunk_index) {
      const Extent chunk = in_data(decode_chunk_index(fields), "chunk_start_offset", fields);
      contents_.blocks.push_back({Block::Kind::chunk, chunk.offset, chunk.length, {}, {}});
    } else if (opcode == Opcode::metadata_index) {
      contents_.metadata.push_back(in_data(decode_record_index(fields), "offset", fields));
    } else if (opcode == Opcode::attachment_index) {
      contents_.attachments.push_back(in_data(decode_record_index(fields), "offset", fields));
    }
  }

  /// Keeps the place of a record that the summary names. Throws FormatError if it is not in the data section.
  Extent in_data(Extent record, std::string_view field, const Fields& fields) {
    if (record.offset < magic.size() || record.offset >= summary_start_ ||
        record.length > summary_start_ - record.offset) {
      fields.fail(field, "is " + std::to_string(record.offset) + " with length " +
                             std::to_string(record.length) + ", but the data end at byte " +
                             std::to_string(summary_start_));
    }
    return records_.emplace_back(record);
  }

  /// Refuses overlapping entries, which would be read twice: a small file could take any time and memory.
  void require_separate() const {
    const auto overlap = std::ranges::adjacent_find(records_, [](const Extent& a, const Extent& b) {
      return b.offset - a.offset < std::max<std::uint64_t>(a.length, record_prefix_bytes);
    });
    if (overlap == records_.end()) return;
    const Extent& next = *std::next(overlap);
    file_.place(summary_start_)
        .fail("the summary has a record at byte " + std::to_string(overlap->offset) + " with length " +
              std::to_string(overlap->length) + ", but another one at byte " + std::to_string(next.offset));
  }

  [[nodiscard]] bool is_sufficient() const {
    const Statistics& statistics = contents_.statistics;
    return stated_count_ && statistics.chunk_count == contents_.blocks.size() &&
           statistics.metadata_count == contents_.metadata.size() &&
           statistics.attachment_count == contents_.attachments.size();
  }

  /// A summary need not repeat the channels and schemas.
  [[nodiscard]] bool has_all_definitions() const {
    const auto is_known = [this](std::uint16_t channel_id) {
      return contents_.channels.contains(channel_id);
    };
    const auto knows_all = [&](const Block& block) { return std::ranges::all_of(block.channels, is_known); };
    const auto has_schema = [this](const auto& channel) {
      const std::uint16_t id = channel.second.schema_id;
      return id == no_schema || contents_.schemas.contains(id);
    };
    return std::ranges::all_of(contents_.blocks, knows_all) &&
           std::ranges::all_of(contents_.channels, has_schema);
  }

  /// Reads the records that the summary does not name. Returns false unless they are indexes of all messages:
  /// the summary has no times of messages without an index, and none of those outside of chunks.
  bool read_between_records() {
    Statistics& statistics = contents_.statistics;
    statistics.channel_message_counts.clear();
    std::uint64_t at = magic.size() + file_.prefix(magic.size(), file_.size()).record_length();
    auto block = contents_.blocks.begin();
    Block* chunk = nullptr;
    for (const Extent& record : records_) {
      if (!read_up_to(record.offset, at, chunk)) return false;
      at = record.offset + record.length;
      if (block != contents_.blocks.end() && block->offset == record.offset) chunk = &*block++;
    }
    if (!read_up_to(summary_start_, at, chunk)) return false;
    std::uint64_t indexed_count = 0;
    for (const auto& [channel_id, count] : statistics.channel_message_counts) indexed_count += count;
    for (Block& each : contents_.blocks) {
      std::ranges::sort(each.channels);
      if (each.log_times.is_empty()) return false;
      statistics.log_times.include(each.log_times);
    }
    return indexed_count == statistics.message_count;
  }

  /// Reads the records up to `end`. Returns false for a message or a chunk that the summary does not name.
  /// Indexes of messages belong to `chunk`, the one before.
  bool read_up_to(std::uint64_t end, std::uint64_t at, Block* chunk) {
    while (at < end) {
      const Prefix prefix = file_.prefix(at, end);
      if (prefix.opcode == Opcode::data_end) return true;
      if (prefix.opcode == Opcode::message || prefix.opcode == Opcode::chunk) return false;
      if (prefix.opcode == Opcode::message_index && chunk != nullptr) add_index(*chunk, at);
      at += prefix.record_length();
    }
    return true;
  }

  void add_index(Block& chunk, std::uint64_t at) {
    const Bytes content = file_.content(at, Opcode::message_index);
    const MessageIndex index = decode_message_index(Fields(content, Opcode::message_index, file_.place(at)));
    if (index.log_times_ns.empty()) return;
    for (const std::uint64_t time_ns : index.log_times_ns) chunk.log_times.include(time_ns);
    chunk.channels.push_back(index.channel_id);
    contents_.statistics.channel_message_counts[index.channel_id] += index.log_times_ns.size();
  }

  const RecordFile& file_;
  Contents contents_;
  std::uint64_t footer_at_ = 0;
  std::uint64_t summary_start_ = 0;
  std::vector<Extent> records_;  ///< records that the summary names
  std::optional<std::uint64_t> stated_count_;
  MemoryLimit memory_;
};

}  // namespace

SummaryReading read_summary(const RecordFile& file) {
  return Summary(file).read();
}

}  // namespace sonopose::mcap
