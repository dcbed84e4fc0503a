/// Files that the specification allows and our writer does not write.

#include "mcap/compression.hpp"
#include "mcap/encoder.hpp"
#include "mcap/memory.hpp"
#include "mcap/verify.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace foreign_writer_test {

using namespace sonopose::mcap;
using Catch::Contains;
using sonopose::test::bytes_of;
using sonopose::test::messages_of;
using sonopose::test::reader_of;

constexpr std::uint16_t channel_id = 1;

void put_message(Bytes& to, std::uint64_t log_time_ns) {
  put_record(to, Opcode::message, [&] {
    put(to, channel_id);
    put(to, std::uint32_t{0});
    put(to, log_time_ns);
    put(to, log_time_ns);
    put_bytes(to, bytes_of("{}"));
  });
}

/// A chunk whose header and index state their own times.
struct StatedChunk {
  std::vector<std::uint64_t> log_times_ns;
  TimeSpan stated;
  bool has_message_index = true;
  std::string compression{};
};

/// Parts that a writer may leave out or add.
struct Form {
  bool has_schemas = true;
  bool has_channels = true;
  bool has_statistics = true;
  bool has_counts = true;      ///< number of messages of each channel
  std::size_t more_bytes = 0;  ///< fields of a later version of the format at the end of each record
};

/// Appends the times as they are, in an order that put_times would not write.
void put_stated(Bytes& to, const TimeSpan& times) {
  put(to, times.start_ns);
  put(to, times.end_ns);
}

Bytes compressed(std::string_view name, std::span<const std::byte> records) {
  Compressor compressor(name == "lz4" ? Compression::lz4 : Compression::zstd);
  Bytes frame(compressor.bound(records.size()));
  frame.resize(compressor.compress(records, frame));
  return frame;
}

/// Two frames of half the bytes each, a frame that readers skip, and bytes that are no frame.
Bytes in_frames(std::string_view name, std::span<const std::byte> records) {
  constexpr std::uint32_t magic_of_skipped = 0x184d2a50;  // of both formats
  const std::size_t half = records.size() / 2;
  Bytes frames = compressed(name, records.first(half));
  put(frames, magic_of_skipped);
  put(frames, std::uint32_t{3});
  put_bytes(frames, bytes_of("..."));
  put_bytes(frames, compressed(name, records.subspan(half)));
  frames.resize(frames.size() + 16);
  return frames;
}

/// Collects a file record by record, with an index at its end.
class File {
public:
  explicit File(Form form = {}) : form_(form) {
    put_bytes(bytes_, std::as_bytes(std::span(magic)));
    put_longer(bytes_, Opcode::header, [this] {
      put_text(bytes_, "");
      put_text(bytes_, "foreign");
    });
    put_schema(bytes_);
    put_channel(bytes_);
  }

  void add(const StatedChunk& chunk) {
    Bytes records;
    Bytes entries;
    for (const std::uint64_t time_ns : chunk.log_times_ns) {
      put(entries, time_ns);
      put(entries, std::uint64_t{records.size()});
      put_message(records, time_ns);
    }
    const Bytes stored = chunk.compression.empty() ? records : in_frames(chunk.compression, records);
    const std::uint64_t at = bytes_.size();
    put_record(bytes_, Opcode::chunk, [&] {
      put_stated(bytes_, chunk.stated);
      put(bytes_, std::uint64_t{records.size()});
      put(bytes_, crc32(records));
      put_text(bytes_, chunk.compression);
      put(bytes_, std::uint64_t{stored.size()});
      put_bytes(bytes_, stored);
    });
    const std::uint64_t length = bytes_.size() - at;
    message_index_at_ = bytes_.size();
    if (chunk.has_message_index) {
      put_longer(bytes_, Opcode::message_index, [&] {
        put(bytes_, channel_id);
        put_sized(bytes_, [&] { put_bytes(bytes_, entries); });
      });
    }
    put_longer(index_, Opcode::chunk_index, [&] {
      put_stated(index_, chunk.stated);
      put(index_, at);
      put(index_, length);
      put_sized(index_, [] {});
    });
    ++chunk_count_;
    message_count_ += chunk.log_times_ns.size();
  }

  void add_outside(std::uint64_t log_time_ns) {
    put_message(bytes_, log_time_ns);
    ++message_count_;
  }

  void add_attachment() {
    const std::uint64_t at = bytes_.size();
    put_longer(bytes_, Opcode::attachment, [this] {
      const std::size_t begin = bytes_.size();
      put_stated(bytes_, {7, 8});  // log_time, create_time
      put_text(bytes_, "plan");
      put_text(bytes_, "image/png");
      put(bytes_, std::uint64_t{3});
      put_bytes(bytes_, bytes_of("abc"));
      put(bytes_, crc32(std::span(bytes_).subspan(begin)));
    });
    put_longer(index_, Opcode::attachment_index, [&] {
      put(index_, at);
      put(index_, std::uint64_t{bytes_.size() - at});
      put_stated(index_, {7, 8});
      put(index_, std::uint64_t{3});
      put_text(index_, "plan");
      put_text(index_, "image/png");
    });
    ++attachment_count_;
  }

  void add_metadata() {
    const std::uint64_t at = bytes_.size();
    put_longer(bytes_, Opcode::metadata, [this] {
      put_text(bytes_, "m");
      put_map(bytes_, {{"a", "b"}});
    });
    put_longer(index_, Opcode::metadata_index, [&] {
      put(index_, at);
      put(index_, std::uint64_t{bytes_.size() - at});
      put_text(index_, "m");
    });
    ++metadata_count_;
  }

  /// A record of a kind that only its writer knows.
  void add_private() {
    put_record(bytes_, static_cast<Opcode>(0x80), [this] { put_text(bytes_, "padding"); });
  }

  /// The place of the index of the last chunk's messages.
  [[nodiscard]] std::size_t message_index_at() const { return message_index_at_; }
  void state_messages(std::uint64_t count) { message_count_ = count; }

  [[nodiscard]] Bytes closed() {
    put_record(bytes_, Opcode::data_end, [this] { put(bytes_, std::uint32_t{0}); });
    const std::uint64_t summary_at = bytes_.size();
    if (form_.has_schemas) put_schema(bytes_);
    if (form_.has_channels) put_channel(bytes_);
    if (form_.has_statistics) {
      put_longer(bytes_, Opcode::statistics, [this] {
        put(bytes_, message_count_);
        put(bytes_, std::uint16_t{1});
        for (const std::uint32_t count : {1U, attachment_count_, metadata_count_, chunk_count_}) {
          put(bytes_, count);
        }
        put_stated(bytes_, {9, 1});
        put_sized(bytes_, [this] {
          if (!form_.has_counts) return;
          put(bytes_, channel_id);
          put(bytes_, message_count_);
        });
      });
    }
    put_bytes(bytes_, index_);
    put_record(bytes_, Opcode::footer, [&] {
      put(bytes_, summary_at);
      put(bytes_, std::uint64_t{0});
      put(bytes_, std::uint32_t{0});
    });
    put_bytes(bytes_, std::as_bytes(std::span(magic)));
    return bytes_;
  }

private:
  template <class Content>
  void put_longer(Bytes& to, Opcode opcode, const Content& content) const {
    put_record(to, opcode, [&] {
      content();
      to.resize(to.size() + form_.more_bytes, std::byte{0xff});
    });
  }

  void put_schema(Bytes& to) const {
    put_longer(to, Opcode::schema, [&] {
      put(to, std::uint16_t{1});
      for (const char* const text : {"S", "jsonschema", "{}"}) put_text(to, text);
    });
  }

  void put_channel(Bytes& to) const {
    put_longer(to, Opcode::channel, [&] {
      put(to, channel_id);
      put(to, std::uint16_t{1});
      put_text(to, "t");
      put_text(to, "json");
      put_map(to, {});
    });
  }

  Form form_;
  Bytes bytes_;
  Bytes index_;
  std::size_t message_index_at_ = 0;
  std::uint64_t message_count_ = 0;
  std::uint32_t chunk_count_ = 0;
  std::uint32_t attachment_count_ = 0;
  std::uint32_t metadata_count_ = 0;
};

std::vector<std::uint64_t> times_of(const Reader& reader, const Selection& selection = {}) {
  std::vector<std::uint64_t> times_ns;
  for (const auto& message : messages_of(reader, selection)) times_ns.push_back(message.log_time_ns);
  return times_ns;
}

using Times = std::vector<std::uint64_t>;

SCENARIO("the times that a chunk states are not believed") {
  GIVEN("messages of log time 0 that the header leaves out") {
    File file;
    file.add({{0, 0, 10, 20}, {10, 20}});
    const Reader reader = reader_of(file.closed());
    THEN("they are read and selected like the others") {
      CHECK(reader.damages().empty());
      CHECK(times_of(reader) == Times{0, 0, 10, 20});
      CHECK(times_of(reader, {.end_ns = 5}) == Times{0, 0});
    }
  }
  GIVEN("a chunk that states the time of its last message only") {
    File file;
    file.add({{0, 10, 20}, {0, 20}});
    file.add({{5, 15, 50}, {50, 50}});
    const Reader reader = reader_of(file.closed());
    THEN("all messages come by time") {
      CHECK(times_of(reader) == Times{0, 5, 10, 15, 20, 50});
      CHECK(times_of(reader, {.start_ns = 5, .end_ns = 10}) == Times{5, 10});
    }
  }
}

SCENARIO("the times that a chunk states are not believed without an index of its messages") {
  GIVEN("chunks that state one time, or a start after the end, without indexes of their messages") {
    File file;
    file.add({{0, 10, 20}, {20, 20}, false});
    file.add({{5, 15, 50}, {50, 5}, false});
    const Reader reader = reader_of(file.closed());
    THEN("all messages come by time, and are selected by their own times") {
      CHECK(reader.damages().empty());
      CHECK(times_of(reader) == Times{0, 5, 10, 15, 20, 50});
      CHECK(times_of(reader, {.start_ns = 5, .end_ns = 10}) == Times{5, 10});
      CHECK(reader.statistics().log_times == TimeSpan{0, 50});
    }
  }
  GIVEN("chunks that state times of years that they have no messages of") {
    File file;
    file.add({{10, 20}, {0, 1'000'000}});
    file.add({{30, 40}, {40, 30}});
    const Reader reader = reader_of(file.closed());
    THEN("the times are those of the messages") {
      CHECK(reader.damages().empty());
      CHECK(reader.contents().is_indexed);
      CHECK(reader.statistics().log_times == TimeSpan{10, 40});
      CHECK(times_of(reader) == Times{10, 20, 30, 40});
    }
  }
}

SCENARIO("a file has a wrong number of messages") {
  File file;
  file.add({{2, 3}, {2, 3}});
  file.add_outside(4);
  file.state_messages(5);
  const Reader reader = reader_of(file.closed());
  THEN("it is named, and the file says how many are missing") {
    REQUIRE(reader.damages().size() == 1);
    CHECK_THAT(reader.damages()[0], Contains("Statistics message_count is 5, but there are 3 messages"));
    CHECK(times_of(reader) == Times{2, 3, 4});
    CHECK(reader.contents().lost_messages == 2);
  }
}

SCENARIO("an index of messages is damaged") {
  File file;
  file.add_outside(1);
  file.add({{2, 3}, {2, 3}});
  const std::size_t at = file.message_index_at();
  file.add({{5, 6}, {5, 6}});
  file.add_outside(7);
  Bytes bytes = file.closed();
  GIVEN("an index that says it is longer than its record") {
    bytes[at + record_prefix_bytes + 2] = std::byte{0xff};
    THEN("no message is lost, also none outside of chunks") {
      CHECK(times_of(reader_of(bytes)) == Times{1, 2, 3, 5, 6, 7});
    }
  }
  GIVEN("a record whose length hides where the next one begins") {
    bytes[at + 7] = std::byte{0x7f};
    const Reader reader = reader_of(bytes);
    THEN("reading continues at the next chunk") {
      REQUIRE(reader.damages().size() == 1);
      CHECK_THAT(reader.damages()[0],
                 Contains("MessageIndex length is ") && Contains("reading continues at byte "));
      CHECK(times_of(reader) == Times{1, 2, 3, 5, 6, 7});
    }
  }
}

SCENARIO("a chunk has several compressed frames, one to skip and bytes behind them") {
  const std::string compression = GENERATE("lz4", "zstd");
  CAPTURE(compression);
  File file;
  file.add({{2, 3, 4, 5}, {2, 5}, true, compression});
  const Reader reader = reader_of(file.closed());
  CHECK(reader.damages().empty());
  CHECK(times_of(reader) == Times{2, 3, 4, 5});
  CHECK(verify(reader).empty());
}

SCENARIO("records have fields of a later version of the format") {
  File file({.more_bytes = 3});
  file.add_metadata();
  file.add({{2, 3}, {2, 3}});
  file.add_attachment();
  file.add({{4, 5}, {4, 5}});
  const bool is_complete = GENERATE(true, false);
  CAPTURE(is_complete);
  if (!is_complete) file.add_outside(6);
  const Reader reader = reader_of(file.closed());
  CHECK(reader.damages().empty());
  CHECK(verify(reader).empty());
  CHECK(reader.contents().is_indexed == is_complete);
  CHECK(times_of(reader) == (is_complete ? Times{2, 3, 4, 5} : Times{2, 3, 4, 5, 6}));
  CHECK(reader.metadata() == std::vector<Metadata>{{"m", {{"a", "b"}}}});
  CHECK(reader.schemas().at(1) == Schema{1, "S", "jsonschema", "{}"});
  REQUIRE(reader.contents().attachments.size() == 1);
  CHECK_NOTHROW(reader.attachment(reader.contents().attachments[0]));
}

SCENARIO("a summary lacks what it may lack") {
  const Form form = GENERATE(Form{.has_schemas = false}, Form{.has_channels = false},
                             Form{.has_statistics = false}, Form{.has_counts = false});
  File file(form);
  file.add({{2, 3}, {2, 3}});
  const Reader reader = reader_of(file.closed());
  CHECK(reader.damages().empty());
  CHECK(times_of(reader) == Times{2, 3});
  CHECK(reader.schemas().at(1).name == "S");
  CHECK(reader.statistics().channel_message_counts.at(channel_id) == 2);
}

SCENARIO("messages outside of chunks are read although there is an index of the chunks") {
  File file;
  file.add_outside(1);
  file.add({{2, 3}, {2, 3}});
  file.add_private();
  file.add_outside(4);
  const Reader reader = reader_of(file.closed());
  CHECK(reader.damages().empty());
  CHECK(verify(reader).empty());
  CHECK(times_of(reader) == Times{1, 2, 3, 4});
}

}  // namespace foreign_writer_test
