#include "observation/beacon_observer.hpp"

#include "observation/stream_state.hpp"

#include <catch2/catch.hpp>

#include <cmath>

namespace beacon_observer_test {

using namespace sonopose;
using namespace sonopose::observation;

constexpr TimeNs begin_ns = 1'700'000'000'000'000'000;
constexpr TimeNs ms = 1'000'000;
constexpr TimeNs second = 1000 * ms;

/// Pose of `time_ns` at `x_m`, whose sample the bridge published one millisecond later.
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

SCENARIO("an IMU that is not mounted upright is noticed after five seconds, a manoeuvre is not") {
  BeaconObserver observer;
  const auto view_after = [&observer](double from_s, double until_s, double roll_deg) {
    for (double time_s = from_s; time_s <= until_s; time_s += 0.01) {
      FusedPose pose = pose_at(begin_ns + to_ns(time_s));
      pose.q_body_to_world = Eigen::AngleAxisd(roll_deg * M_PI / 180.0, Vector3d::UnitX());
      observer.on(pose, pose.time_ns);
    }
    return observer.take_window(7, begin_ns + to_ns(until_s));
  };
  CHECK_FALSE(view_after(0, 10, 40.0).wrong_tilt_rad);  // a steep ramp
  CHECK_FALSE(view_after(10, 14, 180.0).wrong_tilt_rad);
  CHECK_FALSE(view_after(14, 15, 0.0).wrong_tilt_rad);
  CHECK_FALSE(view_after(15, 19, 180.0).wrong_tilt_rad);
  CHECK(view_after(19, 21, 180.0).wrong_tilt_rad.value_or(0) == Approx(M_PI));
  CHECK(tilt_words(observer.summary(7, begin_ns + to_ns(21))) == "IMU upside down");
  CHECK(view_after(21, 22, -90.0).wrong_tilt_rad.value_or(0) == Approx(M_PI / 2));
  CHECK(tilt_words(observer.summary(7, begin_ns + to_ns(22))) == "IMU on its side");
  CHECK_FALSE(view_after(22, 23, 0.0).wrong_tilt_rad);
}

SCENARIO("an observer counts the poses of each second and of the whole run") {
  GIVEN("100 poses a second for two seconds, which take 2 ms in the first and 4 ms in the second") {
    BeaconObserver observer;
    const auto receive = [&observer](int from, int until, TimeNs latency_ns) {
      for (int i = from; i < until; ++i) {
        const FusedPose pose = pose_at(begin_ns + TimeNs{10} * i * ms, i);
        observer.on(pose, pose.imu_bridge_time_ns + latency_ns);
      }
    };
    receive(0, 100, 2 * ms);
    const BeaconView first = observer.take_window(7, begin_ns + second);
    receive(100, 200, 4 * ms);
    const BeaconView other = observer.take_window(7, begin_ns + 2 * second);
    THEN("each window covers its second") {
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
    THEN("the summary covers both") {
      const BeaconView all = observer.summary(7, begin_ns + 2 * second);
      CHECK(all.poses == 200);
      CHECK(all.window_s == Approx(2.0).epsilon(0.01));
      CHECK(all.pose_rate_hz == Approx(100.0).epsilon(0.02));
      CHECK(all.latency.p99_s == Approx(0.004));
    }
    THEN("a second without poses keeps the latest pose and has no latency") {
      const BeaconView silent = observer.take_window(7, begin_ns + 3 * second);
      CHECK(silent.poses == 0);
      CHECK(silent.pose_rate_hz == 0.0);
      CHECK(std::isnan(silent.latency.p50_s));
      CHECK(silent.pose.position_world_m.x() == 199.0);
    }
  }
  GIVEN("a beacon with statuses only") {
    BeaconObserver observer;
    BeaconStatus bridge;
    bridge.crc_errors = 3;
    observer.on(bridge);
    FusionStatus fusion;
    fusion.events_lost = 4;
    observer.on(fusion);
    observer.on_deadline_missed(5);
    THEN("the view contains them, and no rate") {
      const BeaconView view = observer.take_window(7, begin_ns);
      CHECK(view.bridge->crc_errors == 3);
      CHECK(view.fusion->events_lost == 4);
      CHECK(view.deadlines_missed == 5);
      CHECK(view.pose_rate_hz == 0.0);
    }
  }
}

SCENARIO("the estimate shown is that of the fusion that serves the beacon") {
  BeaconObserver observer;
  const auto status_of = [](std::uint64_t fusion_id, std::int32_t strength) {
    FusionStatus status;
    status.fusion_id = fusion_id;
    status.role = FusionRole::serving;
    status.strength = strength;
    return status;
  };
  const auto estimate_of = [](std::uint64_t fusion_id) {
    Estimate estimate;
    estimate.fusion_id = fusion_id;
    return estimate;
  };
  observer.on(estimate_of(1));
  observer.on(estimate_of(2));
  CHECK_FALSE(observer.take_window(7, begin_ns).estimate);  // no fusion is known yet
  observer.on(status_of(1, 100));
  observer.on(status_of(2, 200));
  CHECK(observer.take_window(7, begin_ns).estimate->fusion_id == 2);
  observer.on_fusion_gone(2);
  CHECK(observer.take_window(7, begin_ns).estimate->fusion_id == 1);
  observer.on(status_of(3, 300));
  CHECK_FALSE(observer.take_window(7, begin_ns).estimate);  // the new fusion has sent none yet
}

SCENARIO("poses between samples are counted separately and excluded from the latency") {
  BeaconObserver observer;
  observer.on(pose_at(begin_ns), begin_ns + 2 * ms);
  observer.on(pose_at(begin_ns + 5 * ms, 0.5, status_predicted), begin_ns + 900 * ms);
  const BeaconView view = observer.take_window(7, begin_ns + second);
  CHECK(view.poses == 1);
  CHECK(view.predicted == 1);
  CHECK(view.latency.p99_s == Approx(0.001));
  CHECK(view.pose.position_world_m.x() == 0.5);
}

SCENARIO("an observer detects the loss of the pose writer") {
  BeaconObserver observer;
  observer.on(pose_at(begin_ns), begin_ns);
  CHECK_FALSE(observer.take_window(7, begin_ns).lost);
  observer.on_pose_lost();
  CHECK(observer.take_window(7, begin_ns).lost);
  observer.on(pose_at(begin_ns + second), begin_ns + second);
  const BeaconView view = observer.take_window(7, begin_ns + second);
  CHECK_FALSE(view.lost);
  CHECK(view.losses == 1);
}

SCENARIO("of several fusions, the strongest one that serves comes first") {
  BeaconObserver observer;
  const auto receive_status = [&observer](std::uint64_t id, FusionRole role, std::int32_t strength) {
    FusionStatus status;
    status.fusion_id = id;
    status.role = role;
    status.strength = strength;
    observer.on(status);
  };
  receive_status(1, FusionRole::serving, 100);
  receive_status(2, FusionRole::serving, 200);
  receive_status(3, FusionRole::warming, 300);
  const BeaconView view = observer.take_window(7, begin_ns);
  REQUIRE(view.fusions.size() == 3);
  CHECK(view.fusion->strength == 200);
  CHECK(view.fusions.back().strength == 300);
  observer.on_fusion_gone(2);
  CHECK(observer.take_window(7, begin_ns).fusion->strength == 100);
}

SCENARIO("poses are compared with the ground truth of the same instant") {
  BeaconObserver observer;
  const auto error = [&observer] { return observer.take_window(7, begin_ns + second); };
  GIVEN("poses with errors of 3 cm and 4 cm, one received before its truth and one after") {
    observer.on(pose_at(begin_ns, 1.03), begin_ns);
    observer.on(truth_at(begin_ns, 1.0));
    observer.on(truth_at(begin_ns + 10 * ms, 2.0));
    observer.on(pose_at(begin_ns + 10 * ms, 1.96), begin_ns);
    THEN("the maximum error is 4 cm and the RMS includes both, in this second and in the summary") {
      const BeaconView view = error();
      CHECK(view.position_error_max_m == Approx(0.04));
      CHECK(view.position_error_rms_m == Approx(std::sqrt((0.03 * 0.03 + 0.04 * 0.04) / 2)));
      CHECK_FALSE(error().position_error_max_m);
      CHECK(observer.summary(7, begin_ns).position_error_max_m == Approx(0.04));
    }
  }
  GIVEN("a clock that steps back after many poses without a truth") {
    for (int i = 0; i < 5'000; ++i) observer.on(pose_at(begin_ns + (1'000 + i) * ms, 1.0), begin_ns);
    observer.on(pose_at(begin_ns, 1.03), begin_ns);
    observer.on(truth_at(begin_ns, 1.0));
    THEN("the next pose is compared again") {
      CHECK(error().position_error_max_m == Approx(0.03));
    }
  }
  GIVEN("a pose without a truth of the same instant") {
    observer.on(truth_at(begin_ns + 10 * ms, 2.0));
    observer.on(pose_at(begin_ns, 1.0), begin_ns);
    THEN("there is no error") {
      CHECK_FALSE(error().position_error_rms_m);
    }
  }
  GIVEN("a pose of an engine that is still initialising") {
    observer.on(truth_at(begin_ns, 2.0));
    observer.on(pose_at(begin_ns, 0.0, status_initialising), begin_ns);
    THEN("it is not compared") {
      CHECK_FALSE(error().position_error_rms_m);
    }
  }
  GIVEN("a truth that is NaN, as in a gap of motion capture") {
    observer.on(truth_at(begin_ns, std::nan("")));
    observer.on(pose_at(begin_ns, 1.0), begin_ns);
    THEN("there is no error") {
      CHECK_FALSE(error().position_error_rms_m);
    }
  }
}

}  // namespace beacon_observer_test
