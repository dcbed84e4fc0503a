/// sonopose-play: recordings and parts of them that cannot be played.

#include "bus_log/instance_end.hpp"
#include "bus_log/recorded.hpp"
#include "recorder/messages.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"
#include "system/recorded_walk.hpp"

#include <string>

namespace play_refusals_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;

SCENARIO("what cannot be played is named") {
  const TemporaryFolder folder;
  const auto refused = [](const Arguments& arguments) {
    const Result result = run(SONOPOSE_TEST_PLAY, arguments, neutral);
    CHECK(result.code.value_or(0) > 0);
    return result.error;
  };
  const std::string file = (folder / "run.mcap").string();
  {
    mcap::FileSink sink(file);
    mcap::Writer writer(sink);
    const auto good = writer.add_schema("sonopose::ResetCommand", "omgidl", "");
    const auto other = writer.add_schema("sonopose::Other", "omgidl", "");
    const auto reset = writer.add_channel(good, "sonopose/reset", "cdr");
    writer.add_channel(other, "sonopose/imu", "cdr");
    writer.add_channel(good, "other/reset", "cdr");
    const auto wrong = writer.add_channel(other, "sonopose/reset", "cdr");
    const auto changed = writer.add_schema("sonopose::UltrasonicFix", "omgidl",
                                           "module sonopose { struct UltrasonicFix { long a; }; };");
    writer.add_channel(changed, "sonopose/fix", "cdr");
    const auto bytes = recorder::test::command_cdr(7, 1);
    writer.write({wrong, 1, 1'000'000'000, 1, bytes});
    writer.write({reset, 1, 1'000'000'000, 1, bytes});
    writer.write({reset, 2, 2'000'000'000, 2, std::span(bytes).first(9)});
    writer.add_channel(writer.add_schema("sonopose::SettingsRequest", "omgidl", ""),
                       "sonopose/settings_request", "cdr");
    const auto end_schema =
        writer.add_schema(std::string(bus_log::instance_end_schema_name), "jsonschema", "");
    const auto ends = writer.add_channel(end_schema, std::string(bus_log::instance_ends_topic), "json");
    const std::string end =
        R"({"topic": "sonopose/pose", "kind": "disposed", "key_cdr": "", "source_time_ns": 1})";
    writer.write({ends, 1, 1'000'000'000, 1, std::as_bytes(std::span(end))});
    writer.close();
  }
  CHECK_THAT(refused({(folder / "none.mcap").string()}), Contains("none.mcap"));
  CHECK_THAT(refused({file, "--topics", "pose"}), Contains("has no topic sonopose/pose"));
  CHECK_THAT(refused({file, "--topics", "/pose"}), Contains("has no topic sonopose/pose"));
  CHECK_THAT(refused({file, "--topics", "poses"}), Contains("did you mean pose?"));
  CHECK_THAT(refused({file, "--start", "5"}),
             Contains("has no messages from 5 s on; its last one is at 1.000 s"));
  CHECK_THAT(refused({file, "--start", "0.9", "--end", "0.5"}),
             Contains("the end, 0.5 s, is before the start, 0.9 s"));
  CHECK_THAT(refused({file, "--rate", "-1"}), Contains("--rate"));
  write_text(folder / "text.mcap", "no recording");
  CHECK_THAT(refused({(folder / "text.mcap").string()}), Contains("text.mcap"));

  const Bus bus;
  const auto nothing = bus.play({file, "--no-wait", "--topics", "settings_request"});
  CHECK(nothing->wait_for_exit() == 1);
  CHECK_THAT(nothing->text(Stream::error), Contains("has no messages of these topics at these times"));
  const auto play = bus.play({file, "--no-wait", "--rate", "100"});
  CHECK(play->wait_for_exit() == 1);
  CHECK_THAT(
      play->text(Stream::error),
      Contains("sonopose/imu is not played: its type is not sonopose::ImuSample but sonopose::Other") &&
          Contains("other/reset is not played: it is not a topic of this program") &&
          Contains(
              "sonopose/reset is not played: its type is not sonopose::ResetCommand but sonopose::Other") &&
          Contains("sonopose/fix is not played: its type sonopose::UltrasonicFix differs"));
  CHECK_THAT(play->text(Stream::output),
             Contains("played 1 message in") && Contains("refused (wrong type for the topic): 2 messages"));
}

SCENARIO("a damaged chunk is left out and named") {
  const bool is_indexed = GENERATE(true, false);
  GIVEN("a recording with a wrong byte in one of its chunks, with or without an index, and a reader") {
    const TemporaryFolder folder;
    const std::string file = folder / "run.mcap";
    {
      BusRecording recording(file, std::endian::little, {.chunk_size_bytes = 10'000});
      for (const Event& event : walk(2.0)) {
        recording.write(event, static_cast<std::uint64_t>(available_at_ns(event)));
      }
    }
    std::string text = read_text(file);
    const auto chunks = mcap::Reader(file).contents().blocks;
    REQUIRE(chunks.size() > 2);
    const mcap::Block& chunk = chunks[1];
    text[chunk.offset + chunk.length / 2] ^= 0x10;
    if (!is_indexed) text.resize(chunks.back().offset + chunks.back().length);
    write_text(folder / "damaged.mcap", text);
    const Bus bus;
    WHEN("it is played") {
      const auto play = bus.play({(folder / "damaged.mcap").string(), "--no-wait", "--rate", "0"});
      THEN("the exit code says that not all of it was played") {
        CHECK(play->wait_for_exit() == 1);
        CHECK_THAT(play->text(Stream::output), Contains("not played: 1 damaged chunk"));
      }
    }
  }
}

}  // namespace play_refusals_test
