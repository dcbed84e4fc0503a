/// sonopose-play: a recording published again.

#include "bus_log/instance_end.hpp"
#include "bus_log/recorded.hpp"
#include "recorder/messages.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"
#include "system/recorded_part.hpp"
#include "system/recorded_walk.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>

namespace sonopose::play_test {

using namespace sonopose::test;
using Catch::Contains;
using recorder::test::messages_of;
using recorder::test::OwnedMessage;
namespace topics = dds::topics;
namespace fs = std::filesystem;

/// Time at which the event of that number was available.
TimeNs bridge_time_of(const std::vector<Event>& events, std::uint64_t sequence) {
  const auto found = std::find_if(events.begin(), events.end(),
                                  [&](const Event& event) { return sequence_of(event) == sequence; });
  REQUIRE(found != events.end());
  return available_at_ns(*found);
}

TimeNs host_now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Message content that a player must preserve: everything but the arrival. By topic and beacon, in order.
using Kept =
    std::map<std::pair<std::string, int>, std::vector<std::pair<std::uint64_t, std::vector<std::byte>>>>;

Kept kept_of(const std::vector<OwnedMessage>& messages) {
  Kept kept;
  for (const OwnedMessage& message : messages) {
    if (message.topic == bus_log::instance_ends_topic) continue;
    kept[{message.topic, topics::beacon_of(message.data).value_or(0)}].emplace_back(message.publish_time_ns,
                                                                                    message.data);
  }
  return kept;
}

/// Topics of a beacon in a recorded run: six of each of two beacons, and the settings of both and of all.
constexpr std::size_t recorded_streams = 2 * 6 + 3;

/// Records a fusion with two beacons of the simulator until there are messages of all topics.
void record_run(const fs::path& file, const std::string& names) {
  const Bus bus;
  const auto record = start_recording(bus, file, {"--topics", names});
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--rate", "4", "--beacons", "2"});
  REQUIRE(
      wait_for_part(file, [](const auto& messages) { return kept_of(messages).size() == recorded_streams; }));
  REQUIRE(bridge->end_by(SIGINT).code == 0);
  REQUIRE(fusion->end_by(SIGTERM).code == 0);
  REQUIRE(record->end_by(SIGINT).code == 0);
}

/// Ended instances, by topic and beacon: true if disposed. Instances that were disposed may also have lost
/// their writers before, where a busy machine let the liveliness of a player expire.
std::map<std::pair<std::string, int>, bool> ends_of(const std::vector<OwnedMessage>& messages) {
  std::map<std::pair<std::string, int>, bool> ends;
  for (const OwnedMessage& message : messages) {
    if (message.topic != bus_log::instance_ends_topic) continue;
    const auto end = bus_log::instance_end_of(message.text());
    bool& disposed = ends[{end.topic, topics::beacon_of(end.key_cdr).value_or(0)}];
    disposed = disposed || end.disposed;
  }
  return ends;
}

SCENARIO("what is played is what was recorded") {
  GIVEN("a recording of a run") {
    const TemporaryFolder folder;
    const std::string names = "imu,fix,heading,pose,report,truth";
    record_run(folder / "first.mcap", names);
    const auto recorded = messages_of(folder / "first.mcap");
    WHEN("it is played in another domain and recorded again") {
      const Bus bus;
      const auto record = start_recording(bus, folder / "second.mcap", {"--topics", names});
      const auto play = bus.play({(folder / "first.mcap").string(), "--rate", "0", "--readers", "1"});
      REQUIRE(play->wait_for_exit() == 0);
      const bool has_all = wait_for_part(folder / "second.mcap", [&](const auto& messages) {
        return kept_of(messages) == kept_of(recorded) && ends_of(messages) == ends_of(recorded);
      });
      REQUIRE(record->end_by(SIGINT).code == 0);
      const auto again = messages_of(folder / "second.mcap");
      THEN("it has the same messages with the same stamps, and the same instances end") {
        CHECK(has_all);
        CHECK(kept_of(recorded).size() == recorded_streams);
        CHECK((kept_of(again) == kept_of(recorded)));
        CHECK((ends_of(again) == ends_of(recorded)));
        CHECK_THAT(play->text(Stream::output),
                   Contains("played " + std::to_string(recorded.size()) + " messages in "));
      }
    }
  }
}

SCENARIO("no message is played before its time") {
  GIVEN("a recording of a second, each sample recorded when it was available") {
    const TemporaryFolder folder;
    const auto events = record_walk(folder / "walk.mcap", 1.0, {7});
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    WHEN("it is played in real time with its times moved to now") {
      const TimeNs before_start_ns = host_now_ns();
      REQUIRE(bus.play({(folder / "walk.mcap").string(), "--topics", "imu", "--restamp"})->wait_for_exit() ==
              0);
      REQUIRE(imu.wait_for_count(1));
      THEN("the first is of the start, none is from the future, and they are as far apart as before") {
        // A stalled reader loses live samples, but none that it has is early.
        CHECK(imu.samples.front().bridge_time_ns >= before_start_ns);
        for (std::size_t i = 0; i < imu.samples.size(); ++i) {
          CHECK(imu.samples[i].bridge_time_ns <= imu.received_ns[i]);
        }
        const TimeNs shift_ns =
            imu.samples.front().bridge_time_ns - bridge_time_of(events, imu.samples.front().sequence);
        for (const ImuSample& sample : imu.samples) {
          CHECK(sample.bridge_time_ns - bridge_time_of(events, sample.sequence) == shift_ns);
        }
      }
    }
    WHEN("it is played in real time") {
      const auto began = std::chrono::steady_clock::now();
      const auto play = bus.play({(folder / "walk.mcap").string()});
      THEN("it takes as long as the recording") {
        REQUIRE(play->wait_for_exit() == 0);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
        const TimeNs span_ns = available_at_ns(events.back()) - available_at_ns(events.front());
        CHECK(took.count() >= static_cast<double>(span_ns) * 1e-9);
      }
    }
  }
}

SCENARIO("a bridge publishes a beacon of a recording") {
  GIVEN("a recording of two beacons, and readers of their inputs") {
    const TemporaryFolder folder;
    const std::string file = folder / "run.mcap";
    const auto events = record_walk(file, 2.0, {7, 8});
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    Consumer<sonopose_UltrasonicFix> fixes(bus, topics::fix);
    Consumer<sonopose_PairHeading> headings(bus, topics::heading);
    WHEN("it publishes one of them as fast as they receive it") {
      const Arguments arguments{"--source", "mcap", "--input", file, "--address", "8", "--rate", "0"};
      REQUIRE(bus.bridge(arguments)->wait_for_exit() == 0);
      THEN("all events of this beacon come") {
        const auto imu_count =
            static_cast<std::size_t>(std::count_if(events.begin(), events.end(), [](const Event& event) {
              return std::holds_alternative<ImuSample>(event);
            }));
        const auto fix_count =
            static_cast<std::size_t>(std::count_if(events.begin(), events.end(), [](const Event& event) {
              return std::holds_alternative<UltrasonicFix>(event);
            }));
        CHECK(imu.wait_for_count(imu_count));
        CHECK(fixes.wait_for_count(fix_count));
        CHECK(headings.wait_for_count(events.size() - imu_count - fix_count));
        for (const ImuSample& sample : imu.samples) CHECK(sample.address == 8);
      }
    }
    WHEN("the beacon is not chosen, or an option does not fit") {
      const auto refused = [&bus](Arguments arguments) {
        arguments.insert(arguments.begin(), {"--source", "mcap"});
        const auto bridge = bus.bridge(arguments);
        CHECK(bridge->wait_for_exit().value_or(0) > 0);
        return bridge->text(Stream::error);
      };
      THEN("the error names the beacons, and the source as it was given") {
        CHECK_THAT(refused({"--input", file}), Contains("7, 8"));
        CHECK_THAT(refused({}), Contains("--source mcap: --input"));
        CHECK_THAT(refused({"--input", file, "--capture", folder / "raw"}), Contains("not with mcap"));
      }
    }
  }
}

SCENARIO("a part of a recording is played, as often and when it is asked for") {
  GIVEN("a recording, and a reader of IMU samples") {
    const TemporaryFolder folder;
    const std::string file = folder / "run.mcap";
    const auto events = record_walk(file, 4.0, {7});
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    WHEN("the time is limited") {
      REQUIRE(
          bus.play({file, "--start", "1", "--end", "2", "--topics", "imu", "--rate", "0"})->wait_for_exit() ==
          0);
      THEN("only that time comes") {
        const TimeNs begin = available_at_ns(events.front());
        const auto expected = std::count_if(events.begin(), events.end(), [&](const Event& event) {
          return std::holds_alternative<ImuSample>(event) &&
                 available_at_ns(event) >= begin + 1'000'000'000 &&
                 available_at_ns(event) <= begin + 2'000'000'000;
        });
        REQUIRE(expected > 90);
        CHECK(imu.wait_for_count(static_cast<std::size_t>(expected)));
        for (const ImuSample& sample : imu.samples) {
          CHECK(sample.bridge_time_ns >= begin + 1'000'000'000);
          CHECK(sample.bridge_time_ns <= begin + 2'000'000'000);
        }
      }
    }
    WHEN("it is repeated") {
      const auto play = bus.play({file, "--end", "0.5", "--rate", "5", "--loop"});
      THEN("it restarts until it is stopped") {
        CHECK(imu.wait_for_count(300));
        CHECK(play->end_by(SIGINT).code == 0);
      }
    }
  }
}

SCENARIO("a part of a recording is played with the state of latched topics before it") {
  GIVEN("a recording that names a stationary beacon at its start only") {
    const TemporaryFolder folder;
    const std::string file = folder / "run.mcap";
    const StationaryBeacon stationary{100, 1, Vector3d(1.0, 2.0, 3.0)};
    {
      BusRecording recording(file);
      for (const Event& event : walk(2.0)) {
        const auto log_time_ns = static_cast<std::uint64_t>(available_at_ns(event));
        if (sequence_of(event) == 1) {
          recording.write(topics::stationary_beacon, topics::to_idl(stationary), log_time_ns);
        }
        recording.write(event, log_time_ns);
      }
    }
    const Bus bus;
    Consumer<sonopose_StationaryBeacon> beacons(bus, topics::stationary_beacon);
    WHEN("it is played from its second second on") {
      REQUIRE(bus.play({file, "--start", "1", "--rate", "0"})->wait_for_exit() == 0);
      THEN("the beacon is known") {
        REQUIRE(beacons.wait_for_count(1));
        CHECK(beacons.samples.front() == stationary);
      }
    }
  }
}

SCENARIO("a recording across a step of the host's clock is played") {
  GIVEN("a second whose clock is set six years ahead in its middle, in two files of a folder") {
    const TemporaryFolder folder;
    const std::filesystem::path drive = folder / "drive";
    std::filesystem::create_directories(drive);
    const auto events = walk(1.0);
    constexpr std::uint64_t six_years_ns = 2190ULL * 86400 * 1'000'000'000;
    {
      BusRecording before(drive / "run_001.mcap");
      BusRecording after(drive / "run_002.mcap");
      for (std::size_t i = 0; i < events.size(); ++i) {
        const auto log_time_ns = static_cast<std::uint64_t>(available_at_ns(events[i]));
        if (i < events.size() / 2) {
          before.write(events[i], log_time_ns);
        } else {
          after.write(events[i], log_time_ns + six_years_ns);
        }
      }
    }
    const Bus bus;
    WHEN("long gaps are shortened") {
      const auto play = bus.play({drive.string(), "--no-wait", "--max-gap", "0.1", "--restamp"});
      THEN("all is played, and the gap is named") {
        REQUIRE(play->wait_for_exit() == 0);
        CHECK_THAT(play->text(Stream::output),
                   Contains("played " + std::to_string(events.size()) + " messages in ") &&
                       Contains("shortened: 1 gap, by "));
        CHECK_THAT(play->text(Stream::error),
                   Contains("no messages for 6.0 years after ") && Contains("shortened to 0.1 s"));
      }
    }
    WHEN("they are not") {
      const auto play = bus.play({drive.string(), "--no-wait"});
      THEN("the player says what it waits for, and what to do") {
        CHECK(play->wait_for_line(Stream::error, "--max-gap S shortens such gaps"));
        CHECK(play->end_by(SIGINT).code == 0);
      }
    }
  }
}

SCENARIO("a player waits for the number of readers that was asked for") {
  GIVEN("a recording of two topics, and a reader of one of them") {
    const TemporaryFolder folder;
    const std::string file = folder / "run.mcap";
    const auto events = record_walk(file, 1.0, {7});
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    const auto play = bus.play({file, "--topics", "imu,fix", "--rate", "0", "--readers", "1"});
    REQUIRE(play->wait_for_line(Stream::error, "waiting for readers: a topic has 0 of 1"));
    REQUIRE(imu.samples.empty());
    WHEN("a reader of the other comes") {
      Consumer<sonopose_UltrasonicFix> fixes(bus, topics::fix);
      THEN("both get all from the first sample on") {
        CHECK(play->wait_for_exit() == 0);
        const auto imu_count = std::count_if(events.begin(), events.end(), [](const Event& event) {
          return std::holds_alternative<ImuSample>(event);
        });
        CHECK(imu.wait_for_count(static_cast<std::size_t>(imu_count)));
        REQUIRE(fixes.wait_for_count(1));
        CHECK(imu.samples.front().sequence == 1);
      }
    }
  }
}

SCENARIO("a player names a fusion that may lose what is played as fast as possible") {
  GIVEN("a recording, and a fusion") {
    const TemporaryFolder folder;
    const std::string file = folder / "run.mcap";
    record_walk(file, 2.0, {7});
    const Bus bus;
    const bool is_lossless = GENERATE(false, true);
    const auto fusion = bus.fusion(is_lossless ? Arguments{"--lossless"} : Arguments{});
    WHEN("it is played at the rate 0") {
      const auto play = bus.play({file, "--rate", "0", "--readers", "1"});
      const auto code = play->wait_for_exit();
      THEN("the option of a live fusion is named; a lossless one loses nothing") {
        const std::string log = play->text(Stream::error);
        const std::string name = "sonopose-fusion (process " + std::to_string(fusion->pid());
        CAPTURE(log);
        CHECK((log.find(name) != std::string::npos) == !is_lossless);
        CHECK((log.find("--lossless") != std::string::npos) == !is_lossless);
        const bool has_lost = play->text(Stream::output).find("lost by fusions") != std::string::npos;
        CHECK(code == (has_lost ? 1 : 0));
        if (is_lossless) CHECK_FALSE(has_lost);
      }
    }
    WHEN("it is played at another rate") {
      const auto play = bus.play({file, "--rate", "5", "--topics", "imu,fix,heading", "--readers", "1"});
      REQUIRE(play->wait_for_exit() == 0);
      THEN("nothing is said") {
        CHECK_THAT(play->text(Stream::error), !Catch::Contains("--lossless"));
      }
    }
  }
}

}  // namespace sonopose::play_test
