/// The demo chain: bridge with the simulator, fusion, monitor.

#include "clocks/clocks.hpp"
#include "support/bus.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <map>
#include <string>
#include <vector>

namespace sonopose::chain_test {

using namespace sonopose::test;
namespace topics = dds::topics;

bool is_ready(const FusedPose& pose) {
  return (pose.status & status_initialising) == 0U;
}

template <class Samples>
std::vector<std::uint64_t> numbers_between(const Samples& samples, std::uint64_t first, std::uint64_t last) {
  std::vector<std::uint64_t> numbers;
  for (const auto& sample : samples) {
    if (sample.sequence >= first && sample.sequence <= last) numbers.push_back(sample.sequence);
  }
  return numbers;
}

double farthest_from_truth_m(const std::vector<FusedPose>& poses, const std::vector<TruthSample>& truth) {
  std::map<TimeNs, Vector3d> true_position_m;
  for (const TruthSample& sample : truth) true_position_m[sample.time_ns] = sample.position_world_m;
  double farthest_m = 0;
  std::size_t compared = 0;
  for (const FusedPose& pose : poses) {
    if (seconds_between(poses.front().time_ns, pose.time_ns) < 1.0)
      continue;  // the speed is unknown at first
    const auto found = true_position_m.find(pose.time_ns);
    if (found == true_position_m.end() || !is_ready(pose)) continue;
    farthest_m = std::max(farthest_m, (pose.position_world_m - found->second).norm());
    ++compared;
  }
  REQUIRE(compared > 200);
  return farthest_m;
}

/// Checks the order of the stamps: measured, published, taken, written, received.
void check_way(const std::vector<FusedPose>& poses, const std::vector<TimeNs>& received_ns) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const FusedPose& pose = poses[i];
    REQUIRE(pose.imu_sensor_time_ns == pose.time_ns);
    REQUIRE(pose.imu_sensor_time_ns <= pose.imu_bridge_time_ns);
    REQUIRE(pose.imu_bridge_time_ns <= pose.fusion_in_time_ns);
    REQUIRE(pose.fusion_in_time_ns <= pose.fusion_out_time_ns);
    REQUIRE(pose.fusion_out_time_ns <= received_ns[i]);
  }
}

SCENARIO("the fusion publishes a pose for every IMU sample of the simulated beacon") {
  GIVEN("fusion, consumers and a bridge with the simulator: 100 Hz, a walk that starts after 3 s") {
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    Consumer<sonopose_TruthSample> truth(bus, topics::truth);
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    WHEN("the beacon has walked for two seconds") {
      REQUIRE(poses.wait_for_count(500));
      const auto& received_ns = poses.received_ns;
      const std::uint64_t last = poses.samples.back().sequence;
      REQUIRE(imu.wait_for([last](const ImuSample& sample) { return sample.sequence >= last; }));
      // The bridge does not wait for readers, so fusion and test may match it at different samples.
      const std::uint64_t first = std::max(poses.samples.front().sequence, imu.samples.front().sequence);
      REQUIRE(truth.wait_for(
          [&](const TruthSample& sample) { return sample.time_ns >= poses.samples.back().time_ns; }));
      THEN(
          "there is one pose for each IMU sample, in order, at the IMU's rate, with its way in order, and "
          "right") {
        const auto pose_numbers = numbers_between(poses.samples, first, last);
        CHECK(pose_numbers.size() > 300);
        CHECK(pose_numbers == numbers_between(imu.samples, first, last));
        CHECK(std::adjacent_find(pose_numbers.begin(), pose_numbers.end(), std::greater_equal<>()) ==
              pose_numbers.end());
        const double span_s = seconds_between(poses.samples.front().time_ns, poses.samples.back().time_ns);
        CHECK(static_cast<double>(poses.samples.size() - 1) / span_s == Approx(100.0).epsilon(0.001));
        CHECK(farthest_from_truth_m(poses.samples, truth.samples) < 0.10);
        check_way(poses.samples, received_ns);
      }
    }
  }
}

SCENARIO("the monitor prints JSON, one object per second") {
  GIVEN("a running bridge and fusion") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({"--address", "12"});
    REQUIRE(poses.wait_for(is_ready));
    WHEN("it has printed four lines") {
      const SteadyTime began = clocks::steady_now();
      const auto monitor = bus.monitor({"--json"});
      REQUIRE(monitor->wait_for_lines(Stream::output, 4));
      const TimeNs took_ns = clocks::steady_now() - began;
      CHECK(monitor->end_by(SIGINT).code == 0);
      THEN("it has reported the beacon in each second, with a pose for every IMU sample") {
        CHECK(took_ns >= 4'000'000'000);
        std::vector<nlohmann::json> reports;
        for (const std::string& line : monitor->lines(Stream::output)) {
          reports.push_back(nlohmann::json::parse(line));
          REQUIRE(reports.back()["beacons"].size() == 1);
        }
        const auto time_ns = [](const nlohmann::json& object, const char* name) {
          return object[name].get<TimeNs>();
        };
        // A busy machine may delay a line or skip poses, but not each time.
        double least_missing = 1e9;
        double shortest_s = 1e9;
        double least_rate_error = 1e9;
        for (std::size_t i = 1; i < reports.size(); ++i) {
          const auto& latest = reports[i]["beacons"][0];
          const auto& previous = reports[i - 1]["beacons"][0];
          const double poses_of_samples =
              100.0 * seconds_between(time_ns(previous, "pose_time_ns"), time_ns(latest, "pose_time_ns"));
          least_missing = std::min(least_missing, std::abs(latest["poses"].get<double>() - poses_of_samples));
          const double period_s =
              seconds_between(time_ns(reports[i - 1], "time_ns"), time_ns(reports[i], "time_ns"));
          const double rate_hz = latest["poses"].get<double>() / period_s;
          shortest_s = std::min(shortest_s, period_s);
          least_rate_error =
              std::min(least_rate_error, std::abs(latest["pose_rate_hz"].get<double>() / rate_hz - 1.0));
        }
        CHECK(least_missing <= 2);
        CHECK(shortest_s < 1.5);
        CHECK(least_rate_error < 0.2);
        const auto& beacon = reports.back()["beacons"][0];
        CHECK(beacon["address"] == 12);
        CHECK(beacon["latency_p50_s"].get<double>() > 0.0);
        CHECK(beacon["latency_p50_s"].get<double>() <= beacon["latency_p99_s"].get<double>());
        CHECK(beacon["position_error_max_m"].get<double>() < 0.10);
        CHECK((beacon["status_words"] == "ok") == (beacon["status"] == 0));
        CHECK(beacon["bridge"]["other_bridges"] == 0);
        CHECK(beacon["fusion"]["imu_samples"].get<int>() > 100);
        CHECK(beacon["fusion"]["events_lost"] == 0);
      }
    }
  }
}

SCENARIO("the monitor prints a table and a summary") {
  GIVEN("a running bridge and fusion") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    REQUIRE(poses.wait_for(is_ready));
    WHEN("it runs for a while and is stopped by Ctrl-C") {
      const auto monitor = bus.monitor({});
      REQUIRE(monitor->wait_for_line(Stream::output, "     7  "));
      CHECK(monitor->end_by(SIGINT).code == 0);
      THEN("it has printed a table without terminal control codes, and then a summary") {
        const std::string text = monitor->text(Stream::output);
        CHECK_THAT(text, Catch::StartsWith("beacon  pose/IMU/fix Hz"));
        CHECK_THAT(text, !Catch::Contains("\x1b"));
        CHECK_THAT(text, Catch::Contains("beacon 7 over"));
        CHECK_THAT(text, Catch::Contains("(against the simulator's truth)"));
      }
    }
  }
}

SCENARIO("programs use the domain of ROS_DOMAIN_ID") {
  GIVEN("a fusion and a bridge with the domain in the environment only") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const Environment environment{{"ROS_DOMAIN_ID", std::to_string(bus.domain_id())}};
    Process fusion(SONOPOSE_TEST_FUSION, {}, environment);
    Process bridge(SONOPOSE_TEST_BRIDGE, {}, environment);
    THEN("their poses arrive in that domain") {
      CHECK(poses.wait_for_count(10));
    }
  }
}

}  // namespace sonopose::chain_test
