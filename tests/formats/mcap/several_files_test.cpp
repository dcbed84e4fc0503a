/// Several files that are read as one recording.

#include "mcap/file_sink.hpp"
#include "mcap/memory.hpp"
#include "mcap/writer.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace several_files_test {

using namespace sonopose::mcap;
using Catch::Contains;
using sonopose::test::messages_of;
using sonopose::test::OwnMessage;
using sonopose::test::TemporaryFolder;
using Path = std::filesystem::path;

OwnMessage message(std::string topic, std::uint64_t time_ns) {
  return {std::move(topic), 1, time_ns, time_ns, ""};
}

/// Writes each message in a chunk of its own, and the name of the file as metadata.
void write(const Path& file, const std::vector<OwnMessage>& messages) {
  FileSink sink(file);
  Writer writer(sink);
  const auto schema = writer.add_schema("S", "omgidl", "struct S {};");
  for (const OwnMessage& each : messages) {
    writer.write({writer.add_channel(schema, each.topic, "cdr"),
                  each.sequence,
                  each.log_time_ns,
                  each.publish_time_ns,
                  {}});
    writer.end_chunk();
  }
  writer.write_metadata({"of", {{"file", file.filename().string()}}});
  writer.close();
}

SCENARIO("several files are one recording") {
  const TemporaryFolder folder;
  const std::vector<Path> files{folder / "a.mcap", folder / "b.mcap"};
  GIVEN("files that overlap in time, with a common topic that has another id in each") {
    write(files[0], {message("imu", 10), message("fix", 11), message("imu", 30)});
    write(files[1], {message("fix", 20), message("pose", 21), message("imu", 40)});
    const Reader reader(files);
    THEN("their messages come by time, and each topic is one channel") {
      CHECK(messages_of(reader) == std::vector{message("imu", 10), message("fix", 11), message("fix", 20),
                                               message("pose", 21), message("imu", 30), message("imu", 40)});
      CHECK(reader.channels().size() == 3);
      CHECK(reader.schemas().size() == 1);
    }
    THEN("a topic and a time can be selected") {
      const auto is_fix = [](const Channel& channel) { return channel.topic == "fix"; };
      CHECK(messages_of(reader, {.channel = is_fix}) == std::vector{message("fix", 11), message("fix", 20)});
      CHECK(messages_of(reader, {.start_ns = 21, .end_ns = 30}) ==
            std::vector{message("pose", 21), message("imu", 30)});
    }
    THEN("its statistics are their sums, and it has the metadata of all") {
      CHECK(reader.statistics().message_count == 6);
      CHECK(reader.statistics().log_times == TimeSpan{10, 40});
      CHECK(reader.metadata() ==
            std::vector<Metadata>{{"of", {{"file", "a.mcap"}}}, {"of", {{"file", "b.mcap"}}}});
      CHECK_THAT(reader.name(), Contains("a.mcap and 1 more"));
    }
  }
  GIVEN("a file whose log times go back") {
    write(files[0], {message("imu", 10), message("imu", 30)});
    write(files[1], {message("imu", 20), message("imu", 5), message("imu", 40)});
    THEN("each file keeps its order, and the files are merged by time") {
      const auto all = messages_of(Reader(files), {.order = Selection::Order::file});
      std::vector<std::uint64_t> times_ns;
      std::ranges::transform(all, std::back_inserter(times_ns), &OwnMessage::log_time_ns);
      CHECK(times_ns == std::vector<std::uint64_t>{10, 20, 5, 30, 40});
    }
  }
  GIVEN("a file that was cut") {
    write(files[0], {message("imu", 10), message("imu", 30)});
    write(files[1], {message("imu", 20), message("imu", 40)});
    std::filesystem::resize_file(files[1], std::filesystem::file_size(files[1]) / 2);
    const Reader reader(files);
    THEN("the damage names it, and the other one is read") {
      REQUIRE_FALSE(reader.damages().empty());
      CHECK_THAT(reader.damages()[0], Contains("b.mcap: byte "));
      const auto all = messages_of(reader);
      CHECK(std::ranges::count(all, message("imu", 10)) + std::ranges::count(all, message("imu", 30)) == 2);
    }
  }
}

}  // namespace several_files_test
