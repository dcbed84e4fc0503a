#include "fusion/pose_predictor.hpp"

#include <catch2/catch.hpp>

#include <vector>

namespace pose_predictor_test {

using namespace sonopose;
using namespace sonopose::fusion;

constexpr TimeNs ms = 1'000'000;
constexpr SteadyTime begin{5'000 * ms};
constexpr TimeNs sensor_ns = 1'700'000'000'000'000'000;

/// A pose at 3 m/s along x, from a sample measured `at_ns` after the start.
FusedPose pose_at(TimeNs at_ns) {
  FusedPose pose;
  pose.address = 7;
  pose.time_ns = sensor_ns + at_ns;
  pose.velocity_world_mps.x() = 3.0;
  return pose;
}

struct Predictions {
  PosePredictor predictor{100 * ms};
  std::vector<FusedPose> poses;

  std::optional<SteadyTime> at(TimeNs after_ns) {
    return predictor.predict(begin + after_ns, [this](const FusedPose& pose) { poses.push_back(pose); });
  }
};

SCENARIO("poses are due on a clock of their own") {
  Predictions made;
  CHECK_FALSE(made.at(0));  // no predictions are requested
  made.predictor.set_period(7, 4 * ms);
  made.predictor.on_pose(pose_at(0), begin);
  GIVEN("a pose, and 4 ms asked for") {
    THEN("the next is due 4 ms later, for that moment, and the one after 8 ms later") {
      CHECK(made.at(1 * ms) == begin + 4 * ms);
      CHECK(made.poses.empty());
      CHECK(made.at(4 * ms) == begin + 8 * ms);
      REQUIRE(made.poses.size() == 1);
      CHECK(made.poses[0].time_ns == sensor_ns + 4 * ms);
      CHECK(made.poses[0].position_world_m.x() == Approx(0.012));
      CHECK((made.poses[0].status & status_predicted) != 0U);
    }
    WHEN("another sample comes in between") {
      made.predictor.on_pose(pose_at(3 * ms), begin + 3 * ms);
      made.at(4 * ms);
      THEN("the clock keeps its beat, and the prediction is from the latest") {
        REQUIRE(made.poses.size() == 1);
        CHECK(made.poses[0].time_ns == sensor_ns + 4 * ms);
        CHECK(made.poses[0].position_world_m.x() == Approx(0.003));
      }
    }
    WHEN("nobody looked for 10 ms") {
      CHECK(made.at(14 * ms) == begin + 16 * ms);
      THEN("one pose comes, not three") {
        CHECK(made.poses.size() == 1);
      }
    }
    WHEN("the IMU falls silent") {
      for (TimeNs after_ns = 4 * ms; after_ns <= 400 * ms; after_ns += 4 * ms) made.at(after_ns);
      THEN("prediction ends with its deadline") {
        CHECK(made.poses.size() == 24);
        CHECK(made.poses.back().time_ns == sensor_ns + 96 * ms);
      }
    }
    WHEN("it is asked for once a second first, and then more often") {
      made.predictor.set_period(7, 1000 * ms);
      made.predictor.on_pose(pose_at(10 * ms), begin + 10 * ms);
      made.predictor.set_period(7, 2 * ms);
      made.predictor.on_pose(pose_at(20 * ms), begin + 20 * ms);
      THEN("the new period applies from the next sample on") {
        CHECK(made.at(22 * ms) == begin + 24 * ms);
        CHECK(made.poses.size() == 1);
      }
    }
    WHEN("it is asked for no more") {
      made.predictor.set_period(7, 0);
      THEN("nothing is due") {
        CHECK_FALSE(made.at(50 * ms));
        CHECK(made.poses.empty());
      }
    }
  }
}

}  // namespace pose_predictor_test
