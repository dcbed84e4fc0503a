/// Parameter services in the presence of Fast DDS, whose clients would wait for a reply forever.

#include "support/ros2.hpp"
#include "support/ros2_fields.hpp"
#include <sonopose/dds/psm/discovery.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <string>
#include <thread>

namespace sonopose::fastdds_services_test {

using namespace sonopose::test;

/// A Fast DDS process that ends after the first message on /end.
std::unique_ptr<Process> fast_dds_process(const Bus& bus) {
  auto process =
      std::make_unique<Process>(SONOPOSE_TEST_FASTDDS_PEER, Arguments{"listen", "rt/end", "odometry", "1"},
                                Environment{{"ROS_DOMAIN_ID", std::to_string(bus.domain_id())}});
  REQUIRE(process->wait_for_line(Stream::error, "listening"));
  return process;
}

/// Services as `ros2 service list` would show them.
class Services {
public:
  explicit Services(const Bus& bus)
      : participant_(dds::ext::participant({.domain_id = bus.domain_id()})), discovery_(participant_) {}

  /// Waits until there are this many services.
  [[nodiscard]] bool wait_for_count(std::ptrdiff_t count) const {
    const auto give_up = std::chrono::steady_clock::now() + timeout;
    while (std::chrono::steady_clock::now() < give_up) {
      const auto readers = discovery_.readers();
      if (count == std::count_if(readers.begin(), readers.end(), [](const dds::FoundEndpoint& each) {
            return each.topic_name.starts_with("rq/sonopose/");
          })) {
        return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

private:
  dds::domain::DomainParticipant participant_;
  dds::Discovery discovery_;
};

SCENARIO("services that cannot reply are not offered") {
  GIVEN("a bus without Fast DDS") {
    const Bus bus;
    const Services services(bus);
    WHEN("a relay runs, and a process on Fast DDS starts and ends") {
      const auto relay = bus.ros2();
      THEN("the services are withdrawn meanwhile, and the relay logs it") {
        CHECK(services.wait_for_count(7));
        const auto peer = fast_dds_process(bus);
        CHECK(relay->wait_for_line(Stream::error, "parameter services withdrawn: a process uses Fast DDS"));
        CHECK(services.wait_for_count(0));
        RosWriter<ros2::Odometry> end(bus, "/end");
        REQUIRE(end.wait_for_reader());
        const Filled<ros2::Odometry> any;
        end.write(any.message);
        CHECK(relay->wait_for_line(Stream::error, "parameter services offered"));
        CHECK(services.wait_for_count(7));
      }
    }
    WHEN("the relay is told to offer them always, or never") {
      THEN("it does") {
        const auto peer = fast_dds_process(bus);
        {
          const auto always = bus.ros2({"--services", "on"});
          CHECK(services.wait_for_count(7));
          CHECK(always->end_by(SIGTERM).code == 0);
        }
        REQUIRE(services.wait_for_count(0));
        RosReader<ros2::DiagnosticArray> diagnostics(bus, "/diagnostics");
        const auto never = bus.ros2({"--services", "off"});
        CHECK(diagnostics.wait_for_count(1, [](const auto&) {}));  // everything has been announced by now
        CHECK(services.wait_for_count(0));
      }
    }
  }
}

}  // namespace sonopose::fastdds_services_test
