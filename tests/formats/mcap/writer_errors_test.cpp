#include "files/error.hpp"
#include "mcap/file_sink.hpp"
#include "mcap/memory.hpp"
#include "mcap/writer.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <csignal>
#include <sys/resource.h>

namespace writer_errors_test {

using namespace sonopose::mcap;
using sonopose::files::IoError;
using sonopose::test::bytes_of;
using sonopose::test::MemorySink;
using sonopose::test::messages_of;
using sonopose::test::reader_of;
using sonopose::test::TemporaryFolder;

/// A disk with `room` bytes. Others may use the remaining space, even if reserved.
class FullSink final : public ByteSink {
public:
  explicit FullSink(std::size_t room) : room_{room} {}

  void append(std::span<const std::byte> bytes) override {
    if (content.size() + bytes.size() > room_) throw IoError("disk: no space left");
    put_bytes(content, bytes);
  }
  void reserve(std::uint64_t byte_count) override {
    if (content.size() + byte_count > room_) throw IoError("disk: no space left");
  }

  void let_others_leave(std::size_t byte_count) { room_ = content.size() + byte_count; }

  Bytes content;

private:
  std::size_t room_;
};

SCENARIO("the disk is full") {
  GIVEN("a disk with room for some chunks, and a recording that goes on") {
    FullSink sink(100'000);
    Writer writer(sink, {.compression = Compression::none, .chunk_size_bytes = 1U << 12U});
    const auto channel = writer.add_channel(0, "t", "json");
    std::uint32_t written = 0;
    const std::string data(1000, 'x');
    const auto record = [&] {
      for (; written < 1000; ++written) writer.write({channel, written, written, written, bytes_of(data)});
    };
    CHECK_THROWS_WITH(record(), "disk: no space left");
    WHEN("the file is closed, with a note of why it ended") {
      writer.write_last_metadata({"end", {{"reason", "disk full"}}});
      writer.close();
      THEN("it is sound: an index, all chunks before, and the lost messages counted") {
        const auto reader = reader_of(sink.content);
        CHECK(reader.damages().empty());
        CHECK(reader.contents().is_indexed);
        CHECK(reader.metadata().size() == 1);
        const auto messages = messages_of(reader);
        CHECK(messages.size() == writer.statistics().message_count);
        CHECK(messages.size() + writer.lost_messages() == written + 1);
        CHECK(messages.size() > 20);
      }
    }
  }
  GIVEN("a disk that is filled with anything but messages") {
    FullSink sink(200'000);
    Writer writer(sink);
    const auto fill = GENERATE(0, 1, 2);
    const auto write = [&](int number) {
      const std::string text = std::to_string(number) + std::string(1000, 'x');
      if (fill == 0) writer.write_metadata({"settings", {{"text", text}}});
      if (fill == 1) writer.add_schema(text, "omgidl", "");
      if (fill == 2) writer.add_channel(0, text, "json");
    };
    const auto write_all = [&] {
      for (int i = 0; i < 1000; ++i) write(i);
    };
    CAPTURE(fill);
    CHECK_THROWS_WITH(write_all(), "disk: no space left");
    WHEN("the file is closed, with a note of why it ended") {
      writer.write_last_metadata({"end", {{"reason", std::string(50'000, 'x')}}});
      writer.close();
      THEN("it is sound and has its index") {
        const auto reader = reader_of(sink.content);
        CHECK(reader.damages().empty());
        CHECK(reader.contents().is_indexed);
        CHECK(reader.metadata().back().name == "end");
        CHECK(reader.statistics() == writer.statistics());
      }
    }
  }
  GIVEN("a disk on which not even the index fits") {
    FullSink sink(100'000);
    Writer writer(sink);
    for (int i = 0; i < 3; ++i) writer.add_channel(0, "topic " + std::to_string(i), "json");
    sink.let_others_leave(60);
    THEN("the file ends without an index, and is complete") {
      CHECK_THROWS_WITH(writer.close(), "disk: no space left");
      const auto reader = reader_of(sink.content);
      CHECK(reader.damages().empty());
      CHECK_FALSE(reader.contents().is_indexed);
      CHECK(reader.channels().size() == 3);
    }
  }
}

SCENARIO("a file may not become larger than a limit of the process") {
  GIVEN("a limit of 200 kB") {
    const TemporaryFolder folder;
    const auto file = folder / "log.mcap";
    struct rlimit before {};
    ::getrlimit(RLIMIT_FSIZE, &before);
    const auto previous_handler = std::signal(SIGXFSZ, SIG_IGN);
    const struct rlimit limit { 200'000, before.rlim_max };
    ::setrlimit(RLIMIT_FSIZE, &limit);
    {
      FileSink sink(file);
      Writer writer(sink, {.compression = Compression::none, .chunk_size_bytes = 1U << 14U});
      const auto channel = writer.add_channel(0, "t", "json");
      const std::string data(1000, 'x');
      const auto record = [&] {
        for (std::uint32_t i = 0; i < 1000; ++i) writer.write({channel, i, i, i, bytes_of(data)});
      };
      CHECK_THROWS_AS(record(), IoError);
      writer.close();
    }
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, previous_handler);
    THEN("the file has what fits, and is sound") {
      const Reader reader(file);
      CHECK(reader.damages().empty());
      CHECK(reader.contents().is_indexed);
      CHECK(messages_of(reader).size() > 50);
    }
  }
}

SCENARIO("a writer is used wrongly") {
  MemorySink sink;
  Writer writer(sink);
  GIVEN("a message of a channel that was not added") {
    THEN("it is refused") {
      CHECK_THROWS_AS(writer.write({1, 0, 0, 0, {}}), std::invalid_argument);
    }
  }
  GIVEN("a channel of a schema that was not added") {
    THEN("it is refused") {
      CHECK_THROWS_AS(writer.add_channel(3, "t", "cdr"), std::invalid_argument);
    }
  }
  GIVEN("the same schema and channel twice") {
    const auto schema = writer.add_schema("S", "omgidl", "x");
    const auto channel = writer.add_channel(schema, "t", "cdr");
    THEN("the file has them once") {
      CHECK(writer.add_schema("S", "omgidl", "x") == schema);
      CHECK(writer.add_channel(schema, "t", "cdr") == channel);
      CHECK(writer.statistics().channel_count == 1);
    }
  }
  GIVEN("a closed writer") {
    writer.close();
    THEN("it takes nothing more, and the second close does nothing") {
      CHECK_THROWS_AS(writer.add_schema("S", "", ""), std::logic_error);
      const auto size = sink.content.size();
      writer.close();
      CHECK(sink.content.size() == size);
    }
  }
}

}  // namespace writer_errors_test
