/// A fusion with too little processor time.

#include "support/pose_tap.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <set>

namespace sonopose::overload_test {

using namespace sonopose::test;
namespace topics = dds::topics;

#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
constexpr std::size_t beacons = 5;  // each costs many times as much
#else
constexpr std::size_t beacons = 30;
#endif

/// A fusion and a bridge of many beacons.
struct ManyBeacons {
  Bus bus;
  PoseTap poses{bus};
  Consumer<sonopose_FusionStatus> status{bus, topics::fusion_status, topics::Delivery::live};
  Consumer<sonopose_UltrasonicFix> fixes{bus, topics::fix};
  std::unique_ptr<Process> fusion = bus.fusion();
  std::unique_ptr<Process> bridge = bus.bridge({"--beacons", std::to_string(beacons), "--imu-rate", "25"});

  /// Latest status of each beacon from this index.
  [[nodiscard]] std::map<BeaconAddress, FusionStatus> latest(std::size_t from = 0) const {
    std::map<BeaconAddress, FusionStatus> latest;
    for (std::size_t i = from; i < status.samples.size(); ++i) {
      latest[status.samples[i].address] = status.samples[i];
    }
    return latest;
  }

  /// Waits until each beacon's latest status from now on fulfils `wanted`.
  template <class Wanted>
  bool wait_for_all(const Wanted& wanted) {
    const std::size_t from = status.samples.size();
    return status.wait_until([&] {
      const auto all = latest(from);
      return all.size() == beacons &&
             std::all_of(all.begin(), all.end(), [&](const auto& entry) { return wanted(entry.second); });
    });
  }

  /// Stops the fusion until it has a large backlog, and longer each time, until every beacon has a marked
  /// pose and a status says so too: a fast machine may not be overloaded, and a busy one may miss a status,
  /// of which only the latest is kept. Returns the number of beacons that have a marked pose.
  std::size_t overload() {
    std::set<BeaconAddress> marked;
    bool is_in_status = false;
    for (int i = 0; i < 20 && !(is_in_status && marked.size() == beacons); ++i) {
      std::size_t from = poses.count();
      std::size_t from_status = status.samples.size();
      fusion->send(SIGSTOP);
      const int times = 1 + std::min(i, 7);
      REQUIRE(fixes.wait_for_more(static_cast<std::size_t>(8 * times) * beacons));
      fusion->send(SIGCONT);
      const auto is_reported = [&] {
        for (const TappedPose& tapped : poses.since(from)) {
          ++from;
          if ((tapped.pose.status & status_overloaded) != 0U) marked.insert(tapped.pose.address);
        }
        for (; from_status < status.samples.size(); ++from_status) {
          is_in_status = is_in_status || status.samples[from_status].overloaded;
        }
        return is_in_status && marked.size() == beacons;
      };
      status.wait_until([&] { return is_reported() || !marked.empty(); }, std::chrono::milliseconds(500));
      if (!marked.empty()) status.wait_until(is_reported, std::chrono::seconds(5));
    }
    CHECK(is_in_status);
    return marked.size();
  }
};

SCENARIO("an overloaded fusion still serves every beacon") {
  GIVEN("a fusion for many beacons") {
    ManyBeacons many;
    REQUIRE(many.wait_for_all(
        [](const FusionStatus& status) { return status.fixes_used > 10 && !status.overloaded; }));
    WHEN("it is stopped three times until much has gathered") {
      const std::vector<std::size_t> marked{many.overload(), many.overload(), many.overload()};
      THEN("each time every beacon has poses that say so, and so does the status") {
        CHECK(marked == std::vector<std::size_t>(3, beacons));
        AND_WHEN("it is no longer stopped, and then the bridge ends") {
          many.fixes.take();
          const std::size_t sent = many.fixes.samples.size();
          // A beacon's later fixes show which of these were lost.
          REQUIRE(many.fixes.wait_for_more(4 * beacons));
          const bool recovered =
              many.wait_for_all([](const FusionStatus& status) { return !status.overloaded; });
          many.bridge->end_by(SIGINT);
          const bool is_silent = many.wait_for_all(
              [](const FusionStatus& status) { return status.imu_silent && !status.overloaded; });
          THEN("it recovers, has logged both, accounts for every fix, and reports the silence") {
            CHECK(recovered);
            CHECK(many.fusion->wait_for_line(Stream::error, "sonopose-fusion: warning: overloaded"));
            CHECK(many.fusion->wait_for_line(Stream::error, "no longer overloaded"));
            CHECK(is_silent);
            std::uint64_t used = 0;
            std::uint64_t rejected = 0;  // includes those that waited too long
            std::uint64_t lost = 0;      // on a machine so busy that even input is lost
            std::uint64_t skipped = 0;
            for (const auto& entry : many.latest()) {
              used += entry.second.fixes_used;
              rejected += entry.second.fixes_rejected;
              lost += entry.second.events_lost;
              skipped += entry.second.poses_skipped;
            }
            CHECK(used + rejected + lost >= sent);
            CHECK(skipped > 0);
            fmt::print("overload: {} fixes: {} used, {} rejected; {} events lost, {} poses skipped\n", sent,
                       used, rejected, lost, skipped);
          }
        }
      }
    }
  }
}

}  // namespace sonopose::overload_test
