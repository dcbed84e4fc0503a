#include "ros2/relay/relayed_beacons.hpp"

#include "support/ros2_graph.hpp"
#include "support/test_domain.hpp"

#include <catch2/catch.hpp>

namespace sonopose::relayed_beacons_test {

using ros2::relay::BeaconPublishers;
using ros2::relay::RelayedBeacons;

constexpr TimeNs second_ns = 1'000'000'000;
const SteadyTime start = SteadyTime{} + second_ns;

SCENARIO("a fix without a learned noise is as uncertain as its engine assumes") {
  EffectiveSettings settings;
  settings.values = {{"fusion.engine", "documented"}, {"documented.uncertainty.fix_std_m", "0.1"}};
  CHECK(ros2::relay::fix_std_of(settings) == 0.1);
  settings.values.front().value = "kalman";
  CHECK(ros2::relay::fix_std_of(settings) == 0.05);
}

SCENARIO("publishers exist from the first sample of a beacon, and are kept for its return") {
  GIVEN("a node") {
    const test::TestDomain domain;
    test::Watcher<ros2::ParticipantEntitiesInfo> watcher(domain.id());
    const auto participant = dds::ext::participant({.domain_id = domain.id()}, ros2::participant_qos());
    const dds::qos::Provider qos;
    ros2::Node node(participant, qos, ros2::NameResolver({}, {}), ros2::Distro::jazzy);
    const auto announced = [&](std::size_t writers) {
      return watcher.wait_until([&] {
        return !watcher.messages.empty() && watcher.messages.back().nodes.size() == 1 &&
               watcher.messages.back().nodes.front().writers.size() == writers;
      });
    };
    const ros2::relay::Output output;
    dds::pub::DataWriter<ros2::TFMessage> no_tf = dds::core::null;
    process::Wakeup wakeup;
    constexpr std::size_t max_beacons = 2;
    RelayedBeacons beacons(wakeup, max_beacons);
    const auto add = [&](BeaconAddress address) {
      beacons.add(address, std::make_shared<BeaconPublishers>(node, output, address, no_tf, true, wakeup));
    };
    const auto hear_often = [&](BeaconAddress address, SteadyTime time) {
      for (int i = 0; i < 100; ++i) beacons.find_or_request(address, time);
    };
    WHEN("a beacon sends") {
      CHECK_FALSE(beacons.find_or_request(7, start));
      CHECK(beacons.requested() == std::vector<BeaconAddress>{7});
      CHECK(beacons.requested().empty());
      add(7);
      node.announce();
      THEN("its publishers are found and announced") {
        CHECK(beacons.find_or_request(7, start));
        CHECK(beacons.find(7));
        CHECK(beacons.all().size() == 1);
        CHECK(announced(5));  // imu/mag follows a sample with a magnetic field; there is no path
      }
      AND_WHEN("it is gone while its publishers are in use") {
        RelayedBeacons::Publishers in_use = beacons.find(7);
        CHECK(beacons.remove_gone(start + 5 * second_ns).empty());
        const auto gone = beacons.remove_gone(start + 5 * second_ns + 1);
        REQUIRE(gone.size() == 1);
        CHECK(gone.front().address == 7);
        CHECK_FALSE(gone.front().kept);  // a single sample may be noise on a line
        CHECK_FALSE(beacons.take_kept(7));
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
    WHEN("a beacon that was heard for a while is gone") {
      hear_often(7, start);
      add(7);
      const RelayedBeacons::Publishers publishers = beacons.find(7);
      const auto gone = beacons.remove_gone(start + 60 * second_ns + 1);
      REQUIRE(gone.size() == 1);
      CHECK(gone.front().kept);
      CHECK(beacons.all().empty());
      THEN("its publishers are kept for its return") {
        CHECK_FALSE(beacons.find_or_request(7, start + 90 * second_ns));
        CHECK(beacons.requested() == std::vector<BeaconAddress>{7});
        CHECK(beacons.take_kept(7) == publishers);
      }
      AND_WHEN("as many other beacons come as may be relayed") {
        beacons.find_or_request(8, start + 90 * second_ns);
        THEN("the first leaves them") {
          CHECK(beacons.remove_surplus().empty());
        }
        THEN("the second takes their place") {
          beacons.find_or_request(9, start + 90 * second_ns);
          CHECK(beacons.remove_surplus() == std::vector<BeaconAddress>{7});
          CHECK_FALSE(beacons.take_kept(7));
        }
      }
    }
    WHEN("two such beacons are gone and a third one comes") {
      hear_often(8, start);
      add(8);
      beacons.remove_gone(start + 61 * second_ns);
      hear_often(7, start + 61 * second_ns);
      add(7);
      beacons.remove_gone(start + 122 * second_ns);
      beacons.find_or_request(9, start + 122 * second_ns);
      THEN("it takes the place of the one that has been gone longer") {
        CHECK(beacons.remove_surplus() == std::vector<BeaconAddress>{8});
        CHECK(beacons.take_kept(7));
      }
    }
  }
}

}  // namespace sonopose::relayed_beacons_test
