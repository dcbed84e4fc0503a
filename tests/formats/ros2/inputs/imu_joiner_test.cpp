#include "ros2/inputs/imu_joiner.hpp"

#include <catch2/catch.hpp>

namespace imu_joiner_test {

using namespace sonopose;
using ros2::ImuJoiner;

constexpr TimeNs ms = 1'000'000;

ros2::ReceivedImu gyroscope(TimeNs time_ns, double rate_radps) {
  ros2::ReceivedImu received;
  received.has_specific_force = false;
  received.sample.sensor_time_ns = time_ns;
  received.sample.angular_velocity_body_radps = {0, 0, rate_radps};
  return received;
}

ros2::ReceivedImu accelerometer(TimeNs time_ns, double force_mps2) {
  ros2::ReceivedImu received;
  received.has_angular_velocity = false;
  received.sample.sensor_time_ns = time_ns;
  received.sample.specific_force_body_mps2 = {0, 0, force_mps2};
  return received;
}

SCENARIO("samples of an accelerometer and of a gyroscope are joined by their times") {
  ImuJoiner joiner;
  std::vector<ImuSample> ready;
  GIVEN("both sensors alternate with the same stamps, in either order") {
    THEN("each pair is one sample at once") {
      joiner.on(gyroscope(10 * ms, 1), {0}, ready);
      CHECK(ready.empty());
      joiner.on(accelerometer(10 * ms, 9.81), {0}, ready);
      joiner.on(accelerometer(20 * ms, 9.83), {0}, ready);
      joiner.on(gyroscope(20 * ms, 2), {0}, ready);
      REQUIRE(ready.size() == 2);
      CHECK(ready[0].specific_force_body_mps2.z() == 9.81);
      CHECK(ready[1].specific_force_body_mps2.z() == 9.83);
      CHECK(ready[1].angular_velocity_body_radps.z() == 2);
      CHECK(ready[1].sensor_time_ns == 20 * ms);
      CHECK(joiner.joined() == 2);
      CHECK(joiner.dropped() == 0);
    }
  }
  GIVEN("a gyroscope between two samples of the accelerometer") {
    joiner.on(accelerometer(10 * ms, 9), {0}, ready);
    joiner.on(gyroscope(12 * ms, 1), {0}, ready);
    joiner.on(gyroscope(14 * ms, 2), {0}, ready);
    WHEN("the second one comes in time") {
      joiner.on(accelerometer(20 * ms, 10), {10 * ms}, ready);
      THEN("the specific force is interpolated") {
        REQUIRE(ready.size() == 2);
        CHECK(ready[0].specific_force_body_mps2.z() == Approx(9.2));
        CHECK(ready[1].specific_force_body_mps2.z() == Approx(9.4));
      }
    }
    WHEN("the wait ends first") {
      joiner.update({ImuJoiner::max_wait_ns - 1}, ready);
      CHECK(ready.empty());
      joiner.update({ImuJoiner::max_wait_ns}, ready);
      THEN("the samples have the latest specific force") {
        REQUIRE(ready.size() == 2);
        CHECK(ready[1].specific_force_body_mps2.z() == 9);
      }
    }
  }
  GIVEN("a gyroscope alone, and an accelerometer that has stopped") {
    joiner.on(accelerometer(0, 9), {0}, ready);
    for (int i = 1; i <= 1000; ++i) joiner.on(gyroscope(100 * ms * i, 1), {0}, ready);
    joiner.update({ImuJoiner::max_wait_ns}, ready);
    THEN("no sample is made up, and all are counted") {
      CHECK(ready.empty());
      CHECK(joiner.dropped() == 1000);
    }
  }
  GIVEN("a complete sample") {
    ros2::ReceivedImu complete;
    complete.sample.sensor_time_ns = 3 * ms;
    joiner.on(complete, {0}, ready);
    THEN("it passes") {
      CHECK(ready.size() == 1);
      CHECK(joiner.joined() == 0);
    }
  }
  GIVEN("a recording that begins again") {
    joiner.on(accelerometer(900 * ms, 9), {0}, ready);
    joiner.on(accelerometer(10 * ms, 5), {0}, ready);
    joiner.on(gyroscope(10 * ms, 1), {0}, ready);
    THEN("its samples are joined with their own") {
      REQUIRE(ready.size() == 1);
      CHECK(ready[0].specific_force_body_mps2.z() == 5);
    }
  }
}

}  // namespace imu_joiner_test
