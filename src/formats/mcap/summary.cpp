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

  std::optional<Contents> read() {
    const Header header = read_header(file_);
    contents_.profile = header.profile;
    contents_.library = header.library;
    contents_.is_indexed = true;
    const Footer footer = read_footer();
    if (footer.summary_start == 0) return std::nullopt;
    read_records(footer);
    if (!is_sufficient()) return std::nullopt;
    std::ranges::sort(contents_.blocks, {}, &Block::offset);
    std::ranges::sort(contents_.metadata, {}, &Extent::offset);
    require_separate();
    if (!has_all_channels() || !read_between_chunks()) return std::nullopt;
    return std::move(contents_);
  }

private:
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
      has_statistics_ = true;
    } else if (opcode == Opcode::chunk_index) {
      add_chunk(decode_chunk_index(fields), fields);
    } else if (opcode == Opcode::metadata_index) {
      const MetadataIndex index = decode_metadata_index(fields);
      require_in_data(index.offset, index.length, "offset", fields);
      contents_.metadata.push_back({index.offset, index.length});
    }
  }

  void require_in_data(std::uint64_t offset, std::uint64_t length, std::string_view field,
                       const Fields& fields) const {
    if (offset >= magic.size() && offset < summary_start_ && length <= summary_start_ - offset) return;
    fields.fail(field, "is " + std::to_string(offset) + " with length " + std::to_string(length) +
                           ", but the data end at byte " + std::to_string(summary_start_));
  }

  void add_chunk(const ChunkIndex& index, const Fields& fields) {
    require_in_data(index.chunk_start_offset, index.chunk_length, "chunk_start_offset", fields);
    Block block{Block::Kind::chunk, index.chunk_start_offset, index.chunk_length, index.log_times, {}};
    for (const auto& [channel_id, offset] : index.message_index_offsets) block.channels.push_back(channel_id);
    contents_.blocks.push_back(std::move(block));
  }

  /// Refuses overlapping entries, which would be read twice: a small file could take any time and memory.
  void require_separate() const {
    std::vector<Extent> extents = contents_.metadata;
    for (const Block& block : contents_.blocks) extents.push_back({block.offset, block.length});
    std::ranges::sort(extents, {}, &Extent::offset);
    const auto overlap = std::ranges::adjacent_find(extents, [](const Extent& a, const Extent& b) {
      return b.offset - a.offset < std::max<std::uint64_t>(a.length, record_prefix_bytes);
    });
    if (overlap == extents.end()) return;
    const Extent& next = *std::next(overlap);
    file_.place(summary_start_)
        .fail("the summary has a record at byte " + std::to_string(overlap->offset) + " with length " +
              std::to_string(overlap->length) + ", but another one at byte " + std::to_string(next.offset));
  }

  /// Returns false if the file must be read from start to end instead.
  [[nodiscard]] bool is_sufficient() const {
    return has_statistics_ && contents_.statistics.chunk_count == contents_.blocks.size() &&
           contents_.statistics.metadata_count == contents_.metadata.size() &&
           (contents_.statistics.message_count == 0 || !contents_.blocks.empty());
  }

  /// A summary need not repeat the channels.
  [[nodiscard]] bool has_all_channels() const {
    const auto is_known = [this](std::uint16_t channel_id) {
      return contents_.channels.contains(channel_id);
    };
    const auto knows_all = [&](const Block& block) { return std::ranges::all_of(block.channels, is_known); };
    return std::ranges::all_of(contents_.blocks, knows_all) &&
           std::ranges::all_of(contents_.statistics.channel_message_counts,
                               [&](const auto& entry) { return is_known(entry.first); });
  }

  /// Reads the records between the chunks. Returns false if there are messages: the summary does not have
  /// them.
  bool read_between_chunks() {
    std::vector<Block>& blocks = contents_.blocks;
    const std::uint64_t data_at = magic.size() + file_.prefix(magic.size(), file_.size()).record_length();
    bool has_messages =
        has_messages_in(data_at, blocks.empty() ? summary_start_ : blocks.front().offset, nullptr);
    for (std::size_t i = 0; i < blocks.size() && !has_messages; ++i) {
      const std::uint64_t end = i + 1 < blocks.size() ? blocks[i + 1].offset : summary_start_;
      has_messages = has_messages_in(blocks[i].offset + blocks[i].length, end, &blocks[i]);
      contents_.statistics.log_times.include(blocks[i].log_times);
    }
    return !has_messages;
  }

  /// Reads the records of a span, up to damage. Indexes of messages belong to the chunk `before`.
  bool has_messages_in(std::uint64_t at, std::uint64_t end, Block* before) {
    try {
      while (at < end) {
        const Prefix prefix = file_.prefix(at, end);
        if (prefix.opcode == Opcode::message) return true;
        if (prefix.opcode == Opcode::data_end) return false;
        if (prefix.opcode == Opcode::message_index && before != nullptr) include_times(*before, at, prefix);
        at += prefix.record_length();
      }
    } catch (const FormatError&) {  // NOLINT(bugprone-empty-catch): the chunks can still be read
    }
    return false;
  }

  /// Widens the times of a chunk: writers have stated wrong ones in its header.
  void include_times(Block& block, std::uint64_t at, const Prefix& prefix) {
    constexpr std::uint64_t max_bytes = 64U << 20U;  // of a long file, trust the headers
    index_bytes_ += prefix.length;
    if (index_bytes_ > max_bytes) return;
    const Bytes content = file_.content(at, Opcode::message_index);
    for (const std::uint64_t time_ns :
         decode_message_index(Fields(content, Opcode::message_index, file_.place(at)))) {
      block.log_times.include(time_ns);
    }
  }

  const RecordFile& file_;
  Contents contents_;
  std::uint64_t footer_at_ = 0;
  std::uint64_t summary_start_ = 0;
  std::uint64_t index_bytes_ = 0;  ///< size of the indexes of messages that were read
  bool has_statistics_ = false;
  MemoryLimit memory_;
};

}  // namespace

std::optional<Contents> read_summary(const RecordFile& file) {
  return Summary(file).read();
}

}  // namespace sonopose::mcap
