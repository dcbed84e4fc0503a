/// Two beacons with different engines, and the engines' published estimates of the sensors.

#include "support/bus.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <map>

namespace sonopose::engines_test {

using namespace sonopose::test;
namespace topics = dds::topics;

constexpr BeaconAddress documented_beacon = 7;
constexpr BeaconAddress kalman_beacon = 8;

/// Two simulated beacons; the fusion uses the documented engine for the first and the default engine for the
/// other.
struct Chain {
  Bus bus;
  Consumer<sonopose_Estimate> estimates{bus, topics::estimate, dds::topics::Delivery::live};
  Consumer<sonopose_FusedPose> poses{bus, topics::pose};
  Consumer<sonopose_TruthSample> truth{bus, topics::truth};
  std::unique_ptr<Process> fusion = bus.fusion({"--set", "beacon.7.fusion.engine=documented"});
  std::unique_ptr<Process> bridge = bus.bridge({"--address", "7", "--beacons", "2"});

  /// Waits for estimates: the gyro bias is measured at rest, then the first fixes are used.
  bool wait_until_estimated() {
    const auto is_known = [](BeaconAddress address) {
      return [address](const Estimate& estimate) {
        return estimate.address == address && estimate.gyro_bias_body_radps;
      };
    };
    return estimates.wait_for(is_known(documented_beacon)) && estimates.wait_for(is_known(kalman_beacon));
  }

  [[nodiscard]] Estimate latest_of(BeaconAddress address) const {
    return *std::find_if(estimates.samples.rbegin(), estimates.samples.rend(),
                         [address](const Estimate& estimate) { return estimate.address == address; });
  }
};

SCENARIO("each beacon has the engine that is set for it, and its estimates come once a second") {
  GIVEN("one beacon with the documented engine and one with the Kalman engine") {
    Chain chain;
    REQUIRE(chain.wait_until_estimated());
    WHEN("two more estimates of each have come") {
      const TimeNs began_ns = chain.estimates.samples.back().time_ns;
      REQUIRE(chain.estimates.wait_for_more(4));
      const TimeNs ended_ns = chain.estimates.samples.back().time_ns;
      THEN("they are seconds apart, and the engines follow their beacons and differ in what they estimate") {
        chain.poses.take();
        CHECK(seconds_between(began_ns, ended_ns) > 0.9);  // the first may be late by a period
        const Estimate documented = chain.latest_of(documented_beacon);
        const Estimate kalman = chain.latest_of(kalman_beacon);
        CHECK(documented.fusion_id == kalman.fusion_id);
        CHECK(documented.gyro_bias_body_radps);
        CHECK_FALSE(documented.accelerometer_bias_body_mps2);
        CHECK_FALSE(documented.lever_arm_body_m);
        CHECK_FALSE(documented.fix_noise_m);
        REQUIRE(kalman.gyro_bias_body_radps);
        REQUIRE(kalman.accelerometer_bias_body_mps2);
        REQUIRE(kalman.lever_arm_body_m);
        CHECK(kalman.gyro_bias_body_radps->std.minCoeff() > 0.0);
        CHECK(kalman.accelerometer_bias_body_mps2->std.minCoeff() > 0.0);
        CHECK(kalman.lever_arm_body_m->std.minCoeff() > 0.0);
        REQUIRE(kalman.fix_noise_m);
        CHECK(chain.estimates.wait_for([](const Estimate& estimate) {  // the noise is learned from the fixes
          return estimate.address == kalman_beacon && estimate.fix_noise_m &&
                 std::abs(estimate.fix_noise_m->value - 0.02) < 0.02;
        }));
        CHECK(kalman.heading_noise_rad);
        CHECK_FALSE(kalman.delay_s);
        chain.truth.take();
        std::map<std::pair<BeaconAddress, TimeNs>, Vector3d> true_position_m;
        for (const TruthSample& sample : chain.truth.samples) {
          true_position_m[{sample.address, sample.time_ns}] = sample.position_world_m;
        }
        std::map<BeaconAddress, std::size_t> compared;
        for (const FusedPose& pose : chain.poses.samples) {
          const auto found = true_position_m.find({pose.address, pose.time_ns});
          if (found == true_position_m.end() || (pose.status & status_initialising) != 0) continue;
          CAPTURE(pose.address, pose.sequence);
          REQUIRE((pose.position_world_m - found->second).norm() < 0.15);
          ++compared[pose.address];
        }
        CHECK(compared[documented_beacon] > 50);
        CHECK(compared[kalman_beacon] > 50);
      }
    }
  }
}

SCENARIO("the monitor shows what each engine has estimated") {
  GIVEN("one beacon with the documented engine and one with the Kalman engine") {
    Chain chain;
    REQUIRE(chain.wait_until_estimated());
    const auto monitor = chain.bus.monitor({"--json"});
    const auto table = chain.bus.monitor({});
    THEN("its JSON has the values, with null for what an engine does not estimate") {
      REQUIRE(monitor->wait_for_lines(Stream::output, 2));
      const auto report = nlohmann::json::parse(monitor->lines(Stream::output)[1]);
      REQUIRE(report["beacons"].size() == 2);
      const auto& documented = report["beacons"][0]["estimate"];
      const auto& kalman = report["beacons"][1]["estimate"];
      CHECK(documented["gyro_bias_radps"]["value"].size() == 3);
      CHECK(documented["gyro_bias_radps"]["std"].is_null());
      CHECK(documented["lever_arm_m"].is_null());
      CHECK(kalman["gyro_bias_radps"]["std"].size() == 3);
      CHECK(kalman["lever_arm_m"]["value"].size() == 3);
      CHECK(kalman["fix_noise_m"]["value"].get<double>() > 0.0);
      CHECK(kalman["delay_s"].is_null());
      AND_THEN("its table has them with units, and lists what is not estimated") {
        REQUIRE(table->wait_for_line(Stream::output, "     8  not estimated: delay"));
        CHECK(table->end_by(SIGINT).code == 0);
        const std::string text = table->text(Stream::output);
        CHECK_THAT(text, Catch::Contains("     7  gyro bias") && Catch::Contains(" rad/s\n") &&
                             Catch::Contains("     7  not estimated: accelerometer bias, lever arm") &&
                             Catch::Contains("     8  accelerometer bias") && Catch::Contains(" m/s²\n") &&
                             Catch::Contains("     8  heading noise"));
      }
    }
  }
}

}  // namespace sonopose::engines_test
