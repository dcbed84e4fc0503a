/// sonopose-play: a fusion computes the same poses from what is played.

#include "bus_log/outputs.hpp"
#include "bus_log/sensor_log.hpp"
#include "recorder/messages.hpp"
#include "support/bits.hpp"
#include "support/bus.hpp"
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

namespace play_poses_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
using recorder::test::messages_of;
namespace topics = dds::topics;
namespace fs = std::filesystem;

constexpr std::array<BeaconAddress, 2> beacons{7, 8};

/// The poses that an engine in this process computes from the inputs of a file.
std::vector<FusedPose> replayed(const fs::path& file, BeaconAddress address) {
  estimation::AnyEstimator estimator{settings::Settings{}};
  return poses_of(estimator, bus_log::read_sensor_log(file, address).events);
}

/// Those of a beacon, as bits.
std::vector<Bits> bits_of_beacon(const std::vector<FusedPose>& poses, BeaconAddress address) {
  std::vector<Bits> bits;
  for (const FusedPose& pose : poses) {
    if (pose.address == address) bits.push_back(bits_of(pose));
  }
  return bits;
}

/// The poses in a recording, by beacon and number.
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

/// Waits for the poses of a lossless fusion that gets the inputs in a file from a player, ends it, and
/// returns what it has logged.
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

/// Whether the log of a fusion has the state hash that the replay of the file has, for each beacon.
void check_state_hashes(const std::string& log, const fs::path& file) {
  for (const BeaconAddress address : beacons) {
    const Result replay = run(SONOPOSE_TEST_REPLAY, {file.string(), "--beacon", std::to_string(address)});
    REQUIRE(replay.code == 0);
    const std::size_t name_at = replay.output.find("state hash");
    REQUIRE(name_at != std::string::npos);
    const std::size_t at = replay.output.find_first_not_of(' ', name_at + 10);
    const std::size_t line_at = log.find("beacon " + std::to_string(address) + ": state hash ");
    REQUIRE(line_at != std::string::npos);
    const std::string line = log.substr(line_at, log.find('\n', line_at) - line_at);
    CHECK_THAT(line, Contains("state hash " + replay.output.substr(at, 16) + " after event") &&
                         Catch::EndsWith("; 0 events lost"));
  }
}

SCENARIO("the same events give the same state, bit for bit") {
  GIVEN("inputs of two beacons, a lossless fusion that gets them from a player, and a recorder") {
    const TemporaryFolder folder;
    record_walk(folder / "inputs.mcap", 4.0, {beacons.begin(), beacons.end()});
    std::map<BeaconAddress, std::vector<FusedPose>> expected;
    std::size_t pose_count = 0;
    for (const BeaconAddress address : beacons) {
      expected[address] = replayed(folder / "inputs.mcap", address);
      pose_count += expected[address].size();
    }
    REQUIRE(pose_count == 800);
    const Bus bus;
    const fs::path file = folder / "run.mcap";
    const auto record = start_recording(bus, file, {"--topics", "imu,fix,heading,pose"});
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion({"--lossless"});
    REQUIRE(poses.wait_for_writers());
    // Its writer of poses is older than the one of the settings: then the recorder knows both.
    REQUIRE(wait_for_part(file, {"sonopose/settings"}, 1));
    WHEN("the recording is played to another lossless fusion") {
      const std::string live = play_to(*fusion, poses, bus, folder / "inputs.mcap", "2", pose_count);
      REQUIRE(wait_for_part(file, {"sonopose/imu", "sonopose/fix", "sonopose/heading"},
                            messages_of(folder / "inputs.mcap").size()));
      REQUIRE(wait_for_part(file, {"sonopose/pose"}, pose_count));
      REQUIRE(record->end_by(SIGINT).code == 0);
      const Bus other;
      Consumer<sonopose_FusedPose> poses_again(other, topics::pose);
      const auto fusion_again = other.fusion({"--lossless"});
      REQUIRE(poses_again.wait_for_writers());
      const std::string again = play_to(*fusion_again, poses_again, other, file, "1", pose_count);
      THEN("both computed the poses of a replay, which are those in the recording") {
        const auto recorded = recorded_poses(file);
        CHECK(recorded.size() == pose_count);
        for (const BeaconAddress address : beacons) {
          CAPTURE(address);
          const auto bits = bits_of_beacon(expected[address], address);
          CHECK((bits_of_beacon(poses.samples, address) == bits));
          CHECK((bits_of_beacon(poses_again.samples, address) == bits));
          CHECK((bits_of_beacon(replayed(file, address), address) == bits));
          for (const FusedPose& pose : expected[address]) {
            const auto found = recorded.find({address, pose.sequence});
            REQUIRE(found != recorded.end());
            REQUIRE((found->second == bits_of(pose)));
          }
        }
      }
      THEN("both ended in the state of a replay") {
        check_state_hashes(live, file);
        check_state_hashes(again, file);
      }
    }
  }
}

}  // namespace play_poses_test
