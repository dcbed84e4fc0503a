#include "recorder/file_series.hpp"

#include "bus_log/instance_end.hpp"
#include "files/error.hpp"
#include "recorder/messages.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <csignal>
#include <sys/resource.h>

namespace sonopose::recorder::test::file_series_test {

using sonopose::test::TemporaryFolder;

constexpr std::uint64_t second = 1'000'000'000;

SeriesOptions options_for(const std::filesystem::path& file) {
  return {.file = file,
          .writer = {.compression = mcap::Compression::none},
          .channels = {{"sonopose/reset", "cdr", "sonopose::ResetCommand", "omgidl", "idl"},
                       {"sonopose/settings", "cdr", "sonopose::EffectiveSettings", "omgidl", "idl", {}, true},
                       {std::string(bus_log::instance_ends_topic), "json", "sonopose.InstanceEnd",
                        "jsonschema", "{}"}},
          .about = {{"host", "here"}}};
}

mcap::Chunk chunk_of(std::uint16_t channel_id, std::uint64_t log_time_ns, std::span<const std::byte> data,
                     std::uint32_t sequence = 1) {
  mcap::Chunk chunk;
  chunk.add({channel_id, sequence, log_time_ns, log_time_ns - 5, data});
  return chunk;
}

/// Writes a chunk that is taken at its log time.
void write(FileSeries& series, const mcap::Chunk& chunk, const TapCounts& counts) {
  const SteadyTime at{static_cast<std::int64_t>(chunk.log_times().end_ns)};
  series.write(chunk, {at, at}, counts);
}

TEST_CASE("A recording is one file with its name at the end") {
  const TemporaryFolder folder;
  const auto file = folder / "run.mcap";
  FileSeries series(options_for(file));
  series.open();
  CHECK(exists(folder / "run.mcap.part"));
  const auto data = command_cdr(7, 1);
  write(series, chunk_of(1, 100, data), {.received = 1});
  write(series, chunk_of(1, 200, data, 3),
        {.received = 3, .lost_queue = 1, .lost_dds = 4, .events_missing = 5});
  CHECK(series.message_count() == 2);
  CHECK_FALSE(exists(file));

  SECTION("when it is finished") {
    series.finish("stopped", {.received = 3, .lost_queue = 1, .lost_dds = 4, .events_missing = 5},
                  {{"not_recorded", "rt/odom"}});
    CHECK_FALSE(exists(folder / "run.mcap.part"));
    CHECK(series.files() == std::vector{file});
    const auto messages = messages_of(file);
    REQUIRE(messages.size() == 2);
    CHECK(messages[0] == OwnedMessage{"sonopose/reset", 1, 100, 95, data});
    CHECK(messages[1].sequence == 3);
    CHECK(metadata_of(file, "sonopose.recording") == mcap::TextMap{{"host", "here"}, {"file_index", "1"}});
    CHECK(metadata_of(file, "sonopose.losses") ==
          mcap::TextMap{
              {"log_time_ns", "200"}, {"lost_queue", "1"}, {"lost_dds", "4"}, {"events_missing", "5"}});
    CHECK(metadata_of(file, "sonopose.recording_end") == mcap::TextMap{{"reason", "stopped"},
                                                                       {"received", "3"},
                                                                       {"recorded", "2"},
                                                                       {"repeated", "0"},
                                                                       {"lost_queue", "1"},
                                                                       {"lost_disk", "0"},
                                                                       {"lost_dds", "4"},
                                                                       {"events_missing", "5"},
                                                                       {"not_recorded", "rt/odom"}});
  }
  SECTION("and neither it nor its part is overwritten") {
    CHECK_THROWS_WITH(FileSeries(options_for(file)), Catch::Contains("run.mcap.part: exists"));
    series.finish("stopped", {});
    CHECK_THROWS_WITH(FileSeries(options_for(file)), Catch::Contains("run.mcap: exists"));
  }
}

TEST_CASE("A file is not longer and not larger than allowed, and each begins with the latest settings") {
  const TemporaryFolder folder;
  SeriesOptions options = options_for(folder / "run.mcap");
  options.is_numbered = true;
  const auto data = command_cdr(7, 1);
  const auto first_settings = command_cdr(7, 2);
  const auto last_settings = command_cdr(7, 3);
  const auto other_settings = command_cdr(8, 4);

  SECTION("by the time") {
    options.max_duration_ns = 10 * second;
    FileSeries series(options);
    write(series, chunk_of(2, 1 * second, first_settings), {});
    write(series, chunk_of(2, 2 * second, other_settings), {});
    write(series, chunk_of(2, 3 * second, last_settings), {});
    write(series, chunk_of(1, 11 * second, data), {});
    write(series, chunk_of(1, 12 * second, data), {});
    const std::string end = bus_log::json_of({"sonopose/settings", true, command_cdr(8, 0), 5});
    write(series, chunk_of(3, 13 * second, std::as_bytes(std::span(end))), {});
    write(series, chunk_of(1, 23 * second, data), {});
    series.finish("stopped", {});

    REQUIRE(series.files() ==
            std::vector{folder / "run_001.mcap", folder / "run_002.mcap", folder / "run_003.mcap"});
    CHECK(messages_of(folder / "run_001.mcap").size() == 4);
    CHECK(metadata_of(folder / "run_001.mcap", "sonopose.recording_end")["reason"] == "duration");
    const auto second_file = messages_of(folder / "run_002.mcap");
    REQUIRE(second_file.size() == 4);
    CHECK(second_file[0] == OwnedMessage{"sonopose/settings", 1, 12 * second, 3 * second - 5, last_settings});
    CHECK(second_file[1] ==
          OwnedMessage{"sonopose/settings", 1, 12 * second, 2 * second - 5, other_settings});
    const auto third_file = messages_of(folder / "run_003.mcap");
    REQUIRE(third_file.size() == 2);  // beacon 8 has ended
    CHECK(third_file[0].data == last_settings);
    CHECK(metadata_of(folder / "run_003.mcap", "sonopose.recording")["file_index"] == "3");
  }
  SECTION("by the size") {
    options.max_size_bytes = 20'000;
    FileSeries series(options);
    const std::vector<std::byte> large(4'000);
    for (std::uint64_t i = 1; i <= 20; ++i) write(series, chunk_of(1, i * second, large), {});
    series.finish("stopped", {});
    REQUIRE(series.files().size() == 5);
    std::size_t count = 0;
    for (const auto& file : series.files()) {
      CHECK(file_size(file) <= options.max_size_bytes);
      count += messages_of(file).size();
    }
    CHECK(count == 20);
  }
}

TEST_CASE("The size of a file counts what each message needs besides its data") {
  const TemporaryFolder folder;
  SeriesOptions options = options_for(folder / "run.mcap");
  options.is_numbered = true;
  options.max_size_bytes = 40'000;
  options.max_duration_ns = 1000 * second;
  FileSeries series(options);
  for (std::uint64_t i = 1; i <= 40; ++i) {
    mcap::Chunk chunk;
    for (std::uint32_t n = 0; n < 100; ++n) chunk.add({1, n, i * second, i * second, {}});
    write(series, chunk, {.received = i * 100, .lost_queue = i});
  }
  series.finish("stopped", {});
  REQUIRE(series.files().size() > 3);
  for (const auto& file : series.files()) CHECK(file_size(file) <= options.max_size_bytes);
  CHECK(metadata_of(series.files().front(), "sonopose.recording_end")["reason"] == "size");

  SECTION("and the limit that was reached is the reason") {
    SeriesOptions long_options = options_for(folder / "long.mcap");
    long_options.is_numbered = true;
    long_options.max_size_bytes = 1'000'000;
    long_options.max_duration_ns = 10 * second;
    FileSeries long_series(long_options);
    write(long_series, chunk_of(1, 1 * second, command_cdr(7, 1)), {});
    write(long_series, chunk_of(1, 20 * second, command_cdr(7, 1)), {});
    CHECK(metadata_of(folder / "long_001.mcap", "sonopose.recording_end")["reason"] == "duration");
  }
}

/// Limits the size of the files of this process until its destruction.
class FileSizeLimit {
public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &before_) == 0);
    const rlimit limit{bytes, before_.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &limit) == 0);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_CASE("A disk that is full as a file begins") {
  const TemporaryFolder folder;
  SeriesOptions options = options_for(folder / "run.mcap");
  options.is_numbered = true;
  options.max_duration_ns = 10 * second;
  FileSeries series(options);
  SECTION("takes neither its head, nor leaves a part that would be in the way of the next recording") {
    const FileSizeLimit limit(GENERATE(rlim_t{0}, rlim_t{20}, rlim_t{500}));
    CHECK_THROWS_AS(write(series, chunk_of(1, 1 * second, command_cdr(7, 1)), {}), files::IoError);
    CHECK(std::filesystem::is_empty(folder.path()));
    CHECK(series.lost_disk() == 1);
    CHECK(series.message_count() == 0);
    CHECK_NOTHROW(FileSeries(options));
  }
  SECTION("does not count what the file would have repeated") {
    const std::vector<std::byte> settings(100'000);
    write(series, chunk_of(2, 1 * second, command_cdr(7, 1)), {});
    write(series, chunk_of(2, 2 * second, command_cdr(8, 1)), {});
    mcap::Chunk large;
    large.add({2, 3, 3 * second, 3 * second, settings});
    write(series, large, {});
    series.finish("trigger", {});
    {
      const FileSizeLimit limit(80'000);
      CHECK_THROWS_AS(write(series, chunk_of(1, 20 * second, command_cdr(7, 2)), {}), files::IoError);
      CHECK(series.message_count() == 3);
      CHECK(series.lost_disk() == 1);
      series.finish("error: full", {});
    }
    CHECK(series.message_count() == 3);
    CHECK(series.lost_disk() == 1);
    const auto end = metadata_of(folder / "run_002.mcap", "sonopose.recording_end");
    CHECK(end.at("recorded") == "0");
    CHECK(end.at("repeated") == "0");
    CHECK(end.at("lost_disk") == "1");
    CHECK(end.at("received") == "1");
  }
}

TEST_CASE("A channel that is added later is in the current file and in those after it") {
  const TemporaryFolder folder;
  SeriesOptions options = options_for(folder / "run.mcap");
  options.is_numbered = true;
  FileSeries series(options);
  series.open();
  CHECK(series.add_channel({"/odom", "cdr", "nav_msgs/msg/Odometry", "ros2msg", "text"}) == 4);
  write(series, chunk_of(4, 1 * second, command_cdr(7, 1)), {});
  series.finish("stopped", {});
  write(series, chunk_of(4, 2 * second, command_cdr(7, 2)), {});
  series.finish("stopped", {});
  CHECK(messages_of(folder / "run_001.mcap").at(0).topic == "/odom");
  CHECK(messages_of(folder / "run_002.mcap").at(0).topic == "/odom");
}

TEST_CASE("A recording passes over the numbers of files that are there") {
  const TemporaryFolder folder;
  SeriesOptions options = options_for(folder / "run.mcap");
  options.is_numbered = true;
  sonopose::test::write_text(folder / "run_002.mcap", "of somebody else");
  sonopose::test::write_text(folder / "run_003.mcap.part", "of somebody else");
  FileSeries series(options);
  for (std::uint64_t i = 1; i <= 3; ++i) {
    write(series, chunk_of(1, i * second, command_cdr(7, i)), {});
    series.finish("stopped", {});
  }
  CHECK(series.files() ==
        std::vector{folder / "run_001.mcap", folder / "run_004.mcap", folder / "run_005.mcap"});
  CHECK(metadata_of(folder / "run_004.mcap", "sonopose.recording")["file_index"] == "2");
}

TEST_CASE("A recording that fails before its first message leaves no file") {
  const TemporaryFolder folder;
  const auto part = folder / "run.mcap.part";
  SECTION("without a message") {
    FileSeries(options_for(folder / "run.mcap")).open();
    CHECK_FALSE(exists(part));
  }
  SECTION("but messages are kept") {
    FileSeries series(options_for(folder / "run.mcap"));
    write(series, chunk_of(1, 1, command_cdr(7, 1)), {});
    CHECK(exists(part));
  }
}

TEST_CASE("A file that cannot begin loses its messages, and counts them") {
  const TemporaryFolder folder;
  FileSeries series(options_for(folder / "run.mcap"));
  sonopose::test::write_text(folder / "run.mcap", "of somebody else");
  CHECK_THROWS_AS(write(series, chunk_of(1, 1, command_cdr(7, 1)), {}), files::IoError);
  CHECK(series.lost_disk() == 1);
  CHECK(series.message_count() == 0);
}

TEST_CASE("The oldest files of a recording are removed") {
  const TemporaryFolder folder;
  SeriesOptions options = options_for(folder / "run.mcap");
  options.is_numbered = true;
  options.max_duration_ns = second;
  sonopose::test::write_text(folder / "run_000.mcap", "of somebody else");

  SECTION("by their number") {
    options.max_files = 2;
    FileSeries series(options);
    for (std::uint64_t i = 1; i <= 4; ++i) write(series, chunk_of(1, 2 * i * second, command_cdr(7, i)), {});
    series.finish("stopped", {});
    CHECK(series.files() == std::vector{folder / "run_003.mcap", folder / "run_004.mcap"});
    CHECK_FALSE(exists(folder / "run_001.mcap"));
    CHECK_FALSE(exists(folder / "run_002.mcap"));
    CHECK(series.removed_files() == 2);
    CHECK(series.message_count() == 4);
    CHECK(metadata_of(folder / "run_004.mcap", "sonopose.recording")["file_index"] == "4");
  }
  SECTION("by their number, and those that someone else has removed do not count") {
    options.max_files = 2;
    FileSeries series(options);
    for (std::uint64_t i = 1; i <= 2; ++i) write(series, chunk_of(1, 2 * i * second, command_cdr(7, i)), {});
    REQUIRE(remove(folder / "run_001.mcap"));
    for (std::uint64_t i = 3; i <= 4; ++i) write(series, chunk_of(1, 2 * i * second, command_cdr(7, i)), {});
    series.finish("stopped", {});
    CHECK_FALSE(exists(folder / "run_002.mcap"));
    CHECK(series.removed_files() == 1);
  }
  SECTION("by their size, together with the one that is being written") {
    options.max_total_bytes = 20'000;
    const std::vector<std::byte> data(1'000);
    FileSeries series(options);
    std::uint64_t max_bytes = 0;
    for (std::uint64_t i = 1; i <= 40; ++i) {
      write(series, chunk_of(1, 2 * i * second, data), {});
      std::uint64_t bytes = 0;
      for (const auto& file : series.files()) bytes += file_size(file);
      max_bytes = std::max(max_bytes, bytes + file_size(series.part()));
    }
    series.finish("stopped", {});
    CHECK(max_bytes <= 20'000);
    CHECK(max_bytes > 10'000);
    CHECK(series.files().size() + series.removed_files() == 40);
  }
  CHECK(exists(folder / "run_000.mcap"));
}

SCENARIO("The limits can include the files of earlier recordings") {
  const TemporaryFolder folder;
  const auto make = [&folder](const char* name, int age_h) {
    sonopose::test::write_text(folder / name, std::string(4'000, 'x'));
    last_write_time(folder / name, std::filesystem::file_time_type::clock::now() - std::chrono::hours(age_h));
  };
  GIVEN("two files of an earlier recording, an interrupted one, and others") {
    make("run_007.mcap", 3);
    make("run_002.mcap", 2);
    make("run_003.mcap.part", 1);
    make("run.mcap", 9);
    make("runs_001.mcap", 9);
    make("run_ros2_001.mcap", 9);
    make("run_001.txt", 9);
    SeriesOptions options = options_for(folder / "run.mcap");
    options.is_numbered = true;
    options.earlier = find_earlier_files(folder / "run.mcap", false);
    WHEN("a recording of this name may have two files") {
      options.max_files = 2;
      FileSeries series(options);
      write(series, chunk_of(1, second, command_cdr(7, 1)), {});
      series.finish("stopped", {});
      THEN("the oldest ones of this name are removed, and nothing else") {
        CHECK_FALSE(exists(folder / "run_007.mcap"));
        CHECK_FALSE(exists(folder / "run_002.mcap"));
        CHECK(exists(folder / "run_003.mcap.part"));
        CHECK(exists(folder / "run.mcap"));
        CHECK(exists(folder / "runs_001.mcap"));
        CHECK(exists(folder / "run_ros2_001.mcap"));
        CHECK(exists(folder / "run_001.txt"));
        CHECK(series.files() == std::vector{folder / "run_001.mcap"});
        CHECK(metadata_of(folder / "run_001.mcap", "sonopose.recording")["file_index"] == "1");
      }
    }
  }
  GIVEN("a recording that is named by its time, and one of another day") {
    make("sonopose_2026-11-29_10-00-00_001.mcap", 2);
    const auto today = folder / "sonopose_2026-11-30_08-30-00.mcap";
    THEN("both have one name") {
      CHECK(find_earlier_files(today, true).size() == 1);
      CHECK(find_earlier_files(today, false).empty());
    }
  }
}

}  // namespace sonopose::recorder::test::file_series_test
