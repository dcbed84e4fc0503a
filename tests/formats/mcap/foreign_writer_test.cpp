/// Files that the specification allows and our writer does not write.

#include "mcap/encoder.hpp"
#include "mcap/memory.hpp"

#include <catch2/catch.hpp>

#include <vector>

namespace foreign_writer_test {

using namespace sonopose::mcap;
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

void put_channel(Bytes& to) {
  put_record(to, Opcode::channel, [&] {
    put(to, channel_id);
    put(to, std::uint16_t{0});
    put_text(to, "t");
    put_text(to, "json");
    put_map(to, {});
  });
}

/// A chunk whose header and index state their own times.
struct StatedChunk {
  std::vector<std::uint64_t> log_times_ns;
  TimeSpan stated;
};

/// Collects a file record by record, with an index at its end.
class File {
public:
  File() {
    put_bytes(bytes_, std::as_bytes(std::span(magic)));
    put_record(bytes_, Opcode::header, [this] {
      put_text(bytes_, "");
      put_text(bytes_, "foreign");
    });
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
    const std::uint64_t at = bytes_.size();
    put_record(bytes_, Opcode::chunk, [&] {
      put_times(bytes_, chunk.stated);
      put(bytes_, std::uint64_t{records.size()});
      put(bytes_, std::uint32_t{0});
      put_text(bytes_, "");
      put(bytes_, std::uint64_t{records.size()});
      put_bytes(bytes_, records);
    });
    const std::uint64_t length = bytes_.size() - at;
    put_record(bytes_, Opcode::message_index, [&] {
      put(bytes_, channel_id);
      put_sized(bytes_, [&] { put_bytes(bytes_, entries); });
    });
    put_record(index_, Opcode::chunk_index, [&] {
      put_times(index_, chunk.stated);
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

  /// A record of a kind that only its writer knows.
  void add_private() {
    put_record(bytes_, static_cast<Opcode>(0x80), [this] { put_text(bytes_, "padding"); });
  }

  [[nodiscard]] Bytes closed(bool repeats_channel = true) {
    put_record(bytes_, Opcode::data_end, [this] { put(bytes_, std::uint32_t{0}); });
    const std::uint64_t summary_at = bytes_.size();
    if (repeats_channel) put_channel(bytes_);
    put_record(bytes_, Opcode::statistics, [this] {
      put(bytes_, message_count_);
      put(bytes_, std::uint16_t{0});
      for (const std::uint32_t count : {1U, 0U, 0U, chunk_count_}) put(bytes_, count);
      put_times(bytes_, {});
      put_sized(bytes_, [this] {
        put(bytes_, channel_id);
        put(bytes_, message_count_);
      });
    });
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
  Bytes bytes_;
  Bytes index_;
  std::uint64_t message_count_ = 0;
  std::uint32_t chunk_count_ = 0;
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

SCENARIO("messages outside of chunks are read although there is an index of the chunks") {
  File file;
  file.add_outside(1);
  file.add({{2, 3}, {2, 3}});
  file.add_private();
  file.add_outside(4);
  const Reader reader = reader_of(file.closed());
  CHECK(reader.damages().empty());
  CHECK(times_of(reader) == Times{1, 2, 3, 4});
}

SCENARIO("a summary without the channels is no damage") {
  File file;
  file.add({{2, 3}, {2, 3}});
  const Reader reader = reader_of(file.closed(false));
  CHECK(reader.damages().empty());
  CHECK(times_of(reader) == Times{2, 3});
}

}  // namespace foreign_writer_test
