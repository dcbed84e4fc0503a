/// The doctor in healthy systems, and in systems with one problem.

#include "support/bus.hpp"

#include <nlohmann/json.hpp>

#include <csignal>

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
namespace topics = dds::topics;

namespace {

/// Runs the doctor to its end.
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

}  // namespace

SCENARIO("the doctor finds no problems in a healthy system") {
  GIVEN("bridge, fusion and a consumer at work") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    REQUIRE(poses.wait_for(is_ready));
    WHEN("the doctor runs") {
      const Result result = doctor(bus.domain_id());
      THEN("it finds no problems, and reports the rates") {
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
      THEN("it is reported with the policy") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        CHECK_THAT(result.output, Contains("test_system (process " + std::to_string(::getpid()) + " on "));
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
      THEN("the missing fusion is reported, and no missing bridge") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        // The remedy depends on other processes on this machine.
        CHECK_THAT(result.output, Contains("no fusion runs in domain " + std::to_string(bus.domain_id())));
        CHECK_THAT(result.output, !Contains("no bridge publishes"));
      }
    }
  }
}

SCENARIO("a wrong mount of the IMU is detected at rest") {
  GIVEN("a level beacon at rest, and a fusion that is configured for a vertical Y axis") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion({"--set", "calibration.axes=+x-z+y"});
    const auto bridge = bus.bridge({"--scenario", "rest"});
    REQUIRE(poses.wait_for_count(1));
    WHEN("the doctor runs") {
      const Result result = doctor(bus.domain_id(), {"--duration", "1"});
      THEN("it reports the direction of gravity, and the setting that corrects it") {
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
  GIVEN("no other process") {
    WHEN("the doctor runs") {
      const Result result = doctor(empty.domain_id(), {"--duration", "0.5"});
      THEN("that is an error") {
        CHECK(result.code == 1);
        CHECK_THAT(result.output,
                   Contains("no sonopose process in domain " + std::to_string(empty.domain_id())));
      }
    }
  }
  GIVEN("a bridge in the domain that ROS_DOMAIN_ID names") {
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    const auto bridge = bus.bridge({});
    REQUIRE(imu.wait_for_count(1));
    WHEN("the doctor runs in another domain") {
      const std::string used = std::to_string(bus.domain_id());
      const Result result = doctor(empty.domain_id(), {"--duration", "0.5"}, {{"ROS_DOMAIN_ID", used}});
      THEN("the remedy names the domain that is in use") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 1);
        CHECK_THAT(result.output,
                   Contains("beacons are published in domain " + used + ": use --domain " + used));
      }
    }
  }
}

SCENARIO("the doctor rejects an invalid command line") {
  const Bus bus;
  CHECK(doctor(bus.domain_id(), {"--duration", "0"}).code.value_or(0) > 1);
  CHECK(doctor(bus.domain_id(), {"--nonsense"}).code.value_or(0) > 1);
}
