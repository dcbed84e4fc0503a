/// State changes detected in poses and reports.

#include "transitions/transition_detector.hpp"

#include <catch2/catch.hpp>

#include <vector>

namespace transition_detector_test {

using namespace sonopose;
using namespace sonopose::transitions;

constexpr TimeNs second_ns = 1'000'000'000;

/// Poses every 10 ms, fixes, and the changes that they reveal.
class Watched {
public:
  void poses(double for_s, std::uint32_t status, std::uint32_t reset_counter = 0) {
    for (const TimeNs end_ns = time_ns_ + static_cast<TimeNs>(for_s * 1e9); time_ns_ < end_ns;) {
      FusedPose pose;
      pose.address = 7;
      pose.time_ns = time_ns_;
      pose.status = status;
      pose.reset_counter = reset_counter;
      pose.since_valid_fix_s = 1.2;
      watch_.on(pose, pending_);
      time_ns_ += second_ns / 100;
    }
  }

  void fixes(int count, std::uint32_t flags, const Vector3d& jump_m = Vector3d::Zero()) {
    for (int i = 0; i < count; ++i) {
      FixReport report;
      report.address = 7;
      report.emission_time_ns = time_ns_;
      report.flags = flags;
      report.innovation_world_m = Vector3d(3.0, 4.0, 0.0);
      report.jump_world_m = jump_m;
      watch_.on(report, pending_);
      time_ns_ += second_ns / 10;
    }
  }

  void set_clock(double by_s) { time_ns_ += to_ns(by_s); }

  /// Returns the changes since the last call.
  std::vector<Transition> changes() {
    const std::vector<Transition> values(pending_.values().begin(), pending_.values().end());
    pending_.clear();
    return values;
  }

  [[nodiscard]] const TransitionQueue& pending() const { return pending_; }

private:
  TimeNs time_ns_ = 1'700'000'000 * second_ns;
  TransitionDetector watch_{7};
  TransitionQueue pending_;
};

SCENARIO("a beacon that starts is initialised once, and what is usual at a start is no change") {
  Watched beacon;
  beacon.poses(1.5, status_initialising | status_heading_unknown);
  CHECK(beacon.changes().empty());
  beacon.poses(2.0, status_heading_unknown | status_uncalibrated | status_converging);
  const auto first = beacon.changes();
  REQUIRE(first.size() == 1);
  CHECK(first[0].kind == Kind::initialised);
  CHECK(first[0].lasted_s == Approx(1.5));
  beacon.poses(2.0, 0);
  const auto known = beacon.changes();
  REQUIRE(known.size() == 2);
  CHECK((known[0].kind == Kind::converging && !known[0].begins));
  CHECK((known[1].kind == Kind::heading_unknown && !known[1].begins));
  CHECK(known[1].lasted_s == Approx(2.0));
}

SCENARIO("a state is a change when it begins and when it ends, not at each pose") {
  struct Case {
    PoseStatus bit;
    Kind kind;
  };
  const auto [bit, kind] =
      GENERATE(Case{status_stale, Kind::stale}, Case{status_frozen_track, Kind::frozen},
               Case{status_converging, Kind::converging}, Case{status_low_trust, Kind::low_trust},
               Case{status_heading_unknown, Kind::heading_unknown}, Case{status_imu_gap, Kind::imu_gap});
  Watched beacon;
  beacon.poses(1.0, 0);
  beacon.changes();
  beacon.poses(3.0, bit);
  CHECK(beacon.changes() == std::vector{Transition{.address = 7, .kind = kind, .value = 1.2}});
  beacon.poses(1.0, 0);
  const auto ended = beacon.changes();
  REQUIRE(ended.size() == 1);
  CHECK((ended[0].kind == kind && !ended[0].begins));
  CHECK(ended[0].lasted_s == Approx(3.0));
}

SCENARIO("a step of the clock is not among the durations") {
  const double step_s = GENERATE(-3600.0, 285e6);
  Watched beacon;
  beacon.poses(0.5, status_initialising);
  beacon.set_clock(step_s);
  beacon.poses(1.0, status_initialising);
  beacon.poses(1.0, status_converging);
  const auto first = beacon.changes();
  REQUIRE(first.size() == 1);
  CHECK(first[0].lasted_s == Approx(1.5).margin(0.02));
  beacon.set_clock(step_s);
  beacon.poses(1.0, 0);
  const auto ended = beacon.changes();
  REQUIRE(ended.size() == 1);
  CHECK(ended[0].lasted_s == Approx(1.0).margin(0.02));
}

SCENARIO("poses between samples and late poses are no change") {
  Watched beacon;
  beacon.poses(1.0, 0);
  beacon.changes();
  beacon.poses(1.0, status_late | status_rotating_fast);
  beacon.poses(1.0, status_predicted | status_stale);
  CHECK(beacon.changes().empty());
}

SCENARIO("a reset is a restart, and the beacon is initialised again") {
  Watched beacon;
  beacon.poses(1.0, 0, 3);
  beacon.changes();
  beacon.poses(0.5, status_initialising, 4);
  beacon.poses(0.5, 0, 4);
  const auto changes = beacon.changes();
  REQUIRE(changes.size() == 2);
  CHECK(changes[0].kind == Kind::restarted);
  CHECK(changes[1].kind == Kind::initialised);
  CHECK(changes[1].lasted_s == Approx(0.5));
}

SCENARIO("fixes are gated after a second of outliers, and not after a spike") {
  Watched beacon;
  beacon.fixes(9, fix_outlier);
  beacon.fixes(1, fix_used);
  CHECK(beacon.changes().empty());
  beacon.fixes(30, fix_outlier);
  CHECK(beacon.changes() ==
        std::vector{Transition{.address = 7, .kind = Kind::gated, .value = 5.0, .count = 10}});
  beacon.fixes(5, fix_used);
  const auto ended = beacon.changes();
  REQUIRE(ended.size() == 1);
  CHECK((ended[0].kind == Kind::gated && !ended[0].begins));
  CHECK(ended[0].count == 30);
  CHECK(ended[0].lasted_s == Approx(3.0));
}

SCENARIO("a large correction at once is a relocation") {
  Watched beacon;
  beacon.fixes(1, fix_used | fix_stuck_forced, Vector3d(2.0, 1.5, 0.0));
  CHECK(beacon.changes() == std::vector{Transition{.address = 7, .kind = Kind::relocated, .value = 2.5}});
  beacon.fixes(1, fix_used | fix_stale_recovered, Vector3d(0.1, 0.0, 0.0));
  beacon.fixes(1, fix_used | fix_first, Vector3d(9.0, 0.0, 0.0));
  CHECK(beacon.changes().empty());
}

SCENARIO("changes that find no space are counted") {
  Watched beacon;
  beacon.poses(0.01, 0);
  for (int i = 0; i < 100; ++i) {
    beacon.poses(0.01, status_stale);
    beacon.poses(0.01, 0);
  }
  CHECK(beacon.pending().values().size() + beacon.pending().dropped() == 201);
  CHECK(beacon.pending().dropped() > 100);
}

}  // namespace transition_detector_test
