/// sonopose-record: the contents of the bus in MCAP files.

#include "bus_log/foreign_lines.hpp"
#include "bus_log/instance_end.hpp"
#include "recorder/messages.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"
#include "support/wait_until.hpp"
#include "system/event_numbers.hpp"
#include "system/recorded_part.hpp"
#include "system/recorded_walk.hpp"
#include <sonopose/dds/psm/cdr.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>

#include <algorithm>
#include <csignal>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

namespace sonopose::record_test {

using namespace sonopose::test;
using namespace sonopose::recorder::test;
using Catch::Contains;
namespace topics = dds::topics;
namespace fs = std::filesystem;

SCENARIO("a recording has every message that a consumer gets beside it") {
  GIVEN("a recorder, and consumers of two topics that a player waits for") {
    const Bus bus;
    const TemporaryFolder folder;
    const fs::path file = folder / "run.mcap";
    record_imu_and_poses(folder / "inputs.mcap");
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
        REQUIRE(count == 12'000);
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

/// Instances that ended, such as "sonopose/imu 7", and whether they were disposed.
std::map<std::string, bool> disposed_by_instance(const std::vector<OwnedMessage>& messages) {
  std::map<std::string, bool> disposed;
  for (const OwnedMessage& message : of_topic(messages, "sonopose/instance_ends")) {
    const auto end = bus_log::instance_end_of(message.text());
    disposed[end.topic + " " + std::to_string(topics::beacon_of(end.key_cdr).value_or(0))] = end.disposed;
  }
  return disposed;
}

/// A run of a bridge with two beacons, a fusion and a recorder, until the recorder has the ends of all
/// instances.
struct RecordedRun {
  RecordedRun() {
    const Bus bus;
    domain_id = bus.domain_id();
    const auto record = start_recording(bus, file);
    const auto fusion = bus.fusion({"--set", "beacon.8.heading.mount_offset_deg=90"});
    const auto bridge = bus.bridge({"--beacons", "2"});
    REQUIRE(wait_for_part(file, {"sonopose/pose"}, 200));  // it writes while it records
    REQUIRE(bridge->end_by(SIGINT).code == 0);
    fusion->end_by(SIGTERM);
    const bool has_ends = wait_for_part(file, [](const std::vector<OwnedMessage>& written) {
      const auto ended = disposed_by_instance(written);
      return ended.contains("sonopose/imu 7") && ended.contains("sonopose/imu 8") &&
             ended.contains("sonopose/pose 7") && ended.contains("sonopose/pose 8") &&
             ended.contains("sonopose/report 7") && ended.contains("sonopose/report 8");
    });
    REQUIRE(has_ends);
    REQUIRE(record->end_by(SIGINT).code == 0);
    messages = messages_of(file);
    summary = record->text(Stream::output);
  }

  TemporaryFolder folder;
  fs::path file = folder / "run.mcap";
  std::uint32_t domain_id = 0;
  std::vector<OwnedMessage> messages;
  std::string summary;  ///< last output of the recorder
};

SCENARIO("a recording of beacons that are not there fails, and names one that is") {
  const Bus bus;
  const TemporaryFolder folder;
  const fs::path file = folder / "run.mcap";
  const auto record = start_recording(bus, file, {"--beacons", "9"});
  const auto bridge = bus.bridge({"--address", "7"});
  auto participant = dds::ext::participant({.domain_id = bus.domain_id()});
  auto imu = dds::topics::make_writer(participant, dds::qos::Provider(), topics::imu);
  REQUIRE(wait_until([&] { return imu.publication_matched_status().current_count() > 0; }));
  // The recorder keeps the second sample, and has heard the first one before it.
  for (const BeaconAddress address : {BeaconAddress{7}, all_beacons}) {
    ImuSample sample;
    sample.address = address;
    imu.write(dds::topics::to_idl(sample));
  }
  REQUIRE(wait_for_part(file, {"sonopose/imu"}, 1));
  REQUIRE(wait_for_part(file, {"sonopose/stationary_beacon"}, 4));
  CHECK(record->end_by(SIGINT).code == 1);
  CHECK_THAT(record->text(Stream::error),
             Contains("no message of --beacons 9 arrived, but some of beacon 7 did"));
  // The map is of all beacons, whatever the addresses of those that it consists of.
  CHECK(of_topic(messages_of(file), "sonopose/stationary_beacon").size() == 4);
}

SCENARIO("a recording without a message says so") {
  const Bus bus;
  const TemporaryFolder folder;
  const auto record = start_recording(bus, folder / "run.mcap");
  CHECK(record->end_by(SIGINT).code == 0);
  CHECK_THAT(record->text(Stream::error),
             Contains("nothing is published in domain " + std::to_string(bus.domain_id())));
}

SCENARIO("a recording has the times, the ends and the settings of a run") {
  GIVEN("a recording of a bridge with two beacons, and a fusion") {
    static const RecordedRun run;
    THEN("the times are those of arrival and of writing, and messages are numbered without a gap") {
      std::map<std::string, std::uint32_t> last;
      for (const OwnedMessage& message : run.messages) {
        CAPTURE(message.topic, message.sequence);
        REQUIRE(message.sequence == ++last[message.topic]);
        REQUIRE(message.log_time_ns >= message.publish_time_ns);
      }
    }
    THEN("the summary counts the messages of the file by topic, ends of instances apart from samples") {
      std::map<std::string, std::uint64_t> in_file;
      for (const OwnedMessage& message : run.messages) ++in_file[message.topic];
      std::map<std::string, std::uint64_t> printed;
      std::istringstream lines(run.summary);
      for (std::string topic, count; lines >> topic && topic.starts_with("sonopose/") && lines >> count;) {
        printed[topic] = std::stoull(count);
      }
      CHECK(printed == in_file);
      CHECK(printed.contains("sonopose/instance_ends"));
    }
    THEN("the ends of instances are recorded") {
      for (const auto& [instance, is_disposed] : disposed_by_instance(run.messages)) {
        CAPTURE(instance);
        if (instance.starts_with("sonopose/imu")) CHECK(is_disposed);
        if (instance.starts_with("sonopose/report")) CHECK(is_disposed);
        if (instance.starts_with("sonopose/pose")) CHECK_FALSE(is_disposed);
      }
    }
    THEN("it was written in pieces, and the file says what it is") {
      const mcap::Reader reader(run.file);
      CHECK(reader.damages().empty());
      CHECK(reader.contents().blocks.size() > 1);
      const auto schema =
          std::find_if(reader.schemas().begin(), reader.schemas().end(),
                       [](const auto& each) { return each.second.name == "sonopose::ImuSample"; });
      REQUIRE(schema != reader.schemas().end());
      CHECK(schema->second.encoding == "omgidl");
      CHECK(schema->second.data == read_text(SONOPOSE_SOURCE_DIR "/idl/sonopose.idl"));
      const auto about = metadata_of(run.file, "sonopose.recording");
      CHECK(about.at("domain") == std::to_string(run.domain_id));
      CHECK_FALSE(about.at("version").empty());
      const auto end = metadata_of(run.file, "sonopose.recording_end");
      CHECK(end.at("reason") == "stopped");
      CHECK(end.at("received") == std::to_string(run.messages.size()));
      CHECK(end.at("recorded") == end.at("received"));
    }
    THEN("the file has the settings of all beacons, and those of one") {
      const auto metadata = mcap::Reader(run.file).metadata();
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
    }
  }
}

SCENARIO("decoders that are not ours read a recording of a run") {
  if (!has_foreign_decoders() || !has_foreign_decompressors()) {
    std::cout << no_foreign_decoders;
    return;
  }
  GIVEN("a recording of a bridge and a fusion") {
    const Bus bus;
    const TemporaryFolder folder;
    const auto record = start_recording(bus, folder / "run.mcap");
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    REQUIRE(wait_for_part(folder / "run.mcap", {"sonopose/imu", "sonopose/pose"}, 201));
    REQUIRE(bridge->end_by(SIGINT).code == 0);
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
    const auto member = dds::ext::participant({.domain_id = bus.domain_id()});
    const dds::topic::Topic<sonopose_ResetCommand> other(member, "other");
    const dds::pub::DataWriter<sonopose_ResetCommand> writer(dds::pub::Publisher(member), other);
    const auto record = start_recording(
        bus, file,
        {"--topics", "imu,fix,heading", "--exclude", "heading", "--beacons", "8", "--compression", "zstd"});
    WHEN("two beacons are published, and a signal comes that has no use here") {
      record->send(SIGUSR1);
      REQUIRE(record->wait_for_line(Stream::error, "not recorded: other (sonopose::ResetCommand)"));
      const auto bridge = bus.bridge({"--beacons", "2"});
      REQUIRE(wait_for_part(file, {"sonopose/imu"}, 20));
      REQUIRE(wait_for_part(file, {"sonopose/fix"}, 2));
      REQUIRE(bridge->end_by(SIGINT).code == 0);
      REQUIRE(record->end_by(SIGTERM).code == 0);
      THEN("the file has what was asked for") {
        std::set<std::string> found;
        for (const OwnedMessage& message : messages_of(file)) {
          if (message.topic == "sonopose/instance_ends") continue;
          found.insert(message.topic + " " + std::to_string(topics::beacon_of(message.data).value_or(0)));
        }
        CHECK(found == std::set<std::string>{"sonopose/fix 8", "sonopose/imu 8"});
        CHECK_THAT(metadata_of(file, "sonopose.recording_end").at("not_recorded"),
                   Contains("other (1 writer)"));
        CHECK_THAT(record->text(Stream::output), Contains("not recorded: other (1 writer)"));
      }
    }
  }
}

/// A run of a bridge, a fusion and a relay with some seconds of recorded odometry.
struct RecordedRos2 {
  RecordedRos2() {
    const Bus bus;
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2();
    const auto record = start_recording(bus, folder / "run.mcap", {"--ros2"});
    const auto bridge = bus.bridge({});
    REQUIRE(record->wait_for_line(Stream::error, "recording /hedge_7/odom of ROS 2"));
    REQUIRE(wait_for_part(folder / "run_ros2.mcap", {"/hedge_7/odom"}, 101));
    REQUIRE(wait_for_part(folder / "run_ros2.mcap", {"/hedge_7/imu/data"}, 1));
    REQUIRE(wait_for_part(folder / "run_ros2.mcap", {"/tf"}, 1));
    REQUIRE(record->end_by(SIGINT).code == 0);
    log = record->text(Stream::error);
  }

  TemporaryFolder folder;
  std::string log;
};

SCENARIO("the topics of ROS 2 have a file of their own") {
  GIVEN("a recording of a relay, its fusion and a bridge") {
    static const RecordedRos2 run;
    THEN("the file has the profile, the definitions and the messages of ROS 2") {
      const fs::path file = run.folder / "run_ros2.mcap";
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
      const mcap::Reader reader(run.folder / "run.mcap");
      CHECK_FALSE(reader.channels().empty());
      for (const auto& [id, channel] : reader.channels()) {
        CHECK(channel.topic.starts_with("sonopose/"));
      }
      CHECK_THAT(run.log, !Contains("not recorded: rt/hedge_7"));
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

}  // namespace sonopose::record_test
