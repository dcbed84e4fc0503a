#include "ros2/relay/imu_pairing.hpp"

#include <catch2/catch.hpp>

namespace imu_pairing_test {

using namespace sonopose;
using namespace sonopose::ros2;
using namespace sonopose::ros2::relay;

ImuSample sample_number(std::uint64_t sequence) {
  ImuSample sample;
  sample.sequence = sequence;
  return sample;
}

FusedPose pose_number(std::uint64_t sequence) {
  FusedPose pose;
  pose.sequence = sequence;
  return pose;
}

SCENARIO("a pose and its IMU sample form a pair in either order") {
  GIVEN("samples 10 and 11") {
    ImuPairing pairing;
    const SteadyTime now{};
    CHECK_FALSE(pairing.on(sample_number(10)));
    CHECK_FALSE(pairing.on(sample_number(11)));
    WHEN("their poses arrive after them") {
      THEN("each has its sample") {
        CHECK(pairing.on(pose_number(10), now)->sequence == 10);
        CHECK(pairing.on(pose_number(11), now)->sequence == 11);
      }
    }
    WHEN("the poses of the next samples arrive first") {
      CHECK_FALSE(pairing.on(pose_number(12), now));
      CHECK_FALSE(pairing.on(pose_number(14), now));
      THEN("they wait for their samples, and nothing is lost") {
        CHECK(pairing.on(sample_number(12))->sequence == 12);
        CHECK(pairing.on(sample_number(14))->sequence == 14);
        CHECK(pairing.given_up() == 0);
      }
      THEN("a pose is given up and counted when a later sample arrives") {
        CHECK(pairing.on(sample_number(14))->sequence == 14);
        CHECK(pairing.given_up() == 1);
      }
      THEN("poses are given up and counted after the timeout") {
        pairing.drop_overdue(now + ImuPairing::timeout_ns);
        CHECK(pairing.given_up() == 0);
        pairing.drop_overdue(now + ImuPairing::timeout_ns + 1);
        CHECK(pairing.given_up() == 2);
        CHECK_FALSE(pairing.on(sample_number(12)));
      }
      THEN("the poses of a restarted bridge do not wait behind them") {
        CHECK_FALSE(pairing.on(pose_number(1), now));
        CHECK(pairing.on(sample_number(1))->sequence == 1);
      }
    }
    WHEN("more poses arrive early than are kept") {
      for (std::uint64_t i = 0; i <= ImuPairing::max_kept; ++i) pairing.on(pose_number(12 + i), now);
      THEN("the oldest one is given up") {
        CHECK(pairing.given_up() == 1);
        CHECK(pairing.on(sample_number(13))->sequence == 13);
      }
    }
  }
  GIVEN("poses of samples from before the start") {
    ImuPairing pairing;
    pairing.on(pose_number(8), SteadyTime{});
    pairing.on(pose_number(9), SteadyTime{});
    WHEN("the first sample arrives") {
      pairing.on(sample_number(10));
      THEN("they are not counted as lost") {
        CHECK(pairing.given_up() == 0);
      }
    }
  }
}

}  // namespace imu_pairing_test
