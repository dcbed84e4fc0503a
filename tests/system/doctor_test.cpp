/// The doctor on healthy systems, and on systems with one fault.

#include "support/bus.hpp"

#include <nlohmann/json.hpp>

#include <csignal>

namespace doctor_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
namespace topics = dds::topics;

/// Runs the doctor until it exits.
Result doctor(std::uint32_t domain_id, Arguments arguments = {}, const Environment& changes = {}) {
  arguments.insert(arguments.end(), {"--domain", std::to_string(domain_id)});
  Environment environment = neutral;
  for (const auto& [name, value] : changes) environment[name] = value;
  return run(SONOPOSE_TEST_DOCTOR, arguments, environment);
}

bool is_ready(const FusedPose& pose) {
  constexpr std::uint32_t not_yet = status_initialising | status_uncalibrated | status_heading_unknown;
  return (pose.status & not_yet) == 0U;
}

SCENARIO("the doctor finds no problem in a healthy system") {
  GIVEN("a running bridge, fusion and consumer") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    REQUIRE(poses.wait_for(is_ready));
    WHEN("the doctor runs") {
      const Result result = doctor(bus.domain_id(), {"--duration", "3"});
      THEN("it reports no problem, and the rates") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 0);
        CHECK_THAT(result.output, Contains("no problems found") && Contains("beacon 7: IMU "));
        CHECK_THAT(result.output, Contains("domain " + std::to_string(bus.domain_id())));
      }
    }
    WHEN("JSON is requested") {
      const Result result = doctor(bus.domain_id(), {"--json", "--duration", "1"});
      THEN("the output is one object") {
        const auto report = nlohmann::json::parse(result.output);
        CHECK(report["ok"] == true);
        CHECK(report["findings"].size() >= 2);
      }
    }
    WHEN("a consumer requests shared ownership") {
      const dds::DomainParticipant participant({.domain_id = bus.domain_id()});
      const dds::Topic<sonopose_FusedPose> topic(participant, topics::pose.name);
      const dds::DataReader<sonopose_FusedPose> shared(participant, topic);
      const Result result = doctor(bus.domain_id(), {"--duration", "1"});
      THEN("it is named, with the policy and the remedy") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        CHECK_THAT(result.output,
                   Contains("test_system_doctor (process " + std::to_string(::getpid()) + " on "));
        CHECK_THAT(result.output, Contains("cannot receive from") &&
                                      Contains("sonopose-fusion (process " + std::to_string(fusion->pid())));
        CHECK_THAT(result.output, Contains("ownership: offered exclusive, requested shared"));
      }
    }
    WHEN("a second bridge publishes the same beacon") {
      const auto second = bus.bridge({});
      REQUIRE(second->wait_for_line(Stream::error, "another bridge publishes beacon 7 too"));
      const Result result = doctor(bus.domain_id(), {"--duration", "1"});
      THEN("both are reported") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        CHECK_THAT(result.output, Contains("beacon 7: 2 bridges publish it"));
        for (const auto* const process : {bridge.get(), second.get()}) {
          CHECK_THAT(result.output, Contains("process " + std::to_string(process->pid())));
        }
      }
    }
    WHEN("the fusion ends") {
      REQUIRE(fusion->end_by(SIGINT).code == 0);
      const Result result = doctor(bus.domain_id(), {"--duration", "0.5"});
      THEN("the doctor reports that it is missing, and that the beacon is healthy") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        // The remedy depends on other processes of this machine.
        CHECK_THAT(result.output, Contains("no fusion runs in domain " + std::to_string(bus.domain_id())));
        CHECK_THAT(result.output, !Contains("no bridge publishes"));
      }
    }
  }
}

SCENARIO("the doctor detects a rotated IMU at rest") {
  GIVEN("a level beacon at rest, and a fusion whose settings make the sensor's Y vertical") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion({"--set", "calibration.axes=+x-z+y"});
    const auto bridge = bus.bridge({"--scenario", "rest"});
    REQUIRE(poses.wait_for_count(1));
    WHEN("the doctor runs") {
      const Result result = doctor(bus.domain_id(), {"--duration", "1"});
      THEN("it reports the direction of gravity and the setting that corrects it") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        CHECK_THAT(result.output, Contains("along -y of the body instead of +z"));
        CHECK_THAT(result.output, Contains("calibration.axes=+x+y+z;"));
      }
    }
  }
}

SCENARIO("the doctor reports an empty domain, and finds a system in another domain") {
  const Bus empty;
  GIVEN("an empty domain") {
    WHEN("the doctor runs") {
      const Result result = doctor(empty.domain_id(), {"--duration", "0.5"});
      THEN("it reports an error") {
        CHECK(result.code == 1);
        CHECK_THAT(result.output,
                   Contains("no sonopose process in domain " + std::to_string(empty.domain_id())));
      }
    }
  }
  GIVEN("a bridge in another domain") {
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    const auto bridge = bus.bridge({});
    REQUIRE(imu.wait_for_count(1));
    WHEN("the doctor checks another domain") {
      const std::string used = std::to_string(bus.domain_id());
      const Result result = doctor(empty.domain_id(), {"--duration", "0.5"});
      THEN("it names the correct domain") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        CHECK_THAT(result.output,
                   Contains("beacons are published in domain " + used + ": use --domain " + used));
      }
    }
  }
}

SCENARIO("the doctor refuses an invalid command line") {
  const Bus bus;
  CHECK(doctor(bus.domain_id(), {"--duration", "0"}).code.value_or(0) > 1);
  CHECK(doctor(bus.domain_id(), {"--nonsense"}).code.value_or(0) > 1);
}

}  // namespace doctor_test
