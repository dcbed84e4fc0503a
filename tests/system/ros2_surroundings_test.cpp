/// The relay and the other processes: what it reports of them, and what they see of it.

#include "clocks/clocks.hpp"
#include "support/ros2.hpp"
#include "support/ros2_graph.hpp"
#include <sonopose/ros2/messages/service_types.hpp>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <set>
#include <string>

namespace ros2_surroundings_test {

using namespace sonopose;
using namespace sonopose::test;

SCENARIO("a relay without bridge and fusion says so") {
  GIVEN("a relay alone") {
    const Bus bus;
    const auto relay = bus.ros2();
    THEN("it reports both within 5 s, then the fusion, and when nothing is missing") {
      CHECK(
          relay->wait_for_line(Stream::error, "no bridge and no fusion in domain", std::chrono::seconds(5)));
      const auto bridge = bus.bridge({});
      CHECK(relay->wait_for_line(Stream::error, "warning: no fusion in domain"));
      const auto fusion = bus.fusion();
      CHECK(relay->wait_for_line(Stream::error, "bridge and fusion found"));
    }
  }
}

SCENARIO("two nodes of the same name are reported") {
  GIVEN("a relay") {
    const Bus bus;
    const auto relay = bus.ros2();
    WHEN("another one has the same name") {
      const auto namesake = bus.ros2();
      THEN("both report it") {
        CHECK(relay->wait_for_line(Stream::error, "another process has a node /sonopose"));
        CHECK(namesake->wait_for_line(Stream::error, "another process has a node /sonopose"));
      }
    }
    WHEN("another one has another name") {
      const auto other = bus.ros2({"--namespace", "/robot"});
      THEN("nothing is reported while they find each other") {
        CHECK(other->wait_for_line(Stream::error, "no bridge and no fusion"));
        CHECK(other->text(Stream::error).find("another process") == std::string::npos);
      }
    }
  }
}

SCENARIO("a killed relay leaves the graph soon") {
  GIVEN("a relay that a ROS 2 process lists") {
    const Bus bus;
    Watcher<ros2::HumbleParticipantEntitiesInfo> watcher(bus.domain_id());
    const auto relay = bus.ros2();
    REQUIRE(watcher.wait_until([&] { return watcher.writer_count() == 1; }));
    WHEN("it is killed") {
      relay->send(SIGKILL);
      const auto killed = std::chrono::steady_clock::now();
      THEN("it is gone before the default lease of 10 s ends") {
        CHECK(watcher.wait_until([&] { return watcher.writer_count() == 0; }));
        CHECK(std::chrono::steady_clock::now() - killed < std::chrono::seconds(9));
      }
    }
  }
}

SCENARIO("log lines are published on /rosout, also for late subscribers") {
  GIVEN("a relay in a namespace that has logged a warning and its start") {
    const Bus bus;
    const auto relay = bus.ros2({"--namespace", "/robot"});
    REQUIRE(relay->wait_for_line(Stream::error, "no bridge and no fusion"));
    THEN("a late subscriber receives both, with level and logger") {
      RosReader<ros2::LogMessage> log(bus, "/rosout", Subscription::latched_log);
      std::vector<std::string> lines;
      REQUIRE(log.wait_for_count(2, [&](const ros2::LogMessage& message) {
        lines.push_back(std::to_string(message.level) + " " + message.name + " " + message.msg);
        CHECK(std::abs(seconds_between(ros2::from_ros(message.stamp).value_or(0), clocks::host_now())) < 30);
      }));
      CHECK(lines[0].starts_with("20 robot.sonopose relaying as /robot/sonopose"));
      CHECK(lines[1].starts_with("30 robot.sonopose no bridge and no fusion"));
    }
  }
  GIVEN("a relay with --log-level error and without /rosout") {
    const Bus bus;
    Process relay(SONOPOSE_TEST_ROS2,
                  {"--network", "loopback", "--domain", std::to_string(bus.domain_id()), "--ros-args",
                   "--log-level", "error", "--disable-rosout-logs"},
                  neutral);
    RosReader<ros2::DiagnosticArray> diagnostics(bus, "/diagnostics");
    THEN("it runs silently") {
      REQUIRE(diagnostics.wait_for_count(4, [](const auto&) {}));
      CHECK(relay.text(Stream::error).empty());
      const dds::DomainParticipant participant = dds::make_participant({.domain_id = bus.domain_id()});
      const dds::Discovery discovery(participant);
      for (const auto& writer : discovery.writers()) CHECK(writer.topic_name != "rt/rosout");
    }
  }
}

SCENARIO("changes of parameters are published") {
  GIVEN("a fusion and a relay") {
    const Bus bus;
    RosReader<ros2::ParameterEvent> events(bus, "/parameter_events");
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2();
    const auto names_in = [](const auto& parameters) {
      std::set<std::string> names;
      for (std::uint32_t i = 0; i < parameters._length; ++i) names.insert(parameters._buffer[i].name);
      return names;
    };
    REQUIRE(events.wait_for([&](const ros2::ParameterEvent& event) {
      return event.node == std::string("/sonopose") && names_in(event.new_parameters).contains("trust.n_min");
    }));
    WHEN("a setting changes") {
      REQUIRE(bus.settings({"set", "trust.n_min=5"}).code == 0);
      THEN("an event has the new value, and nothing else") {
        CHECK(events.wait_for([&](const ros2::ParameterEvent& event) {
          const auto& changed = event.changed_parameters;
          return names_in(changed) == std::set<std::string>{"trust.n_min"} &&
                 changed._buffer[0].value.integer_value == 5 && event.new_parameters._length == 0;
        }));
      }
    }
    WHEN("the fusion ends") {
      REQUIRE(fusion->end_by(SIGTERM).code == 0);
      THEN("its parameters are deleted") {
        CHECK(events.wait_for([&](const ros2::ParameterEvent& event) {
          return names_in(event.deleted_parameters).contains("trust.n_min");
        }));
      }
    }
  }
}

}  // namespace ros2_surroundings_test
