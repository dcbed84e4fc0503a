#include "bus_log/copy.hpp"

#include "bus_log/instance_end.hpp"
#include "bus_log/recorded.hpp"
#include "bus_log/sensor_log.hpp"
#include "bus_log/summary.hpp"
#include "evaluation/replay/run.hpp"
#include "evaluation/report/exported.hpp"
#include "mcap/compression.hpp"
#include "mcap/encoder.hpp"
#include "mcap/verify.hpp"
#include "sim/simulator.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

namespace sonopose::copy_test {

using namespace sonopose::bus_log;
using Catch::Contains;
using sonopose::test::BusRecording;
using sonopose::test::read_text;
using sonopose::test::TemporaryFolder;
using sonopose::test::write_text;
using Path = std::filesystem::path;

/// Records ten seconds of a beacon with truth and a metadata record; returns the events.
std::vector<Event> record_walk(const Path& file, BeaconAddress address) {
  auto simulated = sim::record(sim::find_scenario("walk"), {.duration_s = 10.0});
  BusRecording recording(file);
  recording.writer().write_metadata({"sonopose.recording", {{"beacon", std::to_string(address)}}});
  for (Event& event : simulated.events) {
    std::visit([address](auto& sample) { sample.address = address; }, event);
    recording.write(event, static_cast<std::uint64_t>(available_at_ns(event)));
    if ((sequence_of(event) % 100) == 0) recording.writer().end_chunk();
  }
  FusedPose pose;
  pose.address = address;
  pose.time_ns = available_at_ns(simulated.events.back());
  recording.write(dds::topics::pose, dds::topics::to_idl(pose), static_cast<std::uint64_t>(pose.time_ns));
  return simulated.events;
}

SCENARIO("messages of a recording are selected") {
  const TemporaryFolder folder;
  const Path file = folder / "run.mcap";
  const auto events = record_walk(file, 12);
  GIVEN("one topic, and the seconds from the second to the third") {
    const auto result = copy({{file}, folder / "some.mcap", {{"imu"}, {}, 2.0, 3.0}});
    THEN("the new file has these, and the metadata") {
      const mcap::Reader reader(folder / "some.mcap");
      CHECK(result.messages == 101);  // 100 Hz, both ends included
      CHECK(reader.statistics().message_count == 101);
      CHECK(reader.channels().size() == 1);
      CHECK(reader.schemas().at(1).name == "sonopose::ImuSample");
      CHECK(reader.metadata().size() == 1);
    }
  }
  GIVEN("another beacon") {
    THEN("there is nothing of it") {
      CHECK_THROWS_WITH(copy({{file}, folder / "none.mcap", {{}, 7}}),
                        Contains("run.mcap: no selected message belongs to beacon 7; they belong to 12"));
      CHECK_FALSE(exists(folder / "none.mcap"));
    }
  }
  GIVEN("a reset of all beacons beside those of others, and the choice of one beacon") {
    const Path with_resets = folder / "resets.mcap";
    {
      BusRecording recording(with_resets);
      for (const BeaconAddress address : {BeaconAddress{7}, BeaconAddress{12}, all_beacons}) {
        recording.write(dds::topics::reset, {.address = address, .request_id = 1}, 5);
      }
    }
    THEN("the new file has what concerns that beacon") {
      CHECK(copy({{with_resets}, folder / "of_12.mcap", {{}, 12}}).messages == 2);
    }
    THEN("a beacon of which there is nothing else is refused, with those that exist") {
      CHECK_THROWS_WITH(copy({{with_resets}, folder / "of_9.mcap", {{}, 9}}),
                        Contains("no selected message belongs to beacon 9; they belong to 7, 12"));
      CHECK_FALSE(exists(folder / "of_9.mcap"));
    }
  }
  GIVEN("a topic that the file does not have") {
    THEN("the error lists those that it has, and there is no new file") {
      CHECK_THROWS_WITH(copy({{file}, folder / "none.mcap", {{"imus"}}}),
                        Contains("has no topic imus; it has ") && Contains("sonopose/imu"));
      CHECK_FALSE(exists(folder / "none.mcap"));
    }
  }
  GIVEN("a channel without messages") {
    Path with_more = folder / "more.mcap";
    {
      BusRecording recording(with_more);
      recording.writer().add_channel(0, "sonopose/empty", "cdr");
      recording.write(events.front(), 5);
    }
    THEN("the new file has the channel, and no part is left") {
      const auto result = copy({.inputs = {with_more}, .output = folder / "new.mcap"});
      CHECK_FALSE(exists(folder / "new.mcap.part"));
      CHECK(result.messages == 1);
      CHECK(result.attachments == 0);
      const mcap::Reader reader(folder / "new.mcap");
      CHECK(std::ranges::any_of(reader.channels(),
                                [](const auto& each) { return each.second.topic == "sonopose/empty"; }));
    }
    THEN("a name that is taken by what somebody writes is refused") {
      write_text(folder / "new.mcap.part", "precious");
      CHECK_THROWS_WITH(copy({.inputs = {with_more}, .output = folder / "new.mcap"}),
                        Contains("new.mcap.part: exists"));
      CHECK(read_text(folder / "new.mcap.part") == "precious");
      CHECK_FALSE(exists(folder / "new.mcap"));
    }
  }
  GIVEN("messages whose log times go back") {
    {
      BusRecording recording(folder / "back.mcap");
      recording.write(events[0], 5'000);
      recording.writer().end_chunk();
      recording.write(events[1], 3'000);
    }
    THEN("their order is kept") {
      copy({.inputs = {folder / "back.mcap"}, .output = folder / "new.mcap"});
      const mcap::Reader reader(folder / "new.mcap");
      mcap::Messages messages(reader, {.channel = {}, .order = mcap::Selection::Order::file});
      CHECK(messages.next()->log_time_ns == 5'000);
      CHECK(messages.next()->log_time_ns == 3'000);
    }
  }
  GIVEN("an attachment") {
    {
      BusRecording recording(folder / "plan.mcap");
      mcap::Bytes content;
      mcap::put(content, std::uint64_t{5});  // log_time
      mcap::put(content, std::uint64_t{4});  // create_time
      mcap::put_text(content, "plan.png");
      mcap::put_text(content, "image/png");
      mcap::put(content, std::uint64_t{3});
      mcap::put_bytes(content, std::as_bytes(std::span("abc", 3)));
      mcap::put(content, mcap::crc32(content));
      recording.writer().write_attachment(content);
      for (std::size_t i = 0; i < 20; ++i) recording.write(events[i], 1'000 * i);
    }
    THEN("a part of the recording keeps it") {
      const auto result =
          copy({{folder / "plan.mcap"}, folder / "part.mcap", {{}, {}, std::uint64_t{9'000}}});
      CHECK(result.messages == 11);
      CHECK(result.attachments == 1);
      const mcap::Reader reader(folder / "part.mcap");
      CHECK(reader.contents().is_indexed);
      const mcap::Reader whole(folder / "plan.mcap");
      CHECK(reader.attachment(reader.contents().attachments.at(0)) ==
            whole.attachment(whole.contents().attachments.at(0)));
      CHECK(mcap::verify(reader).empty());
    }
    THEN("a damaged one is named, and only a repair leaves it out") {
      std::string damaged = read_text(folder / "plan.mcap");
      damaged[damaged.find("abc")] = 'X';
      write_text(folder / "damaged.mcap", damaged);
      CopyRequest request{{folder / "damaged.mcap"}, folder / "good.mcap"};
      CHECK_THROWS_WITH(copy(request), Contains("Attachment crc does not match"));
      request.damaged = mcap::Selection::Damaged::skip;
      const auto result = copy(request);
      CHECK(result.messages == 20);
      CHECK(result.attachments == 0);
      CHECK_THAT(result.damages.at(0), Contains("Attachment crc does not match"));
    }
  }
  GIVEN("a file that exists") {
    write_text(folder / "old.mcap", "precious");
    THEN("it is not overwritten") {
      CHECK_THROWS_WITH(copy({{file}, folder / "old.mcap"}), Contains("old.mcap") && Contains("exists"));
      CHECK(read_text(folder / "old.mcap") == "precious");
    }
  }
}

/// Logs where a stationary beacon is.
void write_position(BusRecording& recording, BeaconAddress address, double x_m, std::uint64_t log_time_ns) {
  const StationaryBeacon beacon{address, 1, Vector3d(x_m, 0.0, 2.0)};
  recording.write(dds::topics::stationary_beacon, dds::topics::to_idl(beacon), log_time_ns);
}

SCENARIO("a part of a recording begins with the state of latched topics") {
  const TemporaryFolder folder;
  GIVEN("stationary beacons before it: one moved, one left, one that stays where it is") {
    const Path file = folder / "run.mcap";
    {
      BusRecording recording(file);
      for (const BeaconAddress address : {BeaconAddress{100}, BeaconAddress{101}, BeaconAddress{102}}) {
        write_position(recording, address, 1.0, 1'000);
      }
      recording.writer().end_chunk();
      write_position(recording, 100, 5.0, 2'000);
      const std::string end =
          json_of({.topic = "sonopose/stationary_beacon",
                   .disposed = true,
                   .key_cdr = dds::write_cdr(dds::topics::to_idl(StationaryBeacon{101, 1, {}})),
                   .source_time_ns = 1});
      mcap::Writer& writer = recording.writer();
      const auto ends = writer.add_channel(0, instance_ends_topic, instance_ends_encoding);
      writer.write({ends, 1, 3'000, 3'000, std::as_bytes(std::span(end))});
      for (std::uint64_t i = 0; i < 10; ++i) recording.write(ImuSample{}, 4'000 + 100 * i);
    }
    const auto part_of = [&](const Choice& choice) {
      std::filesystem::remove(folder / "part.mcap");
      copy({{file}, folder / "part.mcap", choice});
      const mcap::Reader reader(folder / "part.mcap");
      std::vector<std::string> lines;
      ChosenMessages messages(reader, {});
      while (const auto chosen = messages.next()) {
        lines.push_back(std::to_string(chosen->message.log_time_ns) +
                        json_of(*chosen->channel, chosen->message));
      }
      return lines;
    };
    THEN("the latest positions of those that are there come first, at the time of its start") {
      const auto lines = part_of({{}, {}, std::uint64_t{4'500}});
      REQUIRE(lines.size() == 2 + 5);
      CHECK_THAT(lines[0], Catch::StartsWith("4500") && Contains("\"address\":100") && Contains("5.0"));
      CHECK_THAT(lines[1], Catch::StartsWith("4500") && Contains("\"address\":102"));
      CHECK_THAT(lines[2], Catch::StartsWith("4500") && Contains("sonopose/imu"));
    }
    THEN("topics that are not chosen are left out") {
      CHECK(part_of({{"imu"}, {}, std::uint64_t{4'500}}).size() == 5);
      CHECK(part_of({{"/imu"}, {}, std::uint64_t{4'500}}).size() == 5);
      CHECK(part_of({{"stationary_beacon"}, {}, std::uint64_t{4'500}}).size() == 2);
    }
    THEN("a part behind the end has nothing") {
      CHECK_THROWS_WITH(part_of({{}, {}, std::uint64_t{9'000}}), Contains("none of its 15 messages"));
    }
  }
  GIVEN("a topic of ROS 2 that is latched by what its channel offers") {
    const Path file = folder / "ros.mcap";
    {
      mcap::FileSink sink(file);
      mcap::Writer writer(sink, {.profile = "ros2"});
      const auto add = [&writer](const char* topic, const char* durability) {
        return writer.add_channel(0, topic, "cdr",
                                  {{"offered_qos_profiles", std::string("- depth: 1\n  durability: ") +
                                                                durability + "\n  deadline:"}});
      };
      const auto map = add("/map", "transient_local");
      const auto tf_static = add("/tf_static", "1");
      const auto odom = add("/odom", "2");
      for (const auto id : {map, tf_static, odom}) writer.write({id, 1, 10, 10, {}});
      for (std::uint64_t i = 2; i < 5; ++i) writer.write({odom, 1, 10 * i, 10 * i, {}});
    }
    THEN("its latest message comes first") {
      CHECK(copy({{file}, folder / "part.mcap", {{}, {}, std::uint64_t{35}}}).messages == 3);
    }
    THEN("static transforms are latched also where the file does not say") {
      const Path plain = folder / "plain.mcap";
      {
        mcap::FileSink sink(plain);
        mcap::Writer writer(sink, {.profile = "ros2"});
        const auto tf_static = writer.add_channel(0, "/tf_static", "cdr");
        const auto odom = writer.add_channel(0, "/odom", "cdr");
        writer.write({tf_static, 1, 10, 10, {}});
        for (std::uint64_t i = 1; i < 5; ++i) writer.write({odom, 1, 10 * i, 10 * i, {}});
      }
      CHECK(copy({{plain}, folder / "part.mcap", {{}, {}, std::uint64_t{35}}}).messages == 2);
    }
    THEN("it is chosen with and without its slash") {
      CHECK(copy({{file}, folder / "with.mcap", {{"/map"}}}).messages == 1);
      CHECK(copy({{file}, folder / "without.mcap", {{"map"}}}).messages == 1);
    }
  }
}

SCENARIO("recordings are merged") {
  const TemporaryFolder folder;
  GIVEN("recordings without messages") {
    for (const char* const name : {"a.mcap", "b.mcap"}) BusRecording(folder / name).close();
    THEN("the error names all of them") {
      CHECK_THROWS_WITH(copy({{folder / "a.mcap", folder / "b.mcap"}, folder / "both.mcap"}),
                        Contains("a.mcap, ") && Contains("b.mcap: none of their 0 messages"));
    }
  }
  GIVEN("recordings of two beacons at the same time") {
    const auto first = record_walk(folder / "a.mcap", 12);
    record_walk(folder / "b.mcap", 300);
    WHEN("they are merged") {
      const auto result = copy({{folder / "a.mcap", folder / "b.mcap"}, folder / "both.mcap"});
      THEN("the new file has both, each topic once, and each beacon reads as before") {
        CHECK(result.messages == 2 * (first.size() + 1));
        const mcap::Reader reader(folder / "both.mcap");
        CHECK(reader.channels().size() == 4);
        CHECK(reader.metadata().size() == 2);
        CHECK(read_sensor_log(folder / "both.mcap", 12).events == first);
        CHECK_THROWS_WITH(read_sensor_log(folder / "both.mcap"), Contains("12, 300"));
      }
    }
  }
}

SCENARIO("a damaged recording is repaired") {
  const TemporaryFolder folder;
  const Path file = folder / "run.mcap";
  const auto events = record_walk(file, 12);
  const std::string whole = read_text(file);
  GIVEN("a recording that was cut in the middle") {
    write_text(folder / "cut.mcap", whole.substr(0, whole.size() / 2));
    WHEN("it is repaired") {
      const auto result = copy({.inputs = {folder / "cut.mcap"},
                                .output = folder / "good.mcap",
                                .damaged = mcap::Selection::Damaged::skip});
      THEN("the new file is sound and has what came before the cut") {
        CHECK_THAT(result.damages.at(0), Contains("cut"));
        const mcap::Reader reader(folder / "good.mcap");
        CHECK(reader.damages().empty());
        CHECK(reader.contents().is_indexed);
        const auto log = read_sensor_log(folder / "good.mcap");
        CHECK(log.events.size() > events.size() / 3);
        CHECK(std::equal(log.events.begin(), log.events.end(), events.begin()));
      }
    }
  }
  GIVEN("a recording whose record of metadata is damaged") {
    std::string damaged = whole;
    damaged[mcap::Reader(file).contents().metadata.at(0).offset] ^= 0x40;  // the opcode
    write_text(folder / "damaged.mcap", damaged);
    CopyRequest request{{folder / "damaged.mcap"}, folder / "good.mcap"};
    THEN("it is not copied as if it were whole") {
      CHECK_THROWS_AS(copy(request), mcap::FormatError);
    }
    THEN("all messages are saved, and the record is named") {
      request.damaged = mcap::Selection::Damaged::skip;
      const auto result = copy(request);
      CHECK(result.messages == events.size() + 1);
      CHECK(result.metadata == 0);
      CHECK_THAT(result.damages.at(0), Contains("instead of Metadata"));
    }
    THEN("its summary names what is damaged") {
      const mcap::Reader reader(folder / "damaged.mcap");
      CHECK_THAT(summary_text(reader), Contains("damaged: ") && Contains("instead of Metadata"));
      CHECK_THAT(summary_json(reader), Contains("instead of Metadata"));
    }
  }
  GIVEN("a recording with a damaged byte in a chunk") {
    std::string damaged = whole;
    const auto chunks = mcap::Reader(file).contents().blocks;
    damaged[chunks.at(3).offset + chunks.at(3).length / 2] ^= 0x10;
    const bool is_indexed = GENERATE(true, false);
    CAPTURE(is_indexed);
    if (!is_indexed) damaged.resize(chunks.back().offset + chunks.back().length);
    write_text(folder / "damaged.mcap", damaged);
    const CopyRequest request{{folder / "damaged.mcap"}, folder / "good.mcap"};
    THEN("it is not copied as if it were whole") {
      CHECK_THROWS_AS(copy(request), mcap::FormatError);
      CHECK_FALSE(exists(folder / "good.mcap"));
    }
    THEN("all other chunks are saved") {
      CopyRequest recovering = request;
      recovering.damaged = mcap::Selection::Damaged::skip;
      const auto result = copy(recovering);
      CHECK(result.damages.size() == (is_indexed ? 1 : 2));  // without the index, also the cut end
      CHECK(result.messages > events.size() - 150);
      CHECK(result.messages < events.size());
    }
  }
}

SCENARIO("the part of a recording is kept when it is repaired") {
  GIVEN("what a killed recorder left") {
    const TemporaryFolder folder;
    const Path part = folder / "run.mcap.part";
    record_walk(part, 7);
    WHEN("it is repaired to the name that it would have got") {
      THEN("it is refused, since the copy is first written under that of the part") {
        CHECK_THROWS_WITH(copy({{part}, folder / "run.mcap", {}}), Contains("choose another --out"));
        CHECK(copy({{part}, folder / "repaired.mcap", {}}).messages > 1000);
      }
    }
  }
}

SCENARIO("a recording is exported") {
  const TemporaryFolder folder;
  const auto events = record_walk(folder / "run.mcap", 12);
  GIVEN("its files") {
    const auto result = evaluation::export_recording({folder / "run.mcap"}, {}, folder / "log");
    THEN("the log folder replays to the same state as the recording") {
      CHECK(result.events == events.size());
      const auto log = recording::read_sensor_log(folder / "log");
      CHECK(log.address == 12);
      CHECK(evaluation::run(log, {}).state_hash ==
            evaluation::run(read_sensor_log(folder / "run.mcap"), {}).state_hash);
    }
    THEN("all events mean the same in the folder") {
      CHECK(result.misread == 0);
    }
    THEN("the log folder is no recording to export, and nothing is written") {
      CHECK_THROWS_WITH(evaluation::export_recording({folder / "log"}, {}, folder / "again"),
                        Contains("is a log folder"));
      CHECK_FALSE(exists(folder / "again"));
    }
    THEN("the recorded pose is in TUM format") {
      CHECK(result.poses == 1);
      CHECK_THAT(read_text(folder / "log/trajectory.tum"), Contains(" 0 0 0 1"));
    }
  }
}

TEST_CASE("a recording in a few lines") {
  const TemporaryFolder folder;
  const auto events = record_walk(folder / "run.mcap", 12);
  const mcap::Reader reader(folder / "run.mcap");
  const std::string text = summary_text(reader);
  CHECK_THAT(text, Contains("run.mcap") && Contains("sonopose/imu") && Contains("100.0 Hz") &&
                       Contains("sonopose::ImuSample") && Contains("beacon 12"));
  CHECK_THAT(summary_json(reader), Contains("\"messages\":" + std::to_string(events.size() + 1)));
}

}  // namespace sonopose::copy_test
