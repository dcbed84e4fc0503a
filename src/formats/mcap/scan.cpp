#include "mcap/scan.hpp"

#include "mcap/compression.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace sonopose::mcap {

namespace {

/// Upper limit for reading records outside of chunks together.
constexpr std::uint64_t plain_block_bytes = 4U << 20U;

class Scan final : private Definitions {
public:
  Scan(const RecordFile& file, std::vector<std::uint64_t> known_offsets)
      : file_{file}, known_offsets_{std::move(known_offsets)} {}

  Contents run() {
    const Header header = read_header(file_);
    contents_.profile = header.profile;
    contents_.library = header.library;
    at_ = magic.size() + file_.prefix(magic.size(), file_.size()).record_length();
    while (!read_to_end()) {
    }
    end_plain();
    finish();
    return std::move(contents_);
  }

private:
  /// Reads records up to damage or the end of the data section. Returns false if it must be called again.
  bool read_to_end() {
    try {
      while (next_record()) {
      }
      return true;
    } catch (const FormatError& error) {
      return !resume(error);
    }
  }

  /// The start of the next record is unknown. Goes to the next one that is known, even in the record before
  /// the damage, whose length may be wrong. Returns false if there is none.
  bool resume(const FormatError& error) {
    constexpr int max_resumptions = 100;  // from each one, a forged file could be read to its end
    contents_.has_uncounted_loss = true;
    const bool is_known = std::ranges::binary_search(known_offsets_, at_);
    const auto next = std::ranges::upper_bound(known_offsets_, is_known ? at_ : last_at_);
    if (next == known_offsets_.end() || ++resumptions_ > max_resumptions) {
      add_damage(std::string(error.what()) + ": it was cut, or is damaged from here on");
      return false;
    }
    end_plain();
    const std::string text =
        std::string(error.what()) + "; reading continues at byte " + std::to_string(*next);
    if (at_ < file_.size() && file_.bytes(at_, 1).front() == static_cast<std::byte>(Opcode::chunk)) {
      contents_.add_unreadable_block(text);
    } else {
      add_damage(text);
    }
    last_at_ = at_ = *next;
    return true;
  }

  /// Returns false at the end of the data section.
  bool next_record() {
    if (at_ == file_.size()) file_.place(at_).fail("the file ends without DataEnd and Footer");
    if (is_cut_chunk()) return false;
    const Prefix prefix = file_.prefix(at_, file_.size());
    last_at_ = at_;
    try {
      visit(prefix);
    } catch (const FormatError& error) {
      if (prefix.opcode == Opcode::chunk) {
        contents_.add_unreadable_block(error.what());
        count_lost_chunk(at_ + prefix.record_length());
      } else {
        add_damage(error.what());
      }
    }
    at_ += prefix.record_length();
    return prefix.opcode != Opcode::data_end && prefix.opcode != Opcode::footer;
  }

  /// Counts the messages of a chunk that cannot be read, by the indexes that follow it.
  void count_lost_chunk(std::uint64_t at) {
    bool has_index = false;
    try {
      for (Prefix next = file_.prefix(at, file_.size()); next.opcode == Opcode::message_index;
           next = file_.prefix(at, file_.size())) {
        const Bytes content = file_.content(at, Opcode::message_index);
        const MessageIndex index =
            decode_message_index(Fields(content, Opcode::message_index, file_.place(at)));
        contents_.lost_messages += index.log_times_ns.size();
        has_index = true;
        at += next.record_length();
      }
    } catch (const FormatError&) {
      has_index = false;
    }
    contents_.has_uncounted_loss = contents_.has_uncounted_loss || !has_index;
  }

  /// Reads the last chunk of a cut file up to the cut.
  bool is_cut_chunk() {
    const bool is_last = known_offsets_.empty() || known_offsets_.back() <= at_;
    if (!is_last || file_.size() - at_ < record_prefix_bytes) return false;
    const Bytes start = file_.bytes(at_, record_prefix_bytes);
    const std::uint64_t rest = file_.size() - at_;
    if (start[0] != static_cast<std::byte>(Opcode::chunk)) return false;
    if (load<std::uint64_t>(start.data() + 1) <= rest - record_prefix_bytes) return false;
    add_damage(file_.place(at_).text() + ": the file ends in this chunk: it was cut");
    contents_.has_uncounted_loss = true;
    end_plain();
    try {
      add_block({Block::Kind::cut, at_, rest, {}, {}});
    } catch (const FormatError&) {  // NOLINT(bugprone-empty-catch): nothing of it can be used
    }
    return true;
  }

  void visit(const Prefix& prefix) {
    const bool is_plain = prefix.opcode == Opcode::message || prefix.opcode == Opcode::schema ||
                          prefix.opcode == Opcode::channel;
    if (!is_plain) end_plain();
    switch (prefix.opcode) {
      case Opcode::message:
      case Opcode::schema:
      case Opcode::channel:
        extend_plain(prefix);
        break;
      case Opcode::chunk:
        ++contents_.statistics.chunk_count;
        add_block({Block::Kind::chunk, at_, prefix.record_length(), {}, {}});
        break;
      case Opcode::metadata:
        add_metadata(prefix);
        break;
      case Opcode::attachment:
        contents_.attachments.push_back({at_, prefix.record_length()});
        break;
      default:
        break;
    }
  }

  void add_metadata(const Prefix& prefix) {
    const Bytes content = file_.content(at_, Opcode::metadata);
    Fields fields(content, Opcode::metadata, file_.place(at_));
    std::ignore = decode_metadata(fields);
    contents_.metadata.push_back({at_, prefix.record_length()});
  }

  void extend_plain(const Prefix& prefix) {
    if (plain_.length + prefix.record_length() > plain_block_bytes) end_plain();
    if (plain_.length == 0) plain_.offset = at_;
    plain_.length += prefix.record_length();
  }

  void end_plain() {
    if (plain_.length == 0) return;
    const Block block = std::exchange(plain_, Block{Block::Kind::plain, 0, 0, {}, {}});
    try {
      add_block(block);
    } catch (const FormatError& error) {
      contents_.add_unreadable_block(error.what());
      contents_.has_uncounted_loss = true;
    }
  }

  void add_block(Block block) {
    block.was_scanned = true;
    LoadedBlock loaded = file_.load(block, this);
    drop_unknown(loaded, block);
    if (loaded.messages.empty()) return;
    std::set<std::uint16_t> channels;
    Statistics& statistics = contents_.statistics;
    for (const LoadedBlock::Item& item : loaded.messages) {
      block.log_times.include(item.log_time_ns);
      channels.insert(item.channel_id);
      ++statistics.channel_message_counts[item.channel_id];
    }
    block.channels.assign(channels.begin(), channels.end());
    statistics.message_count += loaded.messages.size();
    statistics.log_times.include(block.log_times);
    contents_.blocks.push_back(std::move(block));
  }

  void on(Schema schema, const Place& place) override {
    if (schema.id != no_schema) add_definition(contents_.schemas, std::move(schema), "schema", place);
  }
  void on(Channel channel, const Place& place) override {
    add_definition(contents_.channels, std::move(channel), "channel", place);
  }
  void on_damage(std::string text) override { add_damage(std::move(text)); }

  template <class Definition>
  void add_definition(std::map<std::uint16_t, Definition>& known, Definition definition,
                      std::string_view what, const Place& place) {
    const auto found = known.find(definition.id);
    if (found == known.end()) {
      memory_.reserve(memory_of(definition), "the schemas and channels take", place);
      known.emplace(definition.id, std::move(definition));
    } else if (found->second != definition) {
      add_damage(place.text() + ": " + std::string(what) + " " + std::to_string(definition.id) +
                 " differs from the one of this id before; the first is used");
    }
  }

  /// Drops messages of channels that are not defined before them.
  void drop_unknown(LoadedBlock& loaded, const Block& block) {
    std::map<std::uint16_t, std::uint64_t> unknown;
    std::erase_if(loaded.messages, [&](const LoadedBlock::Item& item) {
      if (contents_.channels.contains(item.channel_id)) return false;
      ++unknown[item.channel_id];
      return true;
    });
    for (const auto& [channel_id, count] : unknown) {
      contents_.lost_messages += count;
      add_damage(file_.place(block.offset).text() + ": channel " + std::to_string(channel_id) +
                 " is not defined before; messages of it that are left out: " + std::to_string(count));
    }
  }

  void add_damage(std::string text) { contents_.add_damage(std::move(text)); }

  void finish() {
    Statistics& statistics = contents_.statistics;
    statistics.schema_count = static_cast<std::uint16_t>(contents_.schemas.size());
    statistics.channel_count = static_cast<std::uint32_t>(contents_.channels.size());
    statistics.metadata_count = static_cast<std::uint32_t>(contents_.metadata.size());
    statistics.attachment_count = static_cast<std::uint32_t>(contents_.attachments.size());
  }

  const RecordFile& file_;
  std::vector<std::uint64_t> known_offsets_;
  std::uint64_t at_ = 0;
  std::uint64_t last_at_ = 0;  ///< place of the last record with a possible length
  int resumptions_ = 0;
  Block plain_{Block::Kind::plain, 0, 0, {}, {}};
  MemoryLimit memory_;
  Contents contents_;
};

}  // namespace

Header read_header(const RecordFile& file) {
  const auto expected = std::as_bytes(std::span(magic));
  if (file.size() < magic.size() || !std::ranges::equal(file.bytes(0, magic.size()), expected)) {
    constexpr std::string_view sqlite = "SQLite format 3";
    if (file.size() >= sqlite.size() &&
        std::ranges::equal(file.bytes(0, sqlite.size()), std::as_bytes(std::span(sqlite)))) {
      file.place(0).fail(
          "is in SQLite, which sonopose-replay and sonopose-mcap export read; this needs MCAP");
    }
    file.place(0).fail("is not an MCAP file: it does not begin with the magic bytes of version 0");
  }
  const Bytes content = file.content(magic.size(), Opcode::header);
  return decode_header(Fields(content, Opcode::header, file.place(magic.size())));
}

Contents scan(const RecordFile& file, std::vector<std::uint64_t> known_offsets) {
  return Scan(file, std::move(known_offsets)).run();
}

}  // namespace sonopose::mcap
