/// A log played as fast as possible: nothing is lost, and live equals replay.

#include "recording/log_folder.hpp"
#include "recording/log_meta.hpp"
#include "support/bits.hpp"
#include "support/bus.hpp"
#include "support/checked_run.hpp"
#include "support/matches.hpp"
#include "support/temporary_folder.hpp"
#include "system/replay_rows.hpp"
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <algorithm>
#include <csignal>
#include <string>

namespace sonopose::lossless_test {

using namespace sonopose::test;
namespace topics = dds::topics;

/// Records twenty seconds of the simulator by the bridge itself.
void record_simulation(const Bus& bus, const std::filesystem::path& folder) {
  const auto bridge =
      bus.bridge({"--source", "sim", "--rate", "0", "--duration", "20", "--record", folder.string()});
  REQUIRE(bridge->wait_for_exit() == 0);
}

/// Poses and reports of an engine in this process.
struct Replay {
  std::vector<FusedPose> poses;
  std::vector<FixReport> reports;
};

Replay replay(const std::filesystem::path& folder, const std::string& engine = "documented") {
  Replay replay;
  settings::Settings settings;
  settings::set(settings, "fusion.engine", engine);
  estimation::AnyEstimator estimator{settings};
  for (const Event& event : recording::read_sensor_log(folder).events) {
    const auto output = estimation::process(estimator, event);
    if (const auto* pose = std::get_if<FusedPose>(&output)) replay.poses.push_back(*pose);
    if (const auto* report = std::get_if<FixReport>(&output)) replay.reports.push_back(*report);
  }
  return replay;
}

/// Number of k-th samples that are not bit-identical.
template <class Sample>
std::size_t differences(const std::vector<Sample>& a, const std::vector<Sample>& b) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    if (bits_of(a[k]) != bits_of(b[k])) ++count;
  }
  return count;
}

/// Poses in the files of sonopose-replay.
std::vector<Bits> replayed_rows(const std::filesystem::path& log, const std::filesystem::path& out,
                                const std::string& engine) {
  REQUIRE(run(SONOPOSE_TEST_REPLAY, {log.string(), "--out", out.string(), "--engine", engine}).code == 0);
  return pose_rows(out / "pose.csv");
}

std::string replayed_state_hash(const std::filesystem::path& log, const std::string& engine) {
  const std::string output = output_of(SONOPOSE_TEST_REPLAY, {log.string(), "--engine", engine});
  const std::string name = "state hash";
  const std::size_t at = output.find_first_not_of(' ', output.find(name) + name.size());
  return output.substr(at, 16);
}

SCENARIO("a log played as fast as possible gives every pose once, identical to a replay without DDS") {
  GIVEN("a log of 20 s, a lossless fusion, and consumers that keep all samples") {
    const Bus bus;
    const TemporaryFolder folder;
    record_simulation(bus, folder / "log");
    const auto [engine, meaning] =
        GENERATE(table<std::string, ImuMeaning>({{"documented", ImuMeaning::instant},
                                                 {"kalman", ImuMeaning::instant},
                                                 {"kalman", ImuMeaning::mean_since_last}}));
    CAPTURE(engine, meaning);
    auto meta = recording::read_log_meta(folder / "log");
    CHECK(meta.imu_meaning == ImuMeaning::instant);
    meta.imu_meaning = meaning;
    recording::write_log_meta(folder / "log", meta);
    const Replay expected = replay(folder / "log", engine);
    REQUIRE(expected.poses.size() == 2000);
    REQUIRE(expected.reports.size() > 150);  // at least 8 Hz
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    Consumer<sonopose_FixReport> reports(bus, topics::report);
    const auto fusion = bus.fusion({"--lossless", "--set", "fusion.engine=" + engine});
    REQUIRE(poses.wait_for_writers());
    REQUIRE(reports.wait_for_writers());
    const Arguments play{"--source", "log", "--input", (folder / "log").string(), "--rate", "0"};
    WHEN("the bridge plays the log") {
      REQUIRE(bus.bridge(play)->wait_for_exit() == 0);
      THEN("poses and reports are bit-identical to those of the replay, in order, each once") {
        REQUIRE(poses.wait_for_count(expected.poses.size()));
        REQUIRE(reports.wait_for_count(expected.reports.size()));
        CHECK(fusion->end_by(SIGTERM).code == 0);  // no more poses can follow
        poses.take();
        reports.take();
        CHECK(poses.samples.size() == expected.poses.size());
        CHECK(reports.samples.size() == expected.reports.size());
        CHECK(differences(poses.samples, expected.poses) == 0);
        CHECK(differences(reports.samples, expected.reports) == 0);
        std::vector<Bits> live;
        for (const FusedPose& pose : poses.samples) live.push_back(row_bits_of(pose));
        CHECK((live == replayed_rows(folder / "log", folder / "out", engine)));
        const std::string hash = replayed_state_hash(folder / "log", engine);
        CHECK_THAT(fusion->text(Process::Stream::error),
                   Catch::Contains("beacon 7: state hash " + hash + " after event") &&
                       Catch::Contains("0 events lost"));
      }
    }
    WHEN("the bridge plays the log twice") {
      REQUIRE(bus.bridge(play)->wait_for_exit() == 0);
      REQUIRE(poses.wait_for_count(expected.poses.size()));
      REQUIRE(bus.bridge(play)->wait_for_exit() == 0);
      THEN("the second pass starts over and gives the same poses") {
        REQUIRE(poses.wait_for_count(2 * expected.poses.size()));
        std::vector<FusedPose> second(poses.samples.begin() + 2000, poses.samples.end());
        for (FusedPose& pose : second) {
          REQUIRE(pose.reset_counter == 1);  // signals the jump back to consumers
          pose.reset_counter = 0;
        }
        CHECK(differences(second, expected.poses) == 0);
      }
    }
  }
}

/// Number of lost events that a fusion logs at its end.
std::uint64_t lost_by(Process& fusion) {
  REQUIRE(fusion.end_by(SIGTERM).code == 0);
  const auto match =
      first_match(fusion.text(Stream::error), R"(beacon 7: state hash .*; (\d+) events? lost)");
  REQUIRE_FALSE(match.empty());
  return std::stoull(match[1]);
}

SCENARIO("a log played as fast as possible to a fusion that is not lossless says what it lost") {
  GIVEN("a log of 20 s") {
    const Bus bus;
    const TemporaryFolder folder;
    record_simulation(bus, folder / "log");
    const Arguments play{"--source", "log", "--input", (folder / "log").string(), "--rate", "0"};
    WHEN("it is played to a live fusion") {
      const auto fusion = bus.fusion();
      const auto bridge = bus.bridge(play);
      const auto code = bridge->wait_for_exit();
      THEN("the bridge names the fusion and the option first, and then the number of lost events") {
        const std::string log = bridge->text(Stream::error);
        const std::string name = "sonopose-fusion (process " + std::to_string(fusion->pid());
        CHECK_THAT(log, Catch::Contains(name) && Catch::Contains("may lose events at --rate 0") &&
                            Catch::Contains("without --lossless"));
        const std::uint64_t lost = lost_by(*fusion);
        CAPTURE(lost, log);
        CHECK(code == (lost > 0 ? 1 : 0));
        if (lost > 0) CHECK_THAT(log, Catch::Contains(" has lost " + std::to_string(lost) + " event"));
      }
    }
    WHEN("it is played to a lossless fusion") {
      const auto fusion = bus.fusion({"--lossless"});
      const auto bridge = bus.bridge(play);
      THEN("nothing is lost, and nothing said") {
        CHECK(bridge->wait_for_exit() == 0);
        CHECK_THAT(bridge->text(Stream::error), !Catch::Contains("--lossless"));
        CHECK(lost_by(*fusion) == 0);
      }
    }
  }
}

SCENARIO("a log whose last reader ends before it fails the bridge") {
  const Bus bus;
  const TemporaryFolder folder;
  const std::string log = (folder / "log").string();
  REQUIRE(
      bus.bridge({"--source", "sim", "--rate", "0", "--duration", "200", "--record", log})->wait_for_exit() ==
      0);
  const auto fusion = bus.fusion({"--lossless"});
  const auto bridge = bus.bridge({"--source", "log", "--input", log, "--rate", "0"});
  REQUIRE(fusion->wait_for_line(Stream::error, "beacon 7: found"));
  CHECK(fusion->end_by(SIGTERM).code == 0);
  CHECK(bridge->wait_for_exit() == 1);
  CHECK_THAT(bridge->text(Stream::error), Catch::Contains("the last reader has ended before the recording"));
}

SCENARIO("a lossless fusion that missed the first events reports what it waits for") {
  const Bus bus;
  const auto bridge = bus.bridge({"--source", "sim"});
  Consumer<sonopose_ImuSample> imu(bus, topics::imu, dds::topics::Delivery::live);
  REQUIRE(imu.wait_for_count(1));
  const auto fusion = bus.fusion({"--lossless"});
  CHECK(fusion->wait_for_line(Stream::error, "beacon 7: waiting for event 1,"));
  CHECK(fusion->end_by(SIGTERM).code == 0);
}

}  // namespace sonopose::lossless_test
