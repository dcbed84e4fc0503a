/// sonopose-record: the ends of its files, and the data that they lack.

#include "mcap/reader.hpp"
#include "recorder/event_gaps.hpp"
#include "recorder/messages.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"
#include "support/wait_until.hpp"
#include "system/event_numbers.hpp"
#include "system/recorded_part.hpp"
#include "system/recorded_walk.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace sonopose::record_limits_test {

using namespace sonopose::test;
using namespace sonopose::recorder::test;
using Catch::Contains;
namespace topics = dds::topics;
namespace fs = std::filesystem;

SCENARIO("a recorder that is killed leaves what it has written") {
  GIVEN("a recorder that has written twenty seconds of a player") {
    const Bus bus;
    const TemporaryFolder folder;
    const fs::path file = folder / "run.mcap";
    record_imu_and_poses(folder / "inputs.mcap");
    const auto played = messages_of(folder / "inputs.mcap");
    const auto record = start_recording(bus, file);
    REQUIRE(bus.play({(folder / "inputs.mcap").string(), "--rate", "0", "--readers", "1"})->wait_for_exit() ==
            0);
    REQUIRE(wait_for_part(file, {"sonopose/imu", "sonopose/pose"}, played.size()));
    WHEN("it is killed") {
      record->end_by(SIGKILL);
      THEN("the part opens, and has all of it") {
        CHECK_FALSE(exists(file));
        const auto messages = messages_of(folder / "run.mcap.part");
        CHECK(event_numbers(of_topic(messages, "sonopose/imu")) ==
              event_numbers(of_topic(played, "sonopose/imu")));
        CHECK(event_numbers(of_topic(messages, "sonopose/pose")) ==
              event_numbers(of_topic(played, "sonopose/pose")));
      }
    }
  }
}

SCENARIO("a full disk ends the recording with an error and a complete file") {
  GIVEN("a recorder whose files cannot exceed 1.5 MiB, and four beacons") {
    const Bus bus;
    const TemporaryFolder folder;
    const fs::path file = folder / "run.mcap";
    const std::string command = "ulimit -f 3072; exec " SONOPOSE_TEST_RECORD " " + file.string() +
                                " --compression none --domain " + std::to_string(bus.domain_id());
    Process record("/bin/sh", Arguments{"-c", command});
    REQUIRE(record.wait_for_line(Stream::error, "recording "));
    const auto bridge = bus.bridge({"--rate", "4", "--beacons", "4"});
    WHEN("the disk is full") {
      const auto code = record.wait_for_exit();
      THEN("it ends with the reason, and what it had is in a sound file") {
        CHECK(code == 1);
        CHECK_THAT(record.text(Stream::error),
                   Contains(file.string() + ".part: cannot be written: File too large"));
        CHECK_FALSE(exists(folder / "run.mcap.part"));
        const mcap::Reader reader(file);
        CHECK(reader.damages().empty());
        CHECK(reader.contents().is_indexed);
        CHECK(reader.statistics().message_count > 100);
        const auto end = metadata_of(file, "sonopose.recording_end");
        CHECK_THAT(end.at("reason"), Contains("error: ") && Contains("File too large"));
        CHECK(std::stoull(end.at("lost_disk")) > 0);
        CHECK(std::stoull(end.at("received")) ==
              std::stoull(end.at("recorded")) + std::stoull(end.at("lost_disk")));
      }
    }
  }
}

/// Removes the numbers before the later of the two first ones: a writer does not match two readers
/// simultaneously.
void begin_together(Numbers& a, Numbers& b) {
  for (auto& [address, numbers] : a) {
    auto& others = b[address];
    REQUIRE_FALSE(others.empty());
    const auto first = std::max(numbers.front(), others.front());
    std::erase_if(numbers, [first](std::uint64_t number) { return number < first; });
    std::erase_if(others, [first](std::uint64_t number) { return number < first; });
  }
}

/// Number of samples received by a reader of live writers but missing in the recording.
template <class Sample>
std::uint64_t lacking(const std::vector<OwnedMessage>& messages, const std::vector<Sample>& samples) {
  Numbers recorded = event_numbers(messages);
  Numbers received = event_numbers(samples);
  begin_together(recorded, received);
  std::uint64_t count = 0;
  for (const auto& [address, numbers] : received) {
    const std::set<std::uint64_t> has(recorded[address].begin(), recorded[address].end());
    count += static_cast<std::uint64_t>(
        std::count_if(numbers.begin(), numbers.end(), [&](auto number) { return !has.contains(number); }));
  }
  return count;
}

/// run_001.mcap, run_002.mcap, …
fs::path numbered(const TemporaryFolder& folder, std::size_t number) {
  return folder / ("run_00" + std::to_string(number) + ".mcap").c_str();
}

SCENARIO("a recording goes on in further files") {
  GIVEN("a recorder with at most one second in a file, and a fusion") {
    const Bus bus;
    const TemporaryFolder folder;
    const auto record = start_recording(bus, folder / "run.mcap", {"--max-duration", "1"});
    const auto fusion = bus.fusion();
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    WHEN("a bridge publishes until the second file is complete") {
      const auto bridge = bus.bridge({});
      REQUIRE(wait_until([&] { return exists(numbered(folder, 2)); }));
      REQUIRE(imu.wait_for_count(101));
      REQUIRE(bridge->end_by(SIGINT).code == 0);
      REQUIRE(record->end_by(SIGINT).code == 0);
      imu.take();
      THEN("the files together have all, each with the settings in effect") {
        std::vector<OwnedMessage> all;
        std::size_t count = 0;
        bool begins_with_settings = false;  // of the last file; the first ones may be older than the fusion
        std::uint64_t counted = recorder::EventNumbers::under_way;
        for (; exists(numbered(folder, count + 1)); ++count) {
          const auto messages = messages_of(numbered(folder, count + 1));
          const auto end = metadata_of(numbered(folder, count + 1), "sonopose.recording_end");
          counted += std::stoull(end.at("events_missing"));
          begins_with_settings =
              std::any_of(messages.begin(), messages.end(), [&](const OwnedMessage& message) {
                return message.topic == "sonopose/settings" &&
                       message.log_time_ns == messages.front().log_time_ns;
              });
          const auto own = of_topic(messages, "sonopose/imu");
          all.insert(all.end(), own.begin(), own.end());
        }
        CHECK(count >= 2);
        CHECK(begins_with_settings);
        CHECK(lacking(all, imu.samples) <= counted);
      }
    }
  }
}

SCENARIO("the last seconds are written when something has happened") {
  GIVEN("a recorder that keeps a second, a fusion, and a bridge") {
    const Bus bus;
    const TemporaryFolder folder;
    const auto fusion = bus.fusion();
    const auto record =
        start_recording(bus, folder / "run.mcap", {"--keep-last", "1", "--trigger-topic", "reset"});
    const auto bridge = bus.bridge({});
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    REQUIRE(imu.wait_for_count(250));
    REQUIRE(fs::is_empty(folder.path()));
    WHEN("a signal comes, and later a sample of the trigger topic") {
      record->send(SIGUSR1);
      REQUIRE(record->wait_for_line(Stream::error, "triggered by a signal: "));
      REQUIRE(imu.wait_for_more(50));
      const auto member = dds::ext::participant({.domain_id = bus.domain_id()});
      auto reset = topics::make_writer(member, dds::qos::Provider(), topics::reset);
      REQUIRE(wait_for_status(reset, dds::core::status::StatusMask::publication_matched(),
                              [&] { return reset.publication_matched_status().current_count() >= 1; }));
      reset.write({.address = 999, .request_id = 1});
      REQUIRE(record->wait_for_line(Stream::error, "triggered by a sample of the trigger topic: "));
      REQUIRE(record->end_by(SIGINT).code == 0);
      THEN("each wrote a file of its own, with what came before it and in no other file") {
        const auto first = messages_of(folder / "run_001.mcap");
        const auto second = messages_of(folder / "run_002.mcap");
        const auto span_ns = first.back().log_time_ns - first.front().log_time_ns;
        CHECK(span_ns > 500'000'000);                               // longer if its thread was delayed
        CHECK_FALSE(of_topic(first, "sonopose/settings").empty());  // published before
        CHECK_FALSE(metadata_of(folder / "run_001.mcap", "sonopose.settings").empty());
        CHECK_FALSE(of_topic(second, "sonopose/settings").empty());
        CHECK(first.back().log_time_ns <= second.front().log_time_ns);
        CHECK_FALSE(of_topic(second, "sonopose/reset").empty());
        CHECK(metadata_of(folder / "run_001.mcap", "sonopose.recording_end").at("trigger") == "a signal");
        CHECK_FALSE(exists(folder / "run_003.mcap"));
      }
    }
  }
}

/// Returns true if the file has a stale pose after one that is not.
bool turns_stale(const fs::path& file) {
  if (!exists(file)) return false;
  bool was_good = false;
  for (const OwnedMessage& message : of_topic(messages_of(file), "sonopose/pose")) {
    const bool is_stale = (topics::status_of_pose(message.data) & status_stale) != 0;
    if (is_stale && was_good) return true;
    was_good = was_good || !is_stale;
  }
  return false;
}

SCENARIO("the last seconds before a fault are written") {
  GIVEN("a recorder that waits for a bad status, a fusion, and a bridge") {
    const Bus bus;
    const TemporaryFolder folder;
    const auto fusion = bus.fusion();
    const auto record = start_recording(bus, folder / "run.mcap", {"--keep-last", "3", "--trigger-status"});
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    WHEN("the fixes end") {
      const auto bridge =
          bus.bridge({"--scenario", "outages", "--rate", "5"});  // the first outage begins after 15 s
      const auto is_stale = [](const FusedPose& pose) { return (pose.status & status_stale) != 0; };
      REQUIRE(poses.wait_for(is_stale));
      // A stall of the machine may have caused an earlier event.
      std::size_t number = 1;
      while (exists(numbered(folder, number)) && !turns_stale(numbered(folder, number))) ++number;
      const auto give_up = std::chrono::steady_clock::now() + timeout;
      while (std::chrono::steady_clock::now() < give_up && !turns_stale(numbered(folder, number))) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        if (exists(numbered(folder, number + 1))) ++number;
      }
      record->end_by(SIGINT);
      THEN("a file has the poses before and after it turned bad") {
        CHECK(turns_stale(numbered(folder, number)));
        CHECK_THAT(metadata_of(numbered(folder, number), "sonopose.recording_end").at("trigger"),
                   Contains("status"));
      }
    }
  }
}

SCENARIO("a full disk is noticed when the last seconds are written") {
  GIVEN("a recorder in memory whose files cannot exceed 3 MiB, and eight beacons") {
    const Bus bus;
    const TemporaryFolder folder;
    const std::string command =
        "ulimit -f 6144; exec " SONOPOSE_TEST_RECORD " " + (folder / "run.mcap").string() +
        " --compression none --keep-last 20 --domain " + std::to_string(bus.domain_id());
    Process record("/bin/sh", Arguments{"-c", command});
    REQUIRE(record.wait_for_line(Stream::error, "recording "));
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    const auto bridge = bus.bridge({"--rate", "4", "--beacons", "8"});
    REQUIRE(imu.wait_for_count(9'000));  // about 150 bytes each
    WHEN("they are written") {
      record.send(SIGUSR1);
      const auto code = record.wait_for_exit();
      THEN("it ends with the reason, counts what it lost, and the file is sound") {
        CHECK(code == 1);
        CHECK_THAT(record.text(Stream::error), Contains("cannot be written: File too large"));
        const mcap::Reader reader(folder / "run_001.mcap");
        CHECK(reader.damages().empty());
        CHECK(reader.statistics().message_count > 100);
        CHECK(std::stoull(metadata_of(folder / "run_001.mcap", "sonopose.recording_end").at("lost_disk")) >
              0);
      }
    }
  }
}

/// Counts the missing events of all beacons, each from its first to the last one that cannot be in transit.
std::uint64_t missing_numbers(const std::vector<OwnedMessage>& messages) {
  std::map<int, std::set<std::uint64_t>> numbers;
  for (const char* const topic : {"sonopose/imu", "sonopose/fix", "sonopose/heading"}) {
    for (const auto& [address, found] : event_numbers(of_topic(messages, topic))) {
      numbers[address].insert(found.begin(), found.end());
    }
  }
  std::uint64_t missing = 0;
  for (const auto& [address, found] : numbers) {
    for (auto number = *found.begin(); number + recorder::EventNumbers::under_way <= *found.rbegin();
         ++number) {
      if (!found.contains(number)) ++missing;
    }
  }
  return missing;
}

SCENARIO("inputs that never reach a recorder are counted") {
  GIVEN("a recorder and a bridge with forty beacons") {
    const Bus bus;
    const TemporaryFolder folder;
    const fs::path file = folder / "run.mcap";
    Consumer<sonopose_ImuSample> imu(bus, topics::imu, dds::topics::Delivery::live);
    const auto record = start_recording(bus, file);
    const auto bridge = bus.bridge({"--beacons", "40"});
    REQUIRE(imu.wait_for_count(2'000));
    WHEN("the recorder is stopped for longer than anything waits for it") {
      record->send(SIGSTOP);
      REQUIRE(imu.wait_for_more(8'000));
      record->send(SIGCONT);
      REQUIRE(imu.wait_for_more(4'000));
      REQUIRE(bridge->end_by(SIGINT).code == 0);
      record->end_by(SIGINT);
      THEN("it reports what is missing, in the file and on the terminal") {
        const auto missing = missing_numbers(messages_of(file));
        CHECK(missing > 0);
        CHECK(metadata_of(file, "sonopose.recording_end").at("events_missing") == std::to_string(missing));
        CHECK_THAT(record->text(Stream::output), Contains(std::to_string(missing) + " inputs of beacons"));
      }
    }
  }
}

SCENARIO("two fusions do not look like losses") {
  GIVEN("a recorder, a fusion and its standby") {
    const Bus bus;
    const TemporaryFolder folder;
    const fs::path file = folder / "run.mcap";
    const auto record = start_recording(bus, file);
    const auto fusion = bus.fusion({"--standby-strength", "100"});
    const auto standby = bus.fusion({"--standby-strength", "50"});
    WHEN("a bridge publishes") {
      const auto bridge = bus.bridge({});
      REQUIRE(wait_for_part(file, {"sonopose/pose"}, 101));
      REQUIRE(bridge->end_by(SIGINT).code == 0);
      REQUIRE(record->end_by(SIGINT).code == 0);
      THEN("the poses of the weaker one do not count as lost") {
        const auto messages = messages_of(file);
        const auto end = metadata_of(file, "sonopose.recording_end");
        const auto poses = event_numbers(of_topic(messages, "sonopose/pose"))[7].size();
        // A stalled machine may lose some. The weaker fusion's poses are as many as the recorded ones.
        CHECK(std::stoull(end.at("lost_dds")) < poses / 2);
        CHECK(end.at("events_missing") == std::to_string(missing_numbers(messages)));
      }
    }
  }
}

}  // namespace sonopose::record_limits_test
