/// Hot standby: counters and messages are of what a consumer misses.

#include "doctor_run.hpp"
#include "standby_pair.hpp"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <string>

namespace sonopose::standby_counts_test {

using namespace sonopose::test;
using Catch::Contains;
namespace topics = dds::topics;

SCENARIO("a fusion without a partner counts no missed deadlines while its consumer misses none") {
  GIVEN("a fusion with a standby strength that serves a beacon, after it has warmed up") {
    const Bus bus;
    Consumer<sonopose_FusionStatus> status(bus, topics::fusion_status, topics::Delivery::live);
    const auto fusion = bus.fusion({"--standby-strength", "50", "--warm-up", "0.2"});
    const auto bridge = bus.bridge({"--scenario", "rest"});
    const auto next_status = [&](FusionRole role) {
      REQUIRE(status.wait_for([role](const FusionStatus& latest) { return latest.role == role; },
                              status.samples.size()));
      return status.samples.back();
    };
    next_status(FusionRole::serving);
    THEN("the counters of its poses do not rise") {
      bool is_still = false;
      for (int second = 0; second < 20 && !is_still; ++second) {  // a busy machine may miss a deadline
        const FusionStatus before = next_status(FusionRole::serving);
        const FusionStatus after = next_status(FusionRole::serving);
        is_still = after.imu_samples > before.imu_samples &&
                   after.pose_deadlines_missed == before.pose_deadlines_missed &&
                   after.liveliness_lost == before.liveliness_lost;
      }
      CHECK(is_still);
    }
  }
}

SCENARIO("what a standby writes is no loss of a monitor") {
  GIVEN("two fusions that serve two beacons") {
    Pair pair({"--scenario", "rest", "--imu-rate", "200", "--beacons", "2"});
    const Fusion weak = pair.start("100");
    pair.wait_until_served_by(weak);
    const Fusion strong = pair.start("200");
    pair.wait_until_served_by(strong);
    WHEN("a monitor has run for some seconds") {
      const auto loses = [&pair] {
        const auto monitor = pair.bus.monitor({"--json"});
        REQUIRE(monitor->wait_for_lines(Stream::output, 4));
        return monitor->text(Stream::error).find("lost on the way to this program") != std::string::npos;
      };
      bool has_lost = loses();
      for (int i = 0; i < 4 && has_lost; ++i) has_lost = loses();  // a starved monitor loses real ones
      THEN("it has reported no lost samples") {
        CHECK_FALSE(has_lost);
      }
    }
  }
}

/// Share of the fixes that the doctor sees refused by a pair: 0 if it reports no refusals, -1 if no beacon.
struct RefusedShare {
  explicit RefusedShare(const std::string& min_quality_of_strong, const std::string& min_quality_of_weak)
      : pair({"--scenario", "walk"}),
        weak(start("100", min_quality_of_weak)),
        strong(start("200", min_quality_of_strong)) {
    pair.wait_until_served_by(strong);
  }

  [[nodiscard]] double look() const {
    const Result result = test::look(pair.bus.domain_id(), {"--duration", "3", "--json"});
    CAPTURE(result.output, result.error);
    double share = -1;
    const nlohmann::json report = nlohmann::json::parse(result.output);
    for (const auto& finding : report["findings"]) {
      if (finding["subject"].get<std::string>().starts_with("beacon ")) share = std::max(share, 0.0);
      const std::string what = finding["what"];
      unsigned refused = 0;
      unsigned reports = 0;
      if (std::sscanf(what.c_str(), "its fusion refuses %u of its %u", &refused, &reports) != 2) continue;
      share = static_cast<double>(refused) / reports;
    }
    return share;
  }

  Pair pair;
  Fusion weak;
  Fusion strong;

private:
  Fusion start(const std::string& strength, const std::string& min_quality_percent) {
    return pair.start(strength,
                      {"--warm-up", "0.2", "--set", "admission.min_quality_percent=" + min_quality_percent});
  }
};

SCENARIO("the doctor counts the fixes of the fusion whose poses consumers receive") {
  // If a busy machine starves the stronger fusion, the other one serves legitimately: look several times.
  constexpr int max_looks = 5;
  GIVEN("a pair whose standby refuses all fixes") {
    const RefusedShare refused("0", "100");
    THEN("the doctor reports no refusals") {
      double share = 1;
      for (int i = 0; i < max_looks && share != 0; ++i) share = refused.look();
      CHECK(share == 0);
    }
  }
  GIVEN("a pair whose serving fusion refuses all fixes") {
    const RefusedShare refused("100", "0");
    THEN("the doctor reports that nearly all are refused") {
      double share = 0;
      for (int i = 0; i < max_looks && share < 0.9; ++i) share = refused.look();
      CHECK(share > 0.9);
    }
  }
}

}  // namespace sonopose::standby_counts_test
