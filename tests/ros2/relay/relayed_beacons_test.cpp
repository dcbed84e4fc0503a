#include "ros2/relay/relayed_beacons.hpp"

#include "support/ros2_graph.hpp"
#include "support/test_domain.hpp"

#include <catch2/catch.hpp>

namespace relayed_beacons_test {

using namespace sonopose;
using ros2::relay::BeaconPublishers;
using ros2::relay::RelayedBeacons;

constexpr TimeNs second_ns = 1'000'000'000;
const SteadyTime start = SteadyTime{} + second_ns;

SCENARIO("publishers exist from the first sample of a beacon until it is gone") {
  GIVEN("a node") {
    const test::TestDomain domain;
    test::Watcher<ros2::ParticipantEntitiesInfo> watcher(domain.id());
    const dds::DomainParticipant participant({.domain_id = domain.id()}, ros2::participant_qos());
    const dds::qos::Provider qos;
    ros2::Node node(participant, qos, ros2::NameResolver({}, {}), ros2::Distro::jazzy);
    const auto announced = [&](std::size_t writers) {
      return watcher.wait_until([&] {
        return !watcher.messages.empty() && watcher.messages.back().nodes.size() == 1 &&
               watcher.messages.back().nodes.front().writers.size() == writers;
      });
    };
    const ros2::relay::Output output;
    dds::DataWriter<ros2::TFMessage> no_tf;
    process::Wakeup wakeup;
    RelayedBeacons beacons(wakeup);
    WHEN("a beacon sends") {
      CHECK_FALSE(beacons.find_or_request(7, start));
      CHECK(beacons.requested() == std::vector<BeaconAddress>{7});
      CHECK(beacons.requested().empty());
      beacons.add(7, std::make_shared<BeaconPublishers>(node, output, 7, no_tf, true, wakeup));
      node.announce();
      THEN("its publishers are found and announced") {
        CHECK(beacons.find_or_request(7, start));
        CHECK(beacons.find(7));
        CHECK(beacons.all().size() == 1);
        CHECK(announced(5));  // imu/mag only after a sample with a magnetic field, and no path
      }
      AND_WHEN("it is gone while its publishers are in use") {
        RelayedBeacons::Publishers in_use = beacons.find(7);
        CHECK(beacons.remove_gone(start + 5 * second_ns).empty());
        CHECK(beacons.remove_gone(start + 5 * second_ns + 1) == std::vector<BeaconAddress>{7});
        CHECK_FALSE(beacons.find(7));
        THEN("they are left to the main thread when they are no longer used, and leave the node") {
          CHECK(beacons.take_unused().empty());
          in_use.reset();
          const auto unused = beacons.take_unused();
          REQUIRE(unused.size() == 1);
          unused.front()->leave(node);
          node.announce();
          CHECK(announced(0));
        }
        THEN("they are requested again when it returns") {
          CHECK_FALSE(beacons.find_or_request(7, start + 6 * second_ns));
          CHECK(beacons.requested() == std::vector<BeaconAddress>{7});
        }
      }
    }
  }
}

}  // namespace relayed_beacons_test
