/// sonopose-play: a recording on the bus again.

#include "mcap/file_sink.hpp"
#include "mcap/writer.hpp"
#include "recorder/instance_end.hpp"
#include "recorder/messages.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"
#include "support/terminal_process.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <csignal>
#include <cstring>
#include <map>
#include <tuple>

namespace play_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
using recorder::test::messages_of;
using recorder::test::OwnedMessage;
namespace topics = dds::topics;
namespace fs = std::filesystem;

/// A recorder that waits for nothing; it records when this returns.
std::unique_ptr<Process> start_recording(const Bus& bus, const fs::path& file, const std::string& names) {
  auto process = bus.record({file.string(), "--topics", names});
  REQUIRE(process->wait_for_line(Stream::error, "recording "));
  return process;
}

/// A recording of a fusion with two beacons of the simulator.
void record_run(const fs::path& file, const std::string& names) {
  const Bus bus;
  const auto record = start_recording(bus, file, names);
  const auto fusion = bus.fusion();
  REQUIRE(bus.bridge({"--duration", "4", "--beacons", "2"})->wait_for_exit() == 0);
  REQUIRE(fusion->end_by(SIGTERM).code == 0);
  REQUIRE(record->end_by(SIGINT).code == 0);
}

/// What a player must keep of a message: all but its arrival. Of one beacon and topic, in order.
using Kept =
    std::map<std::pair<std::string, int>, std::vector<std::pair<std::uint64_t, std::vector<std::byte>>>>;

Kept kept_of(const std::vector<OwnedMessage>& messages) {
  Kept kept;
  for (const OwnedMessage& message : messages) {
    if (message.topic == recorder::instance_ends_topic) continue;
    kept[{message.topic, topics::beacon_of(message.data).value_or(0)}].emplace_back(message.publish_time_ns,
                                                                                    message.data);
  }
  return kept;
}

/// The explicit ends of instances, by topic and beacon, with their kind.
std::vector<std::tuple<std::string, int, bool>> ends_of(const std::vector<OwnedMessage>& messages) {
  std::vector<std::tuple<std::string, int, bool>> ends;
  for (const OwnedMessage& message : messages) {
    if (message.topic != recorder::instance_ends_topic) continue;
    const auto end = recorder::instance_end_of(message.text());
    ends.emplace_back(end.topic, topics::beacon_of(end.key_cdr).value_or(0), end.disposed);
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

SCENARIO("what is played is what was recorded") {
  GIVEN("a recording of a run") {
    const TemporaryFolder folder;
    const std::string names = "imu,fix,heading,pose,report,truth";
    record_run(folder / "first.mcap", names);
    const auto recorded = messages_of(folder / "first.mcap");
    const Arguments rate = GENERATE(Arguments{"--rate", "1"}, Arguments{"--rate", "0"});
    WHEN("it is played in another domain and recorded again") {
      const Bus bus;
      const auto record = start_recording(bus, folder / "second.mcap", names);
      Arguments arguments{(folder / "first.mcap").string()};
      arguments.insert(arguments.end(), rate.begin(), rate.end());
      const auto play = bus.play(arguments);
      REQUIRE(play->wait_for_exit() == 0);
      REQUIRE(record->end_by(SIGINT).code == 0);
      const auto again = messages_of(folder / "second.mcap");
      THEN("it has the same messages with the same stamps, and the same instances end") {
        CHECK(kept_of(recorded).size() == 12 + 3);  // and the settings of both beacons, and of all
        CHECK((kept_of(again) == kept_of(recorded)));
        CHECK(ends_of(again) == ends_of(recorded));
        CHECK_THAT(play->text(Stream::output),
                   Contains("played " + std::to_string(recorded.size()) + " messages in "));
      }
      if (rate.back() == "1") {
        THEN("the messages came at the recorded times") {
          const auto span_s = [](const std::vector<OwnedMessage>& messages) {
            return static_cast<double>(messages.back().log_time_ns - messages.front().log_time_ns) * 1e-9;
          };
          CHECK(span_s(again) == Approx(span_s(recorded)).margin(0.5));
        }
      }
    }
  }
}

SCENARIO("a fusion computes the same poses from played inputs") {
  GIVEN("a recording of the inputs and the poses of a run") {
    const TemporaryFolder folder;
    record_run(folder / "run.mcap", "imu,fix,heading,pose");
    WHEN("the inputs are played to another fusion") {
      const Bus bus;
      const auto fusion = bus.fusion();
      Consumer<sonopose_FusedPose> poses(bus, topics::pose);
      REQUIRE(poses.wait_for_writers());
      REQUIRE(bus.play({(folder / "run.mcap").string(), "--topics", "imu,fix,heading"})->wait_for_exit() ==
              0);
      fusion->end_by(SIGTERM);
      poses.take();
      THEN("position and orientation of each pose are the same bits") {
        using Bits = std::array<std::uint64_t, 7>;
        // By the IDL they follow the address with its padding, the event's number, and the time.
        constexpr std::size_t begin = 4 + 8 + 8 + 8;
        std::map<std::pair<int, std::uint64_t>, Bits> recorded;
        for (const OwnedMessage& message : messages_of(folder / "run.mcap")) {
          if (message.topic != "sonopose/pose") continue;
          std::uint64_t number = 0;
          std::memcpy(&number, message.data.data() + 12, sizeof number);
          Bits& bits = recorded[{topics::beacon_of(message.data).value_or(0), number}];
          std::memcpy(bits.data(), message.data.data() + begin, sizeof bits);
        }
        std::map<int, std::size_t> recorded_of;
        for (const auto& [key, bits] : recorded) ++recorded_of[key.first];
        std::map<int, std::size_t> equal_of;
        for (const FusedPose& pose : poses.samples) {
          const auto found = recorded.find({pose.address, pose.sequence});
          if (found == recorded.end()) continue;
          const std::array<double, 7> values{pose.position_world_m.x(), pose.position_world_m.y(),
                                             pose.position_world_m.z(), pose.q_body_to_world.w(),
                                             pose.q_body_to_world.x(),  pose.q_body_to_world.y(),
                                             pose.q_body_to_world.z()};
          equal_of[pose.address] += std::bit_cast<Bits>(values) == found->second ? 1U : 0U;
        }
        CHECK(recorded.size() > 700);
        CHECK(poses.samples.size() >= recorded.size());
        // The bridge may have sent a beacon's first sample when it knew the fusion, but not yet the recorder.
        // Then all poses of that beacon differ.
        bool has_whole = false;
        for (const auto& [beacon, count] : recorded_of) {
          CHECK((equal_of[beacon] == count || equal_of[beacon] == 0));
          has_whole = has_whole || equal_of[beacon] == count;
        }
        CHECK(has_whole);
      }
    }
  }
}

SCENARIO("a part of a recording is played, as often and when it is asked for") {
  GIVEN("a recording, and a reader of IMU samples") {
    const TemporaryFolder folder;
    record_run(folder / "run.mcap", "imu,fix");
    const std::string file = (folder / "run.mcap").string();
    const auto recorded = messages_of(file);
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    WHEN("the time is limited") {
      REQUIRE(
          bus.play({file, "--start", "1", "--end", "2", "--topics", "imu", "--rate", "2"})->wait_for_exit() ==
          0);
      imu.take();
      THEN("only that time comes") {
        const auto begin = recorded.front().log_time_ns;
        const auto expected =
            std::count_if(recorded.begin(), recorded.end(), [&](const OwnedMessage& message) {
              return message.topic == "sonopose/imu" && message.log_time_ns >= begin + 1'000'000'000 &&
                     message.log_time_ns <= begin + 2'000'000'000;
            });
        CHECK(imu.samples.size() == static_cast<std::size_t>(expected));
      }
    }
    WHEN("the times are moved to now") {
      REQUIRE(bus.play({file, "--end", "1", "--restamp"})->wait_for_exit() == 0);
      imu.take();
      THEN("each sample has the age that it had") {
        REQUIRE(imu.samples.size() > 50);
        for (std::size_t i = 0; i < imu.samples.size(); ++i) {
          const double age_s = static_cast<double>(imu.received_ns[i] - imu.samples[i].bridge_time_ns) * 1e-9;
          CHECK(age_s < 2.0);  // taken at the end
          CHECK(age_s > -0.1);
        }
      }
    }
    WHEN("it is repeated") {
      const auto play = bus.play({file, "--end", "0.5", "--rate", "5", "--loop"});
      THEN("it begins again until it is stopped") {
        CHECK(imu.wait_for_count(300));
        CHECK(play->end_by(SIGINT).code == 0);
      }
    }
  }
}

SCENARIO("keys pause a player and play single messages") {
  GIVEN("a recording that is played on a terminal to a reader of IMU samples") {
    const TemporaryFolder folder;
    record_run(folder / "run.mcap", "imu");
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    TerminalProcess play(
        SONOPOSE_TEST_PLAY,
        {(folder / "run.mcap").string(), "--domain", std::to_string(bus.domain_id()), "--loop"}, 200);
    REQUIRE(play.wait_for("space: pause and go on"));
    REQUIRE(imu.wait_for_count(20));
    WHEN("it is paused, and told three times to play one message") {
      play.type(" ");
      REQUIRE(play.wait_for("paused at "));
      const auto reached = [&imu] {
        imu.take();
        return imu.samples.size();
      };
      // Until nothing is on its way.
      while (imu.wait_for_count(imu.samples.size() + 1, std::chrono::milliseconds(300))) continue;
      const std::size_t before = reached();
      play.type("s.s");
      REQUIRE(imu.wait_for_count(before + 3));
      THEN("these come, and after the pause the others") {
        CHECK(reached() == before + 3);
        play.type(" ");
        CHECK(play.wait_for("playing at "));
        CHECK(imu.wait_for_more(100));
        AND_THEN("q ends it, and the terminal is as before") {
          CHECK_FALSE(play.has_normal_line());
          play.type("q");
          CHECK(play.wait_for_exit() == 0);
          CHECK(play.has_normal_line());
        }
      }
    }
  }
}

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
    const auto bytes = recorder::test::command_cdr(7, 1);
    writer.write({reset, 1, 1'000'000'000, 1, bytes});
    writer.write({reset, 2, 2'000'000'000, 2, std::span(bytes).first(9)});
    writer.close();
  }
  CHECK_THAT(refused({(folder / "none.mcap").string()}), Contains("none.mcap"));
  CHECK_THAT(refused({file, "--topics", "pose"}), Contains("has no topic sonopose/pose"));
  CHECK_THAT(refused({file, "--topics", "poses"}), Contains("did you mean pose?"));
  CHECK_THAT(refused({file, "--start", "5"}),
             Contains("has no messages from 5 s on; its last one is at 1.000 s"));
  CHECK_THAT(refused({file, "--rate", "-1"}), Contains("--rate"));
  write_text(folder / "text.mcap", "no recording");
  CHECK_THAT(refused({(folder / "text.mcap").string()}), Contains("text.mcap"));

  const Bus bus;
  const auto play = bus.play({file, "--no-wait", "--rate", "100"});
  CHECK(play->wait_for_exit() == 1);
  CHECK_THAT(
      play->text(Stream::error),
      Contains("sonopose/imu is not played: its type is not sonopose::ImuSample but sonopose::Other") &&
          Contains("other/reset is not played: it is no topic of this program"));
  CHECK_THAT(
      play->text(Stream::output),
      Contains("played 1 messages") && Contains("refused: 1 messages that are not of their topic's type"));
}

}  // namespace play_test
