/// Consumers that start late, and several simultaneously.

#include "clocks/clocks.hpp"
#include "support/bus.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

namespace sonopose::consumers_test {

using namespace sonopose::test;
namespace topics = dds::topics;

/// IMU samples without a pose between the first and the last pose; the samples are 10 ms apart.
std::int64_t missing(const std::vector<FusedPose>& poses) {
  const TimeNs span_ns = poses.back().time_ns - poses.front().time_ns;
  return std::llround(static_cast<double>(span_ns) / 10e6) + 1 - static_cast<std::int64_t>(poses.size());
}

/// Checks that no pose is missing, except those that a fusion on a busy machine counts.
void check_missing(Consumer<sonopose_FusedPose>& poses, Consumer<sonopose_FusionStatus>& statuses) {
  const TimeNs now_ns = clocks::host_now();
  REQUIRE(statuses.wait_for([now_ns](const FusionStatus& status) { return status.time_ns > now_ns; }));
  const FusionStatus& status = statuses.samples.back();
  CHECK(missing(poses.samples) >= 0);
  CHECK(missing(poses.samples) <= static_cast<std::int64_t>(status.events_lost + status.poses_skipped));
}

/// Returns true if a late consumer receives a sample from before its match. A periodic one may replace it
/// meanwhile, which several in a row do not suffer.
template <class T>
bool receives_an_earlier_one(const Bus& bus, const dds::topics::Entry<T>& entry) {
  for (int i = 0; i < 5; ++i) {
    Consumer<T> late(bus, entry);
    REQUIRE(late.wait_for_writers());
    const TimeNs matched_ns = clocks::host_now();
    REQUIRE(late.wait_for_count(1));
    CHECK(late.samples.front().address == 7);
    if (late.samples.front().time_ns < matched_ns) return true;
  }
  return false;
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
      THEN("it receives earlier statuses, and poses from then on; other consumers are not affected") {
        CHECK(receives_an_earlier_one(bus, topics::beacon_status));
        first.take();
        CHECK(receives_an_earlier_one(bus, topics::fusion_status));
        first.take();
        REQUIRE(second.wait_for_count(50));
        CHECK(second.samples.front().time_ns > first.samples.front().time_ns);
        REQUIRE(first.wait_for_more(50));
        check_missing(first, first_status);
      }
    }
  }
}

SCENARIO("two additional consumers at once are served like the first") {
  GIVEN("a running chain") {
    const Bus bus;
    Consumer<sonopose_FusedPose> first(bus, topics::pose);
    Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, dds::topics::Delivery::live);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    REQUIRE(first.wait_for_count(10));
    WHEN("two monitors start together, and one of them is killed") {
      const auto one = bus.monitor({"--json"});
      const auto other = bus.monitor({"--json"});
      const auto prints = [&first](const Process& monitor, std::size_t count) {
        return first.wait_until([&] { return monitor.lines(Stream::output).size() >= count; });
      };
      REQUIRE(prints(*one, 1));
      one->send(SIGKILL);
      REQUIRE(one->wait_for_exit() == -SIGKILL);
      const std::size_t printed = other->lines(Stream::output).size();
      REQUIRE(prints(*other, printed + 2));
      THEN("the other monitor and the first consumer still receive a pose for each IMU sample") {
        // A busy fusion skips some, but not in each second.
        double min_error = 1e9;
        TimeNs latest_ns = 0;
        for (const std::string& line : other->lines(Stream::output)) {
          const auto report = nlohmann::json::parse(line);
          if (report["beacons"].empty() || !report["beacons"][0]["pose_time_ns"].is_number()) continue;
          const auto& beacon = report["beacons"][0];
          const TimeNs previous_ns = std::exchange(latest_ns, beacon["pose_time_ns"].get<TimeNs>());
          const double error = beacon["poses"].get<double>() - 100 * seconds_between(previous_ns, latest_ns);
          if (previous_ns != 0) min_error = std::min(min_error, std::abs(error));
        }
        CHECK(min_error <= 2);
        REQUIRE(first.wait_for_more(50));
        check_missing(first, status);
      }
    }
  }
}

}  // namespace sonopose::consumers_test
