/// sonopose-monitor --echo: samples of a topic as lines of JSON.

#include "support/bus.hpp"

#include <nlohmann/json.hpp>

#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>

namespace monitor_echo_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;

std::vector<nlohmann::json> objects_of(const Process& process) {
  std::vector<nlohmann::json> objects;
  for (const std::string& line : process.lines(Stream::output))
    objects.push_back(nlohmann::json::parse(line));
  return objects;
}

/// A fusion and a bridge with three beacons.
struct Chain {
  Bus bus;
  std::unique_ptr<Process> fusion = bus.fusion();
  std::unique_ptr<Process> bridge = bus.bridge({"--beacons", "3"});
};

SCENARIO("echo prints each sample of a topic") {
  GIVEN("a chain with three beacons") {
    static const Chain chain;
    const Bus& bus = chain.bus;
    THEN("consecutive poses of one beacon, as many as asked for") {
      const auto echo = bus.monitor({"--echo", "pose", "--beacon", "8", "--count", "100"});
      REQUIRE(echo->wait_for_exit() == 0);
      const auto poses = objects_of(*echo);
      REQUIRE(poses.size() == 100);
      for (std::size_t i = 1; i < poses.size(); ++i) {
        CHECK(poses[i]["address"] == 8);
        CHECK(poses[i]["time"].get<TimeNs>() > poses[i - 1]["time"].get<TimeNs>());
      }
      CHECK(poses.back()["position"]["x"].is_number());
    }
    THEN("IMU samples of all beacons, which measure gravity, until Ctrl-C") {
      const auto echo = bus.monitor({"--echo", "sonopose/imu"});
      REQUIRE(echo->wait_for_lines(Stream::output, 100));
      CHECK(echo->end_by(SIGINT).code == 0);
      std::set<int> addresses;
      for (const auto& sample : objects_of(*echo)) {
        addresses.insert(sample["address"].get<int>());
        CHECK(sample["specific_force"]["z"].get<double>() == Approx(9.81).margin(3.0));
      }
      CHECK(addresses == std::set{7, 8, 9});
    }
    THEN("a status from before the echo at once") {
      const auto first = bus.monitor({"--echo", "fusion_status", "--count", "3"});
      CHECK(first->wait_for_exit() == 0);
      CHECK(objects_of(*first).front().contains("fixes_used"));
    }
    THEN("the lines of the logs, also from before the echo") {
      const auto echo = bus.monitor({"--echo", "log"});
      REQUIRE(
          echo->wait_for_line(Stream::output, R"("program":"sonopose-fusion","level":1,"text":"serving")"));
      REQUIRE(echo->wait_for_line(Stream::output, R"("text":"beacon 9: found)"));
    }
    THEN("it ends quietly when the pipe is closed") {
      const std::string command = std::string(SONOPOSE_TEST_MONITOR) + " --echo pose --domain " +
                                  std::to_string(bus.domain_id()) + " | head -n 1; echo ${PIPESTATUS[0]}";
      const Result result = run("/bin/bash", {"-c", command});
      CHECK(result.code == 0);
      CHECK_THAT(result.output, Contains("\"address\":") && Catch::EndsWith("\n0\n"));
      CHECK(result.error.empty());
    }
  }
}

SCENARIO("the example of an echo in Python prints positions") {
  if (!std::filesystem::exists("/usr/bin/python3")) {
    std::cout << "skipped: no /usr/bin/python3 (apt install python3)\n";
    return;
  }
  GIVEN("a chain with three beacons") {
    const Chain chain;
    WHEN("it runs") {
      const std::string program = SONOPOSE_SOURCE_DIR "/examples/python_echo/positions.py";
      Process example("/usr/bin/python3",
                      {program, "--domain", std::to_string(chain.bus.domain_id()), "--count", "150"},
                      {{"SONOPOSE_MONITOR", SONOPOSE_TEST_MONITOR}});
      REQUIRE(example.wait_for_exit() == 0);
      THEN("it prints the positions of all") {
        CHECK_THAT(example.text(Stream::output),
                   Contains("beacon 7: ") && Contains("beacon 9: ") && Contains(" m\n"));
      }
    }
  }
}

SCENARIO("echo refuses invalid requests") {
  THEN("a topic that does not exist: the nearest one, and all of them") {
    const Result result = run(SONOPOSE_TEST_MONITOR, {"--echo", "beacon_staus"});
    CHECK(result.code.value_or(0) > 0);
    CHECK_THAT(result.error, Contains("beacon_staus: unknown topic; did you mean beacon_status?") &&
                                 Contains("imu, fix, heading") && Contains("settings"));
  }
  THEN("a beacon of a topic that has none") {
    const Bus bus;
    const auto echo = bus.monitor({"--echo", "line_status", "--beacon", "7"});
    CHECK(echo->wait_for_exit() == 1);
    CHECK_THAT(echo->text(Stream::error), Contains("--beacon") && Contains("line_status"));
  }
  THEN("a count without an echo, and JSON as well") {
    CHECK(run(SONOPOSE_TEST_MONITOR, {"--count", "3"}).code.value_or(0) > 0);
    CHECK(run(SONOPOSE_TEST_MONITOR, {"--json", "--echo", "pose"}).code.value_or(0) > 0);
  }
  THEN("a duration without a sample is an error") {
    const Bus bus;
    CHECK(bus.monitor({"--echo", "pose", "--duration", "0.5"})->wait_for_exit() == 1);
  }
}

}  // namespace monitor_echo_test
