/// Consumers that start late, and several simultaneously.

#include "clocks/clocks.hpp"
#include "support/bus.hpp"

#include <nlohmann/json.hpp>

#include <csignal>
#include <iterator>

namespace sonopose::consumers_test {

using namespace sonopose::test;
namespace topics = dds::topics;

/// Returns true if each pose belongs to the next IMU sample, 10 ms after the previous one.
bool without_a_gap(const std::vector<FusedPose>& poses) {
  constexpr TimeNs period_ns = 10'000'000;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (std::abs(poses[i].time_ns - poses[i - 1].time_ns - period_ns) > 1'000) return false;
  }
  return true;
}

SCENARIO("a late consumer receives poses, and the last status at once") {
  GIVEN("a running chain with a consumer from the start") {
    const Bus bus;
    Consumer<sonopose_FusedPose> first(bus, topics::pose);
    Consumer<sonopose_FusionStatus> first_status(bus, topics::fusion_status, dds::topics::Delivery::live);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    REQUIRE(first.wait_for_count(50));
    REQUIRE(first_status.wait_for_count(1));
    WHEN("a second consumer starts") {
      Consumer<sonopose_FusedPose> second(bus, topics::pose);
      Consumer<sonopose_BeaconStatus> beacon(bus, topics::beacon_status);
      Consumer<sonopose_FusionStatus> engine(bus, topics::fusion_status);
      THEN("it receives earlier statuses, and poses from then on; other consumers are not affected") {
        REQUIRE(beacon.wait_for_writers());
        REQUIRE(engine.wait_for_writers());
        const TimeNs matched_ns = clocks::host_now();
        REQUIRE(beacon.wait_for_count(1));
        CHECK(beacon.samples.front().address == 7);
        CHECK(beacon.samples.front().time_ns < matched_ns);
        REQUIRE(engine.wait_for_count(1));
        CHECK(engine.samples.front().time_ns < matched_ns);
        REQUIRE(second.wait_for_count(50));
        CHECK(second.samples.front().time_ns > first.samples.front().time_ns);
        REQUIRE(first.wait_for_more(50));
        CHECK(without_a_gap(first.samples));
        REQUIRE(first_status.wait_for(
            [matched_ns](const FusionStatus& status) { return status.time_ns > matched_ns; }));
        CHECK(first_status.samples.back().events_lost == 0);
        CHECK(first_status.samples.back().imu_gaps == 0);
      }
    }
  }
}

/// Time of the latest pose in a report of the monitor.
TimeNs latest_ns(const std::string& report) {
  return nlohmann::json::parse(report)["beacons"][0]["pose_time_ns"].get<TimeNs>();
}

SCENARIO("two additional consumers at once are served like the first") {
  GIVEN("a running chain") {
    const Bus bus;
    Consumer<sonopose_FusedPose> first(bus, topics::pose);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    REQUIRE(first.wait_for_count(10));
    WHEN("two monitors start together, and one of them is killed") {
      const auto one = bus.monitor({"--json"});
      const auto other = bus.monitor({"--json"});
      REQUIRE(one->wait_for_lines(Stream::output, 1));
      one->send(SIGKILL);
      REQUIRE(one->wait_for_exit() == -SIGKILL);
      const std::size_t printed = other->lines(Stream::output).size();
      REQUIRE(other->wait_for_lines(Stream::output, printed + 2));
      THEN("the other monitor and the first consumer still receive a pose for each IMU sample") {
        const auto lines = other->lines(Stream::output);
        const auto report = nlohmann::json::parse(lines.back());
        const auto& beacon = report["beacons"][0];
        CHECK(beacon["poses"].get<double>() ==
              Approx(100 * seconds_between(latest_ns(lines[lines.size() - 2]), latest_ns(lines.back())))
                  .margin(2));
        REQUIRE(first.wait_for_more(50));
        CHECK(without_a_gap(first.samples));
      }
    }
  }
}

}  // namespace sonopose::consumers_test
