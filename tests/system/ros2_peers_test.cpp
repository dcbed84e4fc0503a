/// The relay and other processes: its reports on them, and their view of it.

#include "clocks/clocks.hpp"
#include "support/ros2.hpp"
#include "support/ros2_graph.hpp"
#include "support/wait_until.hpp"
#include <sonopose/ros2/messages/service_types.hpp>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <set>
#include <string>

namespace sonopose::ros2_peers_test {

using namespace sonopose::test;

SCENARIO("a relay without bridge and fusion says so, also on /rosout, unless it is to be silent") {
  GIVEN("two relays of different names, of which one logs errors only and has no /rosout") {
    const Bus bus;
    Process silent(SONOPOSE_TEST_ROS2,
                   {"--network", "loopback", "--domain", std::to_string(bus.domain_id()), "--ros-args",
                    "--log-level", "error", "--disable-rosout-logs"},
                   neutral);
    RosReader<ros2::DiagnosticArray> diagnostics(bus, "/diagnostics");
    REQUIRE(diagnostics.wait_for_count(1, [](const auto&) {}));
    const auto relay = bus.ros2({"--namespace", "/robot"});
    WHEN("there is nothing else") {
      const bool both_missing = relay->wait_for_line(Stream::error, "no bridge and no fusion in domain");
      RosReader<ros2::LogMessage> log(bus, "/rosout", Subscription::latched_log);
      std::vector<std::string> lines;
      const bool logged = log.wait_for_count(2, [&](const ros2::LogMessage& message) {
        lines.push_back(std::to_string(message.level) + " " + message.name + " " + message.msg);
        CHECK(std::abs(seconds_between(ros2::from_ros(message.stamp).value_or(0), clocks::host_now())) < 300);
      });
      THEN("one says so, also to a late subscriber, and then what is still missing") {
        CHECK(both_missing);
        REQUIRE(logged);
        CHECK(lines[0].starts_with("20 robot.sonopose relaying as /robot/sonopose"));
        CHECK(lines[1].starts_with("30 robot.sonopose no bridge and no fusion"));
        CHECK_THAT(relay->text(Stream::error), !Catch::Contains("another process"));
        CHECK(silent.text(Stream::error).empty());
        const dds::domain::DomainParticipant participant =
            dds::ext::participant({.domain_id = bus.domain_id()});
        const dds::Discovery discovery(participant);
        const auto count = [&](const std::string& topic) {
          const auto writers = discovery.writers();
          return std::count_if(writers.begin(), writers.end(),
                               [&](const auto& writer) { return writer.topic_name == topic; });
        };
        REQUIRE(wait_until([&] { return count("rt/diagnostics") == 2; }));
        CHECK(count("rt/rosout") == 1);
        const auto bridge = bus.bridge({});
        CHECK(relay->wait_for_line(Stream::error, "warning: no fusion in domain"));
        const auto fusion = bus.fusion();
        CHECK(relay->wait_for_line(Stream::error, "bridge and fusion found"));
      }
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
  }
}

SCENARIO("a killed relay leaves the graph soon") {
  GIVEN("a relay, and a process with the default lease of 10 s") {
    const Bus bus;
    Watcher<ros2::HumbleParticipantEntitiesInfo> watcher(bus.domain_id());
    const dds::Discovery discovery(watcher.participant());
    const auto relay = bus.ros2();
    const auto other = bus.settings_watch();
    const auto is_there = [&](const Process& process) {
      const auto all = discovery.participants();
      return std::any_of(all.begin(), all.end(), [&](const auto& each) {
        return each.process_id == static_cast<std::uint32_t>(process.pid());
      });
    };
    REQUIRE(watcher.wait_until(
        [&] { return watcher.writer_count() == 1 && is_there(*relay) && is_there(*other); }));
    WHEN("both are killed") {
      relay->send(SIGKILL);
      other->send(SIGKILL);
      THEN("the relay is gone first") {
        CHECK(watcher.wait_until([&] { return watcher.writer_count() == 0 || !is_there(*other); }));
        CHECK(is_there(*other));
      }
    }
  }
}

SCENARIO("changes of parameters are published") {
  GIVEN("a relay, and then a fusion") {
    const Bus bus;
    RosReader<ros2::ParameterEvent> events(bus, "/parameter_events");
    const auto relay = bus.ros2();
    REQUIRE(events.wait_for_writer());
    const auto fusion = bus.fusion();
    const auto names_in = [](const auto& parameters) {
      std::set<std::string> names;
      for (std::uint32_t i = 0; i < parameters._length; ++i) names.insert(parameters._buffer[i].name);
      return names;
    };
    REQUIRE(events.wait_for([&](const ros2::ParameterEvent& event) {
      return event.node == std::string("/sonopose") &&
             names_in(event.new_parameters).contains("documented.trust.n_min");
    }));
    WHEN("a setting changes") {
      REQUIRE(bus.settings({"set", "documented.trust.n_min=5"}).code == 0);
      THEN("an event has the new value, and nothing else") {
        CHECK(events.wait_for([&](const ros2::ParameterEvent& event) {
          const auto& changed = event.changed_parameters;
          return names_in(changed) == std::set<std::string>{"documented.trust.n_min"} &&
                 changed._buffer[0].value.integer_value == 5 && event.new_parameters._length == 0;
        }));
      }
    }
    WHEN("the fusion ends") {
      REQUIRE(fusion->end_by(SIGTERM).code == 0);
      THEN("its parameters are deleted") {
        CHECK(events.wait_for([&](const ros2::ParameterEvent& event) {
          return names_in(event.deleted_parameters).contains("documented.trust.n_min");
        }));
      }
    }
  }
}

}  // namespace sonopose::ros2_peers_test
