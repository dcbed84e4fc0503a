#include "motion/turn_gain.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace turn_gain_test {

using namespace sonopose;
using namespace sonopose::motion;

/// Ten seconds of a body that turns to and fro by 2 rad; gyroscope at 100 Hz, headings at 10 Hz.
Window turning(double gyro_gain) {
  Window window;
  window.mount_rad = 2.5;  // does not matter
  for (int i = 0; i < 1000; ++i) {
    const double time_s = 0.01 * i;
    const TimeNs time_ns = 10'000'000LL * i;
    window.imu.push_back(
        {time_ns, {0, 0, gyro_gain * 2.0 * std::cos(time_s)}, {1, 0, standard_gravity_mps2}});
    if (i % 10 == 0) {
      window.headings.push_back({time_ns, geometry::wrap_angle(2.5 + 2.0 * std::sin(time_s))});
    }
  }
  return window;
}

SCENARIO("the turns of a gyroscope are compared with those of the headings") {
  for (const auto& [gain, fault] : {std::pair{1.0, TurnFault::none},
                                    {-1.0, TurnFault::wrong_sign},
                                    {0.0, TurnFault::dead},
                                    {1.0 / geometry::radians_per_degree, TurnFault::degrees},
                                    {0.5, TurnFault::scale}}) {
    GIVEN("a gyroscope of gain " << gain) {
      const TurnGain turn = turn_gain_of(turning(gain));
      CHECK(turn.gain == Approx(gain).margin(0.02));
      CHECK(turn_fault_of(turn) == fault);
    }
  }
}

SCENARIO("an accelerometer that is upside down turns the sign, an IMU on its side does not") {
  Window window = turning(1.0);
  for (Reading& reading : window.imu) reading.force_body_mps2 *= -1;
  CHECK(turn_fault_of(turn_gain_of(window)) == TurnFault::wrong_sign);
  window = turning(1.0);
  for (Reading& reading : window.imu) {
    reading.force_body_mps2 = {standard_gravity_mps2, 0, 0};
    reading.rate_body_radps = {reading.rate_body_radps.z(), 0, 0};
  }
  CHECK(turn_gain_of(window).gain == Approx(1.0).margin(0.02));
}

SCENARIO("headings that jump are no turns") {
  GIVEN("a body at rest, every seventh heading of which is off by up to 180°") {
    Window window = turning(0.0);
    for (std::size_t i = 0; i < window.headings.size(); ++i) {
      window.headings[i].heading_world_rad =
          i % 7 == 0 ? geometry::wrap_angle(0.9 * static_cast<double>(i)) : 0;
    }
    THEN("its gyroscope is not dead") {
      CHECK(turn_fault_of(turn_gain_of(window)) == TurnFault::none);
    }
  }
}

SCENARIO("a gyroscope whose clock is another is not dead") {
  GIVEN("turns of a second, five seconds apart, with headings that are two seconds late") {
    Window window;
    for (int i = 0; i < 3000; ++i) {
      const TimeNs time_ns = 10'000'000LL * i;
      const double rate_radps = i % 500 < 100 ? 1.5 : 0;
      window.imu.push_back({time_ns, {0, 0, rate_radps}, {0, 0, standard_gravity_mps2}});
      const int late = std::max(0, i - 200);
      const int turns_before = late / 500;
      const double heading_rad = 1.5 * (turns_before + std::min(1.0, 0.01 * (late % 500)));
      if (i % 10 == 0) window.headings.push_back({time_ns, geometry::wrap_angle(heading_rad)});
    }
    THEN("no axis is blamed") {
      const TurnGain turn = turn_gain_of(window);
      CHECK(turn.turns >= 5);
      CHECK(std::abs(turn.gain) < 0.1);
      CHECK(turn_fault_of(turn) == TurnFault::none);
    }
    WHEN("the gyroscope senses none of them") {
      for (Reading& reading : window.imu) reading.rate_body_radps.setZero();
      THEN("it is dead") {
        CHECK(turn_fault_of(turn_gain_of(window)) == TurnFault::dead);
      }
    }
  }
}

SCENARIO("without gravity no sign is judged, since the mean force is not upwards") {
  Window window = turning(1.0);
  for (Reading& reading : window.imu) reading.force_body_mps2 = {0.3, 0, -0.1};
  CHECK(turn_fault_of(turn_gain_of(window)) == TurnFault::none);
}

SCENARIO("without samples nothing is judged") {
  CHECK(turn_fault_of(turn_gain_of({})) == TurnFault::none);
}

}  // namespace turn_gain_test
