#include "mcap/file_sink.hpp"
#include "mcap/memory.hpp"
#include "mcap/writer.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <random>

namespace round_trip_test {

using namespace sonopose::mcap;
using sonopose::test::bytes_of;
using sonopose::test::MemorySink;
using sonopose::test::messages_of;
using sonopose::test::OwnMessage;
using sonopose::test::reader_of;
using sonopose::test::TemporaryFolder;

/// Messages of three topics with well compressible data of 0 to 2000 bytes and times that step back by up to
/// 50 ns.
std::vector<OwnMessage> random_messages(std::size_t count) {
  std::mt19937 random(19);  // NOLINT(cert-msc51-cpp): the same in each run
  std::vector<OwnMessage> messages;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint64_t time_ns = 1000 + 10 * i - random() % 50;
    messages.push_back({std::string(1, static_cast<char>('a' + random() % 3)), i + 1, time_ns, time_ns - 5,
                        std::string(random() % 2000, static_cast<char>(random() % 256))});
  }
  return messages;
}

void write_all(ByteSink& sink, const std::vector<OwnMessage>& messages, WriterOptions options) {
  Writer writer(sink, std::move(options));
  const auto schema = writer.add_schema("S", "omgidl", "struct S {};");
  for (const OwnMessage& message : messages) {
    writer.write({writer.add_channel(schema, message.topic, "cdr"), message.sequence, message.log_time_ns,
                  message.publish_time_ns, bytes_of(message.data)});
  }
  writer.close();
}

std::vector<OwnMessage> by_time(std::vector<OwnMessage> messages) {
  std::ranges::stable_sort(messages, {}, &OwnMessage::log_time_ns);
  return messages;
}

SCENARIO("what was written is read back, in the order of time") {
  const auto messages = random_messages(2000);
  const auto compression = GENERATE(Compression::none, Compression::lz4, Compression::zstd);
  CAPTURE(name_of(compression));
  GIVEN("2000 messages whose times go back, in chunks of 16 KiB, which therefore overlap in time") {
    MemorySink sink;
    write_all(sink, messages, {.compression = compression, .chunk_size_bytes = 16U << 10U});
    const auto reader = reader_of(sink.content);
    REQUIRE(reader.damages().empty());
    CHECK(reader.contents().is_indexed);
    CHECK(reader.contents().blocks.size() > 50);
    THEN("all messages are there, ordered by log time and then by the order of writing") {
      CHECK(messages_of(reader) == by_time(messages));
    }
    THEN("they are there in the order of writing, if asked for") {
      CHECK(messages_of(reader, {.order = Selection::Order::file}) == messages);
    }
    THEN("the statistics count them") {
      CHECK(reader.statistics().message_count == 2000);
      CHECK(reader.statistics().channel_count == 3);
    }
    THEN("topics and times select") {
      const auto selected =
          messages_of(reader, {[](const Channel& channel) { return channel.topic == "b"; }, 5000, 9000});
      std::vector<OwnMessage> expected;
      std::ranges::copy_if(by_time(messages), std::back_inserter(expected), [](const OwnMessage& message) {
        return message.topic == "b" && message.log_time_ns >= 5000 && message.log_time_ns <= 9000;
      });
      CHECK(selected == expected);
      CHECK(selected.size() > 50);
    }
    if (compression != Compression::none) {
      THEN("the file is smaller than its messages") {
        CHECK(sink.content.size() < 1'000'000);
      }
    }
  }
}

SCENARIO("a chunk is filled without a writer") {
  GIVEN("two chunks that were filled elsewhere") {
    Chunk first;
    Chunk second;
    first.add({1, 1, 10, 9, bytes_of("one")});
    second.add({1, 2, 20, 19, bytes_of("two")});
    CHECK(first.records().size() == Chunk::bytes_of(3));
    WHEN("they are written, with a message of the writer's own before them") {
      MemorySink sink;
      Writer writer(sink);
      const auto channel = writer.add_channel(0, "t", "json");
      REQUIRE(channel == 1);
      writer.write({channel, 0, 5, 5, bytes_of("zero")});
      writer.write(first);
      writer.write(second);
      writer.close();
      THEN("the file has them in this order") {
        const auto reader = reader_of(sink.content);
        CHECK(messages_of(reader) == std::vector<OwnMessage>{{"t", 0, 5, 5, "zero"},
                                                             {"t", 1, 10, 9, "one"},
                                                             {"t", 2, 20, 19, "two"}});
        CHECK(reader.contents().blocks.size() == 3);
      }
    }
    WHEN("a chunk has a channel that the file does not have") {
      MemorySink sink;
      Writer writer(sink);
      THEN("it is refused") {
        CHECK_THROWS_AS(writer.write(first), std::invalid_argument);
      }
    }
  }
  GIVEN("a chunk that was written") {
    Chunk chunk;
    chunk.add({1, 1, 10, 9, bytes_of("one")});
    chunk.clear();
    THEN("it is empty and can be filled again") {
      CHECK(chunk.is_empty());
      CHECK(chunk.records().empty());
      CHECK(chunk.log_times().is_empty());
    }
  }
}

SCENARIO("files on disk") {
  const TemporaryFolder folder;
  const auto file = folder / "log.mcap";
  const auto messages = random_messages(100);
  GIVEN("a file that was written to disk") {
    {
      FileSink sink(file);
      write_all(sink, messages, {});
    }
    THEN("it is read back, and the disk holds no more than its bytes") {
      const Reader reader(file);
      CHECK(messages_of(reader) == by_time(messages));
      CHECK(reader.size_bytes() == std::filesystem::file_size(file));
    }
    THEN("it is not overwritten") {
      CHECK_THROWS_WITH(FileSink(file), Catch::Contains("log.mcap") && Catch::Contains("exists"));
    }
  }
  GIVEN("no file") {
    THEN("the error names it") {
      CHECK_THROWS_WITH(Reader(folder / "none.mcap"), Catch::Contains("none.mcap: does not exist"));
    }
  }
  GIVEN("a file of another kind") {
    sonopose::test::write_text(file, "# timestamp, w_x\n");
    THEN("the error says so") {
      CHECK_THROWS_WITH(Reader(file), Catch::Contains("log.mcap: byte 0: is not an MCAP file"));
    }
  }
}

}  // namespace round_trip_test
