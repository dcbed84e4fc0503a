#include "observation/beacon_view.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace sonopose;
using namespace sonopose::observation;

namespace {

constexpr TimeNs begin_ns = 1'700'000'000'000'000'000;
constexpr TimeNs ms = 1'000'000;
constexpr TimeNs second = 1000 * ms;

/// The pose of `time_ns`, at `x_m`, published by the bridge a millisecond after.
FusedPose pose_at(TimeNs time_ns, double x_m = 0.0, std::uint32_t status = 0) {
  FusedPose pose;
  pose.address = 7;
  pose.time_ns = time_ns;
  pose.imu_bridge_time_ns = time_ns + ms;
  pose.position_world_m.x() = x_m;
  pose.status = status;
  return pose;
}

TruthSample truth_at(TimeNs time_ns, double x_m) {
  TruthSample truth;
  truth.address = 7;
  truth.time_ns = time_ns;
  truth.position_world_m.x() = x_m;
  return truth;
}

}  // namespace

SCENARIO("a watch counts what comes in each second and in all") {
  GIVEN("100 poses a second for two seconds, which take 2 ms in the first and 4 ms in the second") {
    BeaconObserver watch;
    const auto receive = [&watch](int from, int until, TimeNs latency_ns) {
      for (int i = from; i < until; ++i) {
        const FusedPose pose = pose_at(begin_ns + i * 10 * ms, i);
        watch.on(pose, pose.imu_bridge_time_ns + latency_ns);
      }
    };
    receive(0, 100, 2 * ms);
    const BeaconView first = watch.look(7, begin_ns + second);
    receive(100, 200, 4 * ms);
    const BeaconView other = watch.look(7, begin_ns + 2 * second);
    THEN("each look shows its second") {
      CHECK(first.address == 7);
      CHECK(first.poses == 100);
      CHECK(first.pose_rate_hz == Approx(100.0).epsilon(0.02));
      CHECK(first.latency.p50_s == Approx(0.002));
      CHECK(other.poses == 100);
      CHECK(other.window_s == Approx(1.0));
      CHECK(other.pose_rate_hz == Approx(100.0).epsilon(0.02));
      CHECK(other.latency.p50_s == Approx(0.004));
      CHECK(other.pose.position_world_m.x() == 199.0);
    }
    THEN("the summary shows both") {
      const BeaconView all = watch.summary(7, begin_ns + 2 * second);
      CHECK(all.poses == 200);
      CHECK(all.window_s == Approx(2.0).epsilon(0.01));
      CHECK(all.pose_rate_hz == Approx(100.0).epsilon(0.02));
      CHECK(all.latency.p99_s == Approx(0.004));
    }
    THEN("a second without a pose has none, keeps the latest pose and knows no latency") {
      const BeaconView silent = watch.look(7, begin_ns + 3 * second);
      CHECK(silent.poses == 0);
      CHECK(silent.pose_rate_hz == 0.0);
      CHECK(std::isnan(silent.latency.p50_s));
      CHECK(silent.pose.position_world_m.x() == 199.0);
    }
  }
  GIVEN("a beacon of which only statuses came") {
    BeaconObserver watch;
    BeaconStatus bridge;
    bridge.crc_errors = 3;
    watch.on(bridge);
    FusionStatus fusion;
    fusion.events_lost = 4;
    watch.on(fusion);
    watch.on_deadline_missed(5);
    THEN("they are shown, without a rate") {
      const BeaconView view = watch.look(7, begin_ns);
      CHECK(view.bridge->crc_errors == 3);
      CHECK(view.fusion->events_lost == 4);
      CHECK(view.deadlines_missed == 5);
      CHECK(view.pose_rate_hz == 0.0);
    }
  }
}

SCENARIO("poses between samples are counted apart and take no part in the latency") {
  BeaconObserver watch;
  watch.on(pose_at(begin_ns), begin_ns + 2 * ms);
  watch.on(pose_at(begin_ns + 5 * ms, 0.5, status_predicted), begin_ns + 900 * ms);
  const BeaconView view = watch.look(7, begin_ns + second);
  CHECK(view.poses == 1);
  CHECK(view.predicted == 1);
  CHECK(view.latency.p99_s == Approx(0.001));
  CHECK(view.pose.position_world_m.x() == 0.5);
}

SCENARIO("a watch knows whether anybody writes the poses") {
  BeaconObserver watch;
  watch.on(pose_at(begin_ns), begin_ns);
  CHECK_FALSE(watch.look(7, begin_ns).lost);
  watch.on_pose_lost();
  CHECK(watch.look(7, begin_ns).lost);
  watch.on(pose_at(begin_ns + second), begin_ns + second);
  const BeaconView view = watch.look(7, begin_ns + second);
  CHECK_FALSE(view.lost);
  CHECK(view.losses == 1);
}

SCENARIO("of several fusions the strongest that serves is shown first") {
  BeaconObserver watch;
  const auto tell = [&watch](std::uint64_t id, FusionRole role, std::int32_t strength) {
    FusionStatus status;
    status.fusion_id = id;
    status.role = role;
    status.strength = strength;
    watch.on(status);
  };
  tell(1, FusionRole::serving, 100);
  tell(2, FusionRole::serving, 200);
  tell(3, FusionRole::warming, 300);
  const BeaconView view = watch.look(7, begin_ns);
  REQUIRE(view.fusions.size() == 3);
  CHECK(view.fusion->strength == 200);
  CHECK(view.fusions.back().strength == 300);
  watch.on_fusion_gone(2);
  CHECK(watch.look(7, begin_ns).fusion->strength == 100);
}

SCENARIO("poses are compared with the truth of their own moment") {
  BeaconObserver watch;
  const auto error = [&watch] { return watch.look(7, begin_ns + second); };
  GIVEN("two poses that are 3 cm and 4 cm off, one before its truth and one after") {
    watch.on(pose_at(begin_ns, 1.03), begin_ns);
    watch.on(truth_at(begin_ns, 1.0));
    watch.on(truth_at(begin_ns + 10 * ms, 2.0));
    watch.on(pose_at(begin_ns + 10 * ms, 1.96), begin_ns);
    THEN("the greatest error is 4 cm and the RMS that of both, in this second and in all") {
      const BeaconView view = error();
      CHECK(view.position_error_max_m == Approx(0.04));
      CHECK(view.position_error_rms_m == Approx(std::sqrt((0.03 * 0.03 + 0.04 * 0.04) / 2)));
      CHECK_FALSE(error().position_error_max_m);
      CHECK(watch.summary(7, begin_ns).position_error_max_m == Approx(0.04));
    }
  }
  GIVEN("a pose without the truth of its moment") {
    watch.on(truth_at(begin_ns + 10 * ms, 2.0));
    watch.on(pose_at(begin_ns, 1.0), begin_ns);
    THEN("there is no error") {
      CHECK_FALSE(error().position_error_rms_m);
    }
  }
  GIVEN("a pose from before the engine knew where it is") {
    watch.on(truth_at(begin_ns, 2.0));
    watch.on(pose_at(begin_ns, 0.0, status_initialising), begin_ns);
    THEN("it is not compared") {
      CHECK_FALSE(error().position_error_rms_m);
    }
  }
  GIVEN("a truth that is not known, as motion capture has gaps") {
    watch.on(truth_at(begin_ns, std::nan("")));
    watch.on(pose_at(begin_ns, 1.0), begin_ns);
    THEN("there is no error") {
      CHECK_FALSE(error().position_error_rms_m);
    }
  }
}
