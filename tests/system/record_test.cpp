/// sonopose-record: what is on the bus, in MCAP files.

#include "bus_log/foreign_lines.hpp"
#include "bus_log/recorded.hpp"
#include "recorder/event_gaps.hpp"
#include "recorder/instance_end.hpp"
#include "recorder/messages.hpp"
#include "sim/simulator.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"
#include "system/recorded_part.hpp"
#include <sonopose/dds/binding/cdr.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <iostream>
#include <map>
#include <set>
#include <thread>

namespace record_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
using recorder::test::messages_of;
using recorder::test::metadata_of;
using recorder::test::OwnedMessage;
namespace topics = dds::topics;
namespace fs = std::filesystem;

/// Returns when it records.
std::unique_ptr<Process> start_recording(const Bus& bus, const fs::path& file,
                                         const Arguments& options = {}) {
  Arguments arguments{file.string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  auto process = bus.record(arguments);
  REQUIRE(process->wait_for_line(Stream::error, "recording "));
  return process;
}

/// The little-endian number of 8 bytes at `offset` of the CDR.
std::uint64_t number_at(const OwnedMessage& message, std::size_t offset) {
  REQUIRE(message.data.size() >= offset + 8);
  std::uint64_t number = 0;
  for (std::size_t i = 8; i-- > 0;)
    number = number << 8U | std::to_integer<std::uint64_t>(message.data[offset + i]);
  return number;
}

std::vector<OwnedMessage> of_topic(const std::vector<OwnedMessage>& messages, const std::string& topic) {
  std::vector<OwnedMessage> found;
  std::copy_if(messages.begin(), messages.end(), std::back_inserter(found),
               [&](const OwnedMessage& message) { return message.topic == topic; });
  return found;
}

using Numbers = std::map<int, std::vector<std::uint64_t>>;

/// By beacon: the event numbers of IMU samples, fixes, headings and poses: the second field of their types,
/// aligned to 8.
Numbers event_numbers(const std::vector<OwnedMessage>& messages) {
  Numbers numbers;
  for (const OwnedMessage& message : messages) {
    numbers[topics::beacon_of(message.data).value_or(0)].push_back(number_at(message, 4 + 8));
  }
  return numbers;
}

template <class Sample>
Numbers event_numbers(const std::vector<Sample>& samples) {
  Numbers numbers;
  for (const Sample& sample : samples) numbers[sample.address].push_back(sample.sequence);
  return numbers;
}

/// Without those before the latest of the two beginnings: a writer does not find two readers at one moment.
void begin_together(Numbers& a, Numbers& b) {
  for (auto& [address, numbers] : a) {
    auto& others = b[address];
    REQUIRE_FALSE(others.empty());
    const auto first = std::max(numbers.front(), others.front());
    std::erase_if(numbers, [first](std::uint64_t number) { return number < first; });
    std::erase_if(others, [first](std::uint64_t number) { return number < first; });
  }
}

/// How many of the samples that a reader of live writers received are not in the recording.
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

/// Three beacons with IMU samples and poses, whose numbers are those of their events.
std::vector<Event> record_inputs(const fs::path& file) {
  const auto events = sim::record(sim::find_scenario("walk"), {.duration_s = 20.0}).events;
  BusRecording recording(file);
  for (const Event& event : events) {
    const auto* const imu = std::get_if<ImuSample>(&event);
    if (imu == nullptr) continue;
    const auto log_time_ns = static_cast<std::uint64_t>(available_at_ns(event));
    for (BeaconAddress address = 7; address <= 9; ++address) {
      ImuSample sample = *imu;
      sample.address = address;
      recording.write(sample, log_time_ns);
      FusedPose pose;
      pose.address = address;
      pose.sequence = sample.sequence;
      recording.write(topics::pose, topics::to_idl(pose), log_time_ns);
    }
  }
  return events;
}

SCENARIO("a recording has every message that a consumer gets beside it") {
  GIVEN("a recorder, and consumers of two topics that a player waits for") {
    const Bus bus;
    const TemporaryFolder folder;
    const fs::path file = folder / "run.mcap";
    record_inputs(folder / "inputs.mcap");
    const std::size_t count = messages_of(folder / "inputs.mcap").size();
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto record = start_recording(bus, file);
    WHEN("it plays twenty seconds of three beacons as fast as they receive them") {
      REQUIRE(
          bus.play({(folder / "inputs.mcap").string(), "--rate", "0", "--readers", "2"})->wait_for_exit() ==
          0);
      REQUIRE(imu.wait_for_count(count / 2));
      REQUIRE(poses.wait_for_count(count / 2));
      const bool has_all = wait_for_part(file, {"sonopose/imu", "sonopose/pose"}, count);
      REQUIRE(record->end_by(SIGINT).code == 0);
      THEN("the same messages are in the file, in the same order for each beacon") {
        CHECK(has_all);
        REQUIRE(count == 2 * 3 * 2000);
        const auto messages = messages_of(file);
        CHECK(event_numbers(of_topic(messages, "sonopose/imu")) == event_numbers(imu.samples));
        CHECK(event_numbers(of_topic(messages, "sonopose/pose")) == event_numbers(poses.samples));
        const auto end = metadata_of(file, "sonopose.recording_end");
        CHECK(end.at("recorded") == end.at("received"));
        CHECK(end.at("lost_dds") == "0");
        CHECK_THAT(record->text(Stream::output),
                   Contains("lost: 0 by a full queue, 0 by the disk, 0 by DDS"));
      }
    }
  }
}

/// The instances that ended, as "sonopose/imu 7", and how.
std::map<std::string, bool> disposed_by_instance(const std::vector<OwnedMessage>& messages) {
  std::map<std::string, bool> disposed;
  for (const OwnedMessage& message : of_topic(messages, "sonopose/instance_ends")) {
    const auto end = recorder::instance_end_of(message.text());
    disposed[end.topic + " " + std::to_string(topics::beacon_of(end.key_cdr).value_or(0))] = end.disposed;
  }
  return disposed;
}

SCENARIO("a recording has the times, the ends and the settings of a run") {
  GIVEN("a recorder and a fusion") {
    const Bus bus;
    const TemporaryFolder folder;
    const fs::path file = folder / "run.mcap";
    const auto record = start_recording(bus, file);
    const auto fusion = bus.fusion({"--set", "beacon.8.heading.mount_offset_deg=90"});
    WHEN("a bridge has published five seconds of two beacons") {
      const auto bridge = bus.bridge({"--duration", "5", "--beacons", "2"});
      REQUIRE(bridge->wait_for_exit() == 0);
      fusion->end_by(SIGTERM);
      const bool has_ends = wait_for_part(file, [](const std::vector<OwnedMessage>& messages) {
        const auto ended = disposed_by_instance(messages);
        return ended.contains("sonopose/imu 7") && ended.contains("sonopose/imu 8") &&
               ended.contains("sonopose/pose 7") && ended.contains("sonopose/pose 8");
      });
      REQUIRE(record->end_by(SIGINT).code == 0);
      const auto messages = messages_of(file);
      THEN("the times are those of arrival and of writing, and messages are numbered without a gap") {
        std::map<std::string, std::uint32_t> last;
        for (const OwnedMessage& message : messages) {
          CAPTURE(message.topic, message.sequence);
          REQUIRE(message.sequence == ++last[message.topic]);
          REQUIRE(message.log_time_ns >= message.publish_time_ns);
        }
      }
      THEN("the ends of instances are recorded") {
        CHECK(has_ends);
        for (const auto& [instance, is_disposed] : disposed_by_instance(messages)) {
          CAPTURE(instance);
          if (instance.starts_with("sonopose/imu")) CHECK(is_disposed);
          if (instance.starts_with("sonopose/pose")) CHECK_FALSE(is_disposed);
        }
      }
      THEN("it was written in pieces, and the file says what it is") {
        const mcap::Reader reader(file);
        CHECK(reader.damages().empty());
        CHECK(reader.contents().blocks.size() > 2);  // how many depends on the load
        const auto schema =
            std::find_if(reader.schemas().begin(), reader.schemas().end(),
                         [](const auto& each) { return each.second.name == "sonopose::ImuSample"; });
        REQUIRE(schema != reader.schemas().end());
        CHECK(schema->second.encoding == "omgidl");
        CHECK(schema->second.data == read_text(SONOPOSE_SOURCE_DIR "/idl/sonopose.idl"));
        const auto about = metadata_of(file, "sonopose.recording");
        CHECK(about.at("domain") == std::to_string(bus.domain_id()));
        CHECK_FALSE(about.at("version").empty());
        const auto metadata = reader.metadata();
        const auto settings = std::find_if(metadata.begin(), metadata.end(), [](const mcap::Metadata& each) {
          return each.name == "sonopose.settings" && !each.values.contains("address");
        });
        REQUIRE(settings != metadata.end());
        CHECK(settings->values.at("fusion.engine") == "kalman");
        const auto of_beacon = std::find_if(metadata.begin(), metadata.end(), [](const mcap::Metadata& each) {
          return each.name == "sonopose.settings" && each.values.contains("address") &&
                 each.values.at("address") == "8";
        });
        REQUIRE(of_beacon != metadata.end());
        CHECK(of_beacon->values.at("heading.mount_offset_deg") == "90");
        CHECK(of_beacon->values.at("fusion.engine") == "kalman");
        const auto end = metadata_of(file, "sonopose.recording_end");
        CHECK(end.at("reason") == "stopped");
        CHECK(end.at("received") == std::to_string(messages.size()));
        CHECK(end.at("recorded") == end.at("received"));
      }
    }
  }
}

SCENARIO("decoders that are not ours read a recording of a run") {
  if (!has_foreign_decoders() || !has_foreign_decompressors()) {
    std::cout << no_foreign_decoders;
    return;
  }
  GIVEN("two seconds of a bridge, a fusion and a recorder") {
    const Bus bus;
    const TemporaryFolder folder;
    const auto record = start_recording(bus, folder / "run.mcap");
    const auto fusion = bus.fusion();
    REQUIRE(bus.bridge({"--duration", "2"})->wait_for_exit() == 0);
    fusion->end_by(SIGTERM);
    REQUIRE(record->end_by(SIGINT).code == 0);
    THEN("they agree with ours about every field") {
      CHECK(check_foreign_lines(folder / "run.mcap") > 200);
    }
  }
}

SCENARIO("topics and beacons are selected, and what is not ours is named") {
  GIVEN("a recorder of one beacon's IMU samples and fixes, and a writer of another topic") {
    const Bus bus;
    const TemporaryFolder folder;
    const fs::path file = folder / "run.mcap";
    const auto member = dds::make_participant({.domain_id = bus.domain_id()});
    const dds::Topic<sonopose_ResetCommand> other(member, "rt/other");
    const dds::DataWriter<sonopose_ResetCommand> writer(member, other);
    const auto record = start_recording(
        bus, file,
        {"--topics", "imu,fix,heading", "--exclude", "heading", "--beacons", "8", "--compression", "zstd"});
    WHEN("two beacons are published, and a signal comes that has no use here") {
      record->send(SIGUSR1);
      REQUIRE(record->wait_for_line(Stream::error, "not recorded: rt/other (sonopose::ResetCommand)"));
      REQUIRE(bus.bridge({"--duration", "2", "--rate", "2", "--beacons", "2"})->wait_for_exit() == 0);
      REQUIRE(record->end_by(SIGTERM).code == 0);
      THEN("the file has what was asked for") {
        std::set<std::string> found;
        for (const OwnedMessage& message : messages_of(file)) {
          if (message.topic == "sonopose/instance_ends") continue;
          found.insert(message.topic + " " + std::to_string(topics::beacon_of(message.data).value_or(0)));
        }
        CHECK(found == std::set<std::string>{"sonopose/fix 8", "sonopose/imu 8"});
        CHECK_THAT(metadata_of(file, "sonopose.recording_end").at("not_recorded"),
                   Contains("rt/other (1 writer)"));
        CHECK_THAT(record->text(Stream::output), Contains("not recorded: rt/other (1 writer)"));
      }
    }
  }
}

SCENARIO("a recorder that is killed leaves what it has written") {
  GIVEN("a recorder that has written twenty seconds of a player") {
    const Bus bus;
    const TemporaryFolder folder;
    const fs::path file = folder / "run.mcap";
    record_inputs(folder / "inputs.mcap");
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
  GIVEN("a recorder whose files cannot exceed 2 MiB, and four beacons") {
    const Bus bus;
    const TemporaryFolder folder;
    const fs::path file = folder / "run.mcap";
    const std::string command = "trap '' XFSZ; ulimit -f 4096; exec " SONOPOSE_TEST_RECORD " " +
                                file.string() + " --compression none --domain " +
                                std::to_string(bus.domain_id());
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
    WHEN("a bridge publishes four seconds") {
      REQUIRE(bus.bridge({"--duration", "4"})->wait_for_exit() == 0);
      REQUIRE(record->end_by(SIGINT).code == 0);
      imu.take();
      THEN("the files together have all, each with the settings in effect") {
        std::vector<OwnedMessage> all;
        std::size_t count = 0;
        bool begins_with_settings = false;  // the last file: the first ones may be older than the fusion
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
        CHECK(count >= 2);  // four seconds, unless its thread was held up
        CHECK(begins_with_settings);
        REQUIRE(imu.samples.size() > 100);
        CHECK(lacking(all, imu.samples) <= counted);
      }
    }
  }
}

SCENARIO("the last seconds are written when something has happened") {
  GIVEN("a recorder that keeps two seconds, a fusion, and a bridge") {
    const Bus bus;
    const TemporaryFolder folder;
    const auto fusion = bus.fusion();
    const auto record =
        start_recording(bus, folder / "run.mcap", {"--keep-last", "2", "--trigger-topic", "reset"});
    const auto bridge = bus.bridge({});
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    REQUIRE(imu.wait_for_count(350));
    CHECK(fs::is_empty(folder.path()));
    WHEN("a signal comes, and later a sample of the trigger topic") {
      record->send(SIGUSR1);
      REQUIRE(record->wait_for_line(Stream::error, "triggered by a signal: "));
      REQUIRE(imu.wait_for_more(50));
      const auto member = dds::make_participant({.domain_id = bus.domain_id()});
      auto reset = topics::make_writer(member, dds::qos::Provider(), topics::reset);
      REQUIRE(wait_for_status(reset, dds::StatusMask::publication_matched(),
                              [&] { return reset.publication_matched_status().current_count >= 1; }));
      reset.write({.address = 999, .request_id = 1});
      REQUIRE(record->wait_for_line(Stream::error, "triggered by a sample of the trigger topic: "));
      REQUIRE(record->end_by(SIGINT).code == 0);
      THEN("each wrote a file of its own, with what came before it and in no other file") {
        const auto first = messages_of(folder / "run_001.mcap");
        const auto second = messages_of(folder / "run_002.mcap");
        const auto span_ns = first.back().log_time_ns - first.front().log_time_ns;
        CHECK(span_ns > 1'500'000'000);                             // longer where its thread was held up
        CHECK_FALSE(of_topic(first, "sonopose/settings").empty());  // they came before
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

/// Whether the file has a pose that is stale after one that is not.
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
      const auto bridge = bus.bridge({"--scenario", "outages"});  // the first one begins after 15 s at most
      const auto is_stale = [](const FusedPose& pose) { return (pose.status & status_stale) != 0; };
      REQUIRE(poses.wait_for(is_stale, 0, std::chrono::seconds(40)));
      // A stall of the machine may have been an event of its own before.
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
        "trap '' XFSZ; ulimit -f 6144; exec " SONOPOSE_TEST_RECORD " " + (folder / "run.mcap").string() +
        " --compression none --keep-last 20 --domain " + std::to_string(bus.domain_id());
    Process record("/bin/sh", Arguments{"-c", command});
    REQUIRE(record.wait_for_line(Stream::error, "recording "));
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    const auto bridge = bus.bridge({"--rate", "4", "--beacons", "8"});
    REQUIRE(imu.wait_for_count(16'000));  // of about 150 bytes
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

SCENARIO("the topics of ROS 2 have a file of their own") {
  GIVEN("a relay with its fusion, and a recorder of ROS 2") {
    const Bus bus;
    const TemporaryFolder folder;
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2();
    const auto record = start_recording(bus, folder / "run.mcap", {"--ros2"});
    WHEN("a bridge publishes until odometry is recorded for a while") {
      const auto bridge = bus.bridge({});
      REQUIRE(record->wait_for_line(Stream::error, "recording /hedge_7/odom of ROS 2"));
      REQUIRE(wait_for_part(folder / "run_ros2.mcap", {"/hedge_7/odom"}, 101));
      REQUIRE(wait_for_part(folder / "run_ros2.mcap", {"/hedge_7/imu/data"}, 1));
      REQUIRE(wait_for_part(folder / "run_ros2.mcap", {"/tf"}, 1));
      REQUIRE(record->end_by(SIGINT).code == 0);
      THEN("the file has the profile, the definitions and the messages of ROS 2") {
        const fs::path file = folder / "run_ros2.mcap";
        const mcap::Reader reader(file);
        CHECK(reader.contents().profile == "ros2");
        CHECK(reader.damages().empty());
        std::set<std::string> channels;
        for (const auto& [id, channel] : reader.channels()) {
          channels.insert(channel.topic);
          CHECK(channel.message_encoding == "cdr");
          CHECK_THAT(channel.metadata.at("offered_qos_profiles"), Contains("- history: 1\n"));
          const mcap::Schema& schema = reader.schemas().at(channel.schema_id);
          CHECK(schema.encoding == "ros2msg");
          if (channel.topic != "/hedge_7/odom") continue;
          CHECK(schema.name == "nav_msgs/msg/Odometry");
          CHECK_THAT(schema.data, Catch::StartsWith("std_msgs/Header header\nstring child_frame_id\n") &&
                                      Contains("\nMSG: geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose "
                                               "pose\nfloat64[36] covariance\n"));
        }
        CHECK(channels.contains("/hedge_7/odom"));
        CHECK(channels.contains("/hedge_7/imu/data"));
        CHECK(channels.contains("/tf"));
        const auto odometry = of_topic(messages_of(file), "/hedge_7/odom");
        REQUIRE(odometry.size() > 100);
        for (const OwnedMessage& message : odometry) {
          const dds::CdrSample<ros2::Odometry> sample(message.data);
          REQUIRE(sample.get() != nullptr);
          CHECK(std::string(sample.get()->header.frame_id) == "map");
        }
      }
      THEN("the other file has the native topics alone") {
        const mcap::Reader reader(folder / "run.mcap");
        for (const auto& [id, channel] : reader.channels()) {
          CHECK(channel.topic.starts_with("sonopose/"));
        }
        CHECK_THAT(record->text(Stream::error), !Contains("not recorded: rt/hedge_7"));
      }
    }
  }
}

SCENARIO("a recording that cannot begin is refused") {
  const TemporaryFolder folder;
  const std::string file = (folder / "run.mcap").string();
  const auto refused = [](const Arguments& arguments) {
    const Result result = run(SONOPOSE_TEST_RECORD, arguments, neutral);
    CHECK(result.code.value_or(0) > 0);
    return result.error;
  };
  write_text(folder / "run_ros2.mcap", "of somebody else");
  CHECK_THAT(refused({file, "--ros2"}), Contains("run_ros2.mcap: exists; a recording is not overwritten"));
  CHECK_FALSE(exists(folder / "run.mcap.part"));
  write_text(file, "of somebody else");
  CHECK_THAT(refused({file}), Contains(file + ": exists; a recording is not overwritten"));
  CHECK(read_text(file) == "of somebody else");
  CHECK_THAT(refused({"--topics", "imus"}), Contains("imus: unknown topic; did you mean imu?"));
  CHECK_THAT(refused({"--beacons", "7-x"}), Contains("7-x"));
  CHECK_THAT(refused({"--compression", "gzip"}), Contains("gzip"));
  CHECK_THAT(refused({"--trigger-status"}), Contains("--trigger-status requires --keep-last"));
  CHECK_THAT(refused({"--topics", "imu", "--keep-last", "5", "--trigger-status"}),
             Contains("--trigger-status: the topic pose is not recorded"));
  CHECK_THAT(refused({"--ros2", "--keep-last", "5"}), Contains("--ros2 excludes --keep-last"));
  CHECK_THAT(refused({"--max-duration", "0.1"}), Contains("--max-duration"));
  CHECK_THAT(refused({"--max-size", "10kB"}), Contains("--max-size"));
  CHECK_THAT(refused({"--keep-last", "5", "--keep-memory", "1B"}), Contains("--keep-memory"));
  CHECK_THAT(refused({"/proc/none/run.mcap"}), Contains("/proc/none"));
}

/// The numbers of each beacon that are not there, from its first to the last that does not count as under
/// way.
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
    const auto bridge = bus.bridge({"--duration", "9", "--beacons", "40"});
    REQUIRE(imu.wait_for_count(4'000));
    WHEN("the recorder is stopped for longer than anything waits for it") {
      record->send(SIGSTOP);
      REQUIRE(imu.wait_for_more(8'000));
      record->send(SIGCONT);
      REQUIRE(bridge->wait_for_exit() == 0);
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
    WHEN("a bridge publishes for five seconds") {
      REQUIRE(bus.bridge({"--duration", "5"})->wait_for_exit() == 0);
      REQUIRE(record->end_by(SIGINT).code == 0);
      THEN("the poses of the weaker one do not count as lost") {
        const auto messages = messages_of(file);
        const auto end = metadata_of(file, "sonopose.recording_end");
        const auto poses = event_numbers(of_topic(messages, "sonopose/pose"))[7].size();
        CHECK(poses > 100);
        // A stalled machine may lose some. Those of the weaker fusion are as many as the recorded ones.
        CHECK(std::stoull(end.at("lost_dds")) < poses / 2);
        CHECK(end.at("events_missing") == std::to_string(missing_numbers(messages)));
      }
    }
  }
}

}  // namespace record_test
