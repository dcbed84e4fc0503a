#include "recorder/write_thread.hpp"

#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "recorder/messages.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

namespace sonopose::recorder::test::write_thread_test {

using sonopose::test::TemporaryFolder;

constexpr std::int64_t second = 1'000'000'000;
constexpr std::uint16_t settings_channel = 1;
constexpr std::uint16_t reset_channel = 2;

SeriesOptions options_for(const std::filesystem::path& file) {
  return {.file = file,
          .writer = {.compression = mcap::Compression::none},
          .channels = {{"sonopose/settings", "cdr", "sonopose::EffectiveSettings", "omgidl", "idl", {}, true},
                       {"sonopose/reset", "cdr", "sonopose::ResetCommand", "omgidl", "idl"}},
          .about = {}};
}

mcap::Chunk chunk_of(std::uint16_t channel_id, std::int64_t log_time_ns, const std::vector<std::byte>& data) {
  mcap::Chunk chunk;
  const auto time_ns = static_cast<std::uint64_t>(log_time_ns);
  chunk.add({channel_id, 1, time_ns, time_ns, data});
  return chunk;
}

constexpr TapCounts lost_before{.received = 50, .lost_queue = 40};

/// The last two of five seconds, which ended `age_s` ago; the first second has settings.
LastSeconds last_seconds(FileSeries& series, std::int64_t age_s) {
  LastSeconds last(2 * second, 1U << 20U);
  const SteadyTime now = clocks::steady_now() + -age_s * second;
  const auto taken_at = [now](std::int64_t time_s) {
    const SteadyTime at = now + (time_s - 5) * second;
    return ArrivalSpan{at, at};
  };
  last.add(chunk_of(settings_channel, 1 * second, command_cdr(7, 1)), taken_at(1));
  for (int t = 2; t <= 5; ++t) {
    for (const auto& dropped :
         last.add(chunk_of(reset_channel, t * second, command_cdr(7, 2)), taken_at(t), lost_before)) {
      series.remember(dropped);
    }
  }
  return last;
}

SCENARIO("what is kept in memory is written by a trigger") {
  GIVEN("the last seconds in memory") {
    const TemporaryFolder folder;
    const auto file = folder / "run.mcap";
    ChunkQueue queue(1U << 20U);
    FileSeries series(options_for(file));
    EventGaps gaps(series.input_channel_ids());
    Trigger trigger;
    process::Wakeup failed;
    const std::int64_t age_s = GENERATE(0, 60);
    WriteThread thread({.queue = queue,
                        .series = series,
                        .gaps = gaps,
                        .trigger = trigger,
                        .counts = [] { return lost_before; },
                        .last = last_seconds(series, age_s),
                        .failed = failed});
    thread.start();
    const auto trigger_and_finish = [&] {
      REQUIRE(queue.add({reset_channel, 9, 6 * second, 6 * second, command_cdr(7, 9)}));
      trigger.fire(TriggerCause::topic);
      thread.finish();
    };
    if (age_s > 0) {
      WHEN("a trigger comes, and no message has come since") {
        trigger.fire(TriggerCause::topic);
        thread.finish();
        THEN("what is older than the seconds that are kept is not written") {
          CHECK(series.files().empty());
        }
      }
      return;
    }
    WHEN("the disk takes them") {
      trigger_and_finish();
      THEN("the file begins with the settings from before them, and has what fired the trigger") {
        CHECK_FALSE(thread.failure());
        const auto messages = messages_of(file);
        REQUIRE(messages.size() == 4);
        CHECK(messages.front().topic == "sonopose/settings");
        CHECK(messages.front().log_time_ns == messages.at(1).log_time_ns);
        CHECK(messages.front().publish_time_ns == 1 * second);
        CHECK(messages.back().sequence == 9);
        CHECK(series.lost_disk() == 0);
      }
      THEN("what was lost before them does not count as lost in the file") {
        CHECK(metadata_of(file, "sonopose.recording_end").at("lost_queue") == "0");
      }
    }
    WHEN("no file can begin") {
      sonopose::test::write_text(file, "of somebody else");
      trigger_and_finish();
      THEN("all of them are counted as lost") {
        REQUIRE(thread.failure());
        CHECK_THROWS_AS(std::rethrow_exception(thread.failure()), files::IoError);
        CHECK(series.lost_disk() == 3);
        CHECK(series.message_count() == 0);
      }
    }
  }
}

}  // namespace sonopose::recorder::test::write_thread_test
