/// sonopose-play: a fusion computes the same poses from the played inputs.

#include "bus_log/outputs.hpp"
#include "bus_log/sensor_log.hpp"
#include "recorder/messages.hpp"
#include "support/bits.hpp"
#include "support/bus.hpp"
#include "support/checked_run.hpp"
#include "support/poses_of.hpp"
#include "support/temporary_folder.hpp"
#include "system/recorded_part.hpp"
#include "system/recorded_walk.hpp"
#include <sonopose/estimation/any_estimator.hpp>

#include <array>
#include <csignal>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::play_poses_test {

using namespace sonopose::test;
using Catch::Contains;
using recorder::test::messages_of;
namespace topics = dds::topics;
namespace fs = std::filesystem;

constexpr std::array<BeaconAddress, 2> beacons{7, 8};

/// Poses that an engine in this process computes from the inputs of a file.
std::vector<FusedPose> replayed(const fs::path& file, BeaconAddress address) {
  estimation::AnyEstimator estimator{settings::Settings{}};
  return poses_of(estimator, bus_log::read_sensor_log(file, address).events);
}

/// Poses of a beacon, as bits.
std::vector<Bits> bits_of_beacon(const std::vector<FusedPose>& poses, BeaconAddress address) {
  std::vector<Bits> bits;
  for (const FusedPose& pose : poses) {
    if (pose.address == address) bits.push_back(bits_of(pose));
  }
  return bits;
}

/// Poses in a recording, by beacon and event number.
std::map<std::pair<BeaconAddress, std::uint64_t>, Bits> recorded_poses(const fs::path& file) {
  std::map<std::pair<BeaconAddress, std::uint64_t>, Bits> bits;
  const mcap::Reader reader(file);
  for (const BeaconAddress address : beacons) {
    bus_log::for_each_output(
        reader, address,
        [&](const FusedPose& pose) {
          bits[{pose.address, pose.sequence}] = bits_of(pose);
        },
        [](const FixReport& /*report*/) {});
  }
  return bits;
}

/// Waits for the poses of a lossless fusion that receives a file's inputs from a player, ends it, and returns
/// its log.
std::string play_to(Process& fusion, Consumer<sonopose_FusedPose>& poses, const Bus& bus,
                    const fs::path& file, const char* readers, std::size_t pose_count) {
  REQUIRE(bus.play({file.string(), "--topics", "imu,fix,heading", "--rate", "0", "--readers", readers})
              ->wait_for_exit() == 0);
  CHECK(poses.wait_for_count(pose_count));
  CHECK(fusion.end_by(SIGTERM).code == 0);  // no more poses can follow
  poses.take();
  CHECK(poses.samples.size() == pose_count);
  return fusion.text(Stream::error);
}

/// Checks that the fusion's log has the state hash of a replay of the file, for each beacon.
void check_state_hashes(const std::string& log, const fs::path& file) {
  for (const BeaconAddress address : beacons) {
    const std::string replay =
        output_of(SONOPOSE_TEST_REPLAY, {file.string(), "--beacon", std::to_string(address)});
    const std::size_t name_at = replay.find("state hash");
    REQUIRE(name_at != std::string::npos);
    const std::size_t at = replay.find_first_not_of(' ', name_at + 10);
    const std::size_t line_at = log.find("beacon " + std::to_string(address) + ": state hash ");
    REQUIRE(line_at != std::string::npos);
    const std::string line = log.substr(line_at, log.find('\n', line_at) - line_at);
    CHECK_THAT(line, Contains("state hash " + replay.substr(at, 16) + " after event") &&
                         Catch::EndsWith("; 0 events lost"));
  }
}

/// Inputs of two beacons, a lossless fusion that received them from a player, a recording of both, and
/// another lossless fusion that received the recording.
struct PlayedTwice {
  PlayedTwice() {
    record_walk(inputs, 4.0, {beacons.begin(), beacons.end()});
    for (const BeaconAddress address : beacons) {
      expected[address] = replayed(inputs, address);
      pose_count += expected[address].size();
    }
    REQUIRE(pose_count == 800);
    const Bus bus;
    const auto record = start_recording(bus, file, {"--topics", "imu,fix,heading,pose"});
    Consumer<sonopose_FusedPose> consumer(bus, topics::pose);
    const auto fusion = bus.fusion({"--lossless"});
    REQUIRE(consumer.wait_for_writers());
    // The fusion's writer of poses is older than that of the settings, so the recorder knows both.
    REQUIRE(wait_for_part(file, {"sonopose/settings"}, 1));
    log = play_to(*fusion, consumer, bus, inputs, "2", pose_count);
    poses = consumer.samples;
    REQUIRE(wait_for_part(file, {"sonopose/imu", "sonopose/fix", "sonopose/heading"},
                          messages_of(inputs).size()));
    REQUIRE(wait_for_part(file, {"sonopose/pose"}, pose_count));
    REQUIRE(record->end_by(SIGINT).code == 0);
    const Bus other;
    Consumer<sonopose_FusedPose> other_consumer(other, topics::pose);
    const auto other_fusion = other.fusion({"--lossless"});
    REQUIRE(other_consumer.wait_for_writers());
    log_again = play_to(*other_fusion, other_consumer, other, file, "1", pose_count);
    poses_again = other_consumer.samples;
  }

  TemporaryFolder folder;
  fs::path inputs = folder / "inputs.mcap";
  fs::path file = folder / "run.mcap";
  std::map<BeaconAddress, std::vector<FusedPose>> expected;  ///< poses of a replay
  std::size_t pose_count = 0;
  std::string log, log_again;  ///< logs of the two fusions
  std::vector<FusedPose> poses, poses_again;
};

SCENARIO("the same events give the same state, bit for bit") {
  GIVEN("a recording of a lossless fusion, played to another one") {
    static const PlayedTwice run;
    THEN("both computed the poses of a replay, which are those in the recording") {
      const auto recorded = recorded_poses(run.file);
      CHECK(recorded.size() == run.pose_count);
      for (const BeaconAddress address : beacons) {
        CAPTURE(address);
        const auto& expected = run.expected.at(address);
        const auto bits = bits_of_beacon(expected, address);
        CHECK((bits_of_beacon(run.poses, address) == bits));
        CHECK((bits_of_beacon(run.poses_again, address) == bits));
        CHECK((bits_of_beacon(replayed(run.file, address), address) == bits));
        for (const FusedPose& pose : expected) {
          const auto found = recorded.find({address, pose.sequence});
          REQUIRE(found != recorded.end());
          REQUIRE((found->second == bits_of(pose)));
        }
      }
    }
    THEN("both ended in the state of a replay") {
      check_state_hashes(run.log, run.file);
      check_state_hashes(run.log_again, run.file);
    }
  }
}

}  // namespace sonopose::play_poses_test
