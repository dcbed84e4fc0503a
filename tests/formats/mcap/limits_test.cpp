#include "mcap/compression.hpp"
#include "mcap/memory.hpp"
#include "mcap/record_file.hpp"
#include "mcap/writer.hpp"

#include <catch2/catch.hpp>

#include <initializer_list>

namespace limits_test {

using namespace sonopose::mcap;
using Catch::Contains;
using sonopose::test::MemorySink;
using sonopose::test::messages_of;
using sonopose::test::reader_of;

/// A file without an index whose first chunk contains arbitrary records.
Bytes file_with_records(const Bytes& records, std::uint64_t log_time_ns) {
  MemorySink sink;
  { const Writer writer(sink); }
  Bytes bytes = sink.content;
  bytes.resize(8 + 9 + 8 + 8);
  Compressor compressor(Compression::zstd);
  Bytes compressed(compressor.bound(records.size()));
  compressed.resize(compressor.compress(records, compressed));
  put_record(bytes, Opcode::chunk, [&] {
    put_times(bytes, {log_time_ns, log_time_ns});
    put(bytes, std::uint64_t{records.size()});
    put(bytes, std::uint32_t{0});
    put_text(bytes, "zstd");
    put(bytes, std::uint64_t{compressed.size()});
    put_bytes(bytes, compressed);
  });
  return bytes;
}

void put_channel(Bytes& to, std::uint16_t id, std::initializer_list<std::string_view> metadata) {
  put_record(to, Opcode::channel, [&] {
    put(to, id);
    put(to, no_schema);
    put_text(to, "t");
    put_text(to, "json");
    put_sized(to, [&] {
      for (const std::string_view text : metadata) put_text(to, text);
    });
  });
}

void put_message(Bytes& to, std::uint16_t channel_id, std::uint64_t log_time_ns) {
  put_record(to, Opcode::message, [&] {
    put(to, channel_id);
    put(to, std::uint32_t{1});
    put(to, log_time_ns);
    put(to, log_time_ns);
  });
}

TEST_CASE("a chunk of definitions takes no memory for them, and one of messages counts their places") {
  constexpr int count = 200'000;
  Bytes records;
  for (int i = 0; i < count; ++i) put_channel(records, 1, {});
  put_message(records, 1, 5);
  const auto reader = reader_of(file_with_records(records, 5));
  CHECK(reader.channels().size() == 1);
  CHECK(messages_of(reader).size() == 1);
  CHECK(reader.file().load(reader.contents().blocks.at(0)).size_bytes() < 2 * records.size());

  Bytes short_messages;
  put_channel(short_messages, 1, {});
  for (int i = 0; i < count; ++i) put_message(short_messages, 1, 5);
  const auto of_messages = reader_of(file_with_records(short_messages, 5));
  const std::uint64_t places = count * sizeof(LoadedBlock::Item);
  CHECK(messages_of(of_messages).size() == count);
  CHECK_THROWS_WITH(messages_of(of_messages, {.max_bytes = short_messages.size() + places / 2}),
                    Contains("the chunks that overlap in time have "));
}

/// The limit of expansion during a test.
class MaxExpanded {
public:
  explicit MaxExpanded(std::uint64_t bytes) { set_max_expanded(bytes); }
  MaxExpanded(const MaxExpanded&) = delete;
  MaxExpanded& operator=(const MaxExpanded&) = delete;
  ~MaxExpanded() { set_max_expanded(0); }
};

SCENARIO("a small file that expands to much is refused") {
  GIVEN("a file of a few kilobytes with a million bytes of empty messages") {
    constexpr std::size_t count = 32'000;
    Bytes records;
    put_channel(records, 1, {});
    for (std::size_t i = 0; i < count; ++i) put_message(records, 1, 5);
    const Bytes file = file_with_records(records, 5);
    REQUIRE(file.size() < 100'000);
    const std::uint64_t expanded = records.size() + bytes_per_message * count;
    WHEN("the limit is lower") {
      const MaxExpanded limit(expanded - 1);
      THEN("the error names file, limit and option, and is not taken for damage") {
        CHECK_THROWS_WITH(reader_of(file), Contains("memory.mcap: byte ") &&
                                               Contains("more than " + std::to_string(expanded - 1)) &&
                                               Contains("--max-expanded"));
      }
    }
    WHEN("the limit is reached, and the file is read several times") {
      const MaxExpanded limit(expanded);
      THEN("each chunk counts once") {
        const auto reader = reader_of(file);
        CHECK(messages_of(reader).size() == count);
        CHECK(messages_of(reader).size() == count);
      }
    }
  }
  GIVEN("no limit of the user") {
    THEN("it is 200 times the size, but not less than 4 GB") {
      CHECK(max_expanded(829'000) == 4'000'000'000);
      CHECK(max_expanded(1'000'000'000) == 200'000'000'000);
      CHECK(max_expanded(std::uint64_t{1} << 63U) > (std::uint64_t{1} << 63U));
    }
  }
}

TEST_CASE("schemas that decompress to more than the limit are left out") {
  Bytes bytes;
  for (std::uint16_t id = 1; id <= 5; ++id) {
    Bytes records;
    put_record(records, Opcode::schema, [&] {
      put(records, id);
      put_text(records, "S");
      put_text(records, "omgidl");
      put_text(records, std::string(60U << 20U, 'x'));
    });
    const Bytes file = file_with_records(records, 5);
    const std::size_t header_bytes = bytes.empty() ? 0 : 8 + 9 + 8 + 8;
    put_bytes(bytes, std::span(file).subspan(header_bytes));
  }
  const auto reader = reader_of(bytes);
  CHECK(reader.schemas().size() == 4);
  CHECK_THAT(reader.damages().at(0), Contains("the schemas and channels take more than 268435456 bytes"));
}

TEST_CASE("a schema of id 0 is ignored") {
  Bytes records;
  put_record(records, Opcode::schema, [&] {
    put(records, no_schema);
    for (int i = 0; i < 3; ++i) put_text(records, "none");
  });
  put_channel(records, 1, {});
  put_message(records, 1, 5);
  const auto reader = reader_of(file_with_records(records, 5));
  CHECK(reader.schemas().empty());
  CHECK(messages_of(reader).size() == 1);
}

TEST_CASE("a channel whose metadata has a key twice is used, with its first value") {
  Bytes records;
  put_channel(records, 1, {"a", "first", "a", "second"});
  put_message(records, 1, 5);
  const auto reader = reader_of(file_with_records(records, 5));
  CHECK(reader.channels().at(1).metadata == TextMap{{"a", "first"}});
  CHECK(messages_of(reader).size() == 1);
  CHECK_THAT(reader.damages().at(0), Contains("Channel metadata has a key twice; its first value is used"));
}

TEST_CASE("a map with too many entries is refused") {
  Bytes records;
  put_record(records, Opcode::channel, [&] {
    put(records, std::uint16_t{1});
    put(records, no_schema);
    put_text(records, "t");
    put_text(records, "json");
    put_sized(records, [&] {
      for (std::uint32_t i = 0; i < (1U << 20U) + 1; ++i) {
        put(records, std::uint32_t{4});
        put(records, i);
        put_text(records, "");
      }
    });
  });
  CHECK_THAT(reader_of(file_with_records(records, 5)).damages().at(0),
             Contains("Channel metadata has more than 1048576 entries"));
}

}  // namespace limits_test
