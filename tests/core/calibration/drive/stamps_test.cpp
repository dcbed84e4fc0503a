/// Recordings with silences of the IMU, and of clocks that differ.

#include "calibration/drive/drive_fit.hpp"
#include "calibration/drive/simulated_drive.hpp"
#include "sim/random.hpp"
#include "sim/simulator.hpp"
#include "support/events.hpp"
#include "support/seeds.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <vector>

namespace stamps_test {

using namespace sonopose;
using namespace sonopose::test;
using namespace sonopose::calibration::drive;
using Catch::Contains;

using Events = std::vector<Event>;

DriveFit calibrated(const Events& events) {
  const std::vector<Events> recordings{events};
  return calibrate_drive(recordings, settings::Settings{});
}

/// A drive with true stamps and a mount of zero.
Events drive_of(const char* scenario, std::uint64_t seed, bool pair_heading, double duration_s = 30.0) {
  sim::Scenario one = sim::find_scenario(scenario);
  one.sensors.pair_heading = pair_heading;
  return sim::record(one, {.seed = seed, .duration_s = duration_s}).events;
}

TimeNs start_of(const Events& events) {
  return test::each<ImuSample>(events).front()->sensor_time_ns;
}

/// Removes the samples of the IMU in a part of the drive.
void silence(Events& events, double from_s, double duration_s) {
  const TimeNs begin_ns = start_of(events) + to_ns(from_s);
  const TimeNs end_ns = begin_ns + to_ns(duration_s);
  std::erase_if(events, [&](const Event& event) {
    const auto* imu = std::get_if<ImuSample>(&event);
    return imu != nullptr && imu->sensor_time_ns >= begin_ns && imu->sensor_time_ns < end_ns;
  });
}

/// The IMU's clock is ahead of that of the fixes, in the order in which a log folder has its rows.
Events with_imu_ahead(Events events, double ahead_s) {
  for (auto* imu : test::each<ImuSample>(events)) imu->sensor_time_ns += to_ns(ahead_s);
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return available_at_ns(a) < available_at_ns(b); });
  return events;
}

struct Coverage {
  int known = 0;
  int covered = 0;

  void add(const Value& value, double truth) {
    if (!value.is_known()) return;
    ++known;
    covered += value.low <= truth && truth <= value.high ? 1 : 0;
  }
};

/// Silences of random places and lengths, of ten seconds in all at most.
void silence_at_random(Events& events, double duration_s, std::uint64_t seed) {
  constexpr std::uint64_t stream = 77;
  sim::Random random(seed, stream);
  double left_s = 10.0;
  for (int count = 0; count < 3 && left_s > 0.3; ++count) {
    const double length_s = random.uniform_in({0.3, std::min(6.0, left_s)});
    silence(events, random.uniform_in({1.0, duration_s - 1.0 - length_s}), length_s);
    left_s -= length_s;
  }
}

SCENARIO("a silent IMU does not make the delay wrong, with a pair or a single beacon", "[accuracy]") {
  const unsigned seeds = test::seeds(1, 40);
  const double duration_s = seeds == 1 ? 40.0 : 60.0;
  for (const bool pair_heading : {true, false}) {
    GIVEN((pair_heading ? "drives with a pair" : "drives with a single beacon")) {
      Coverage delay;
      Coverage mount;
      for (const char* const scenario : {"forklift", "hall", "kart", "drone"}) {
        for (unsigned seed = 3001; seed < 3001 + seeds; ++seed) {
          Events events = drive_of(scenario, seed, pair_heading, duration_s);
          silence_at_random(events, duration_s, seed);
          const DriveFit fit = calibrated(events);
          CAPTURE(scenario, seed);
          CHECK(fit.imu_silences >= 1);
          CHECK(fit.used_s < duration_s);
          delay.add(fit[Quantity::delay], 0.0);
          mount.add(fit[Quantity::mount], 0.0);
        }
      }
      THEN("the intervals contain the truth in about 95 % of the drives") {
        // One more than 90 %: a few drives may have one outside.
        CAPTURE(delay.covered, delay.known, mount.covered, mount.known);
        CHECK(delay.covered + 1 >= 0.9 * delay.known);
        CHECK(mount.covered + 1 >= 0.9 * mount.known);
        if (pair_heading) CHECK((mount.known > 0 && delay.known > 0));
      }
    }
  }
}

SCENARIO("an IMU that repeats its last sample is cut out like a silence") {
  Events events = drive_of("forklift", 3102, true, 40.0);
  const TimeNs begin_ns = start_of(events) + to_ns(15.0);
  ImuSample last;
  for (auto* imu : test::each<ImuSample>(events)) {
    if (imu->sensor_time_ns >= begin_ns && imu->sensor_time_ns < begin_ns + to_ns(3.0)) {
      imu->angular_velocity_body_radps = last.angular_velocity_body_radps;
      imu->specific_force_body_mps2 = last.specific_force_body_mps2;
    }
    last = *imu;
  }
  const DriveFit fit = calibrated(events);
  CHECK(fit.imu_silences == 1);
  const Value& delay = fit[Quantity::delay];
  REQUIRE(delay.is_known());
  CHECK((delay.low <= 0.0 && delay.high >= 0.0));
}

SCENARIO("a drive whose IMU falls silent every few seconds is refused, with the reason") {
  Events events = drive_of("forklift", 3100, true);
  for (double from_s = 2.0; from_s < 30.0; from_s += 5.0) silence(events, from_s, 1.0);
  CHECK_THROWS_WITH(calibrated(events), Contains("0 usable fixes") && Contains("without a silence"));
}

SCENARIO("clocks of fixes and IMU that differ are found, whichever is ahead") {
  const auto [pair_heading, ahead_s] =
      GENERATE(table<bool, double>({{true, 0.08}, {true, -0.4}, {true, -2.2}, {false, -0.08}, {false, 1.3}}));
  const Events events = drive_of("drone", 3101, pair_heading, 20.0);
  GIVEN("an IMU whose clock differs") {
    CAPTURE(pair_heading, ahead_s);
    const DriveFit fit = calibrated(with_imu_ahead(events, ahead_s));
    THEN("the delay is that, and it is no setting where the fusion cannot correct it") {
      const Value& delay = fit[Quantity::delay];
      REQUIRE(delay.is_known());
      CHECK(delay.value == Approx(-ahead_s).margin(0.008));
      CHECK(static_cast<double>(fit.fixes_used) > 0.9 * static_cast<double>(fit.fixes));
      // The fusion refuses a fix that is measured 0.3 s after its receipt: 70 ms after its emission.
      const bool is_correctable = ahead_s < 0.37 && ahead_s > -0.5;
      CHECK(fit.clock_fault.empty() == is_correctable);
      if (!is_correctable) CHECK_THAT(fit.clock_fault, Contains(ahead_s > 0.0 ? "ahead" : "behind"));
    }
  }
}

SCENARIO("clocks that differ by a second are found on a calm walk with a single beacon, too") {
  const double ahead_s = GENERATE(-1.0, 1.0);
  CAPTURE(ahead_s);
  const Events events = with_imu_ahead(drive_of("walk", 3, false, 60.0), ahead_s);
  const DriveFit fit = calibrated(events);
  REQUIRE(fit[Quantity::delay].is_known());
  CHECK(fit[Quantity::delay].value == Approx(-ahead_s).margin(0.03));
  CHECK_FALSE(fit.clock_fault.empty());
}

SCENARIO("clocks that differ by more than is searched are no lack of motion") {
  for (const auto& [scenario, ahead_s] : {std::pair("forklift", 5.0), std::pair("walk", -20.0)}) {
    const DriveFit fit = calibrated(with_imu_ahead(drive_of(scenario, 3103, false, 45.0), ahead_s));
    CAPTURE(scenario, ahead_s, fit[Quantity::delay].missing);
    CHECK_FALSE(fit[Quantity::delay].is_known());
    CHECK_THAT(fit[Quantity::delay].missing, Contains("the clocks differ by more than the 3 s"));
  }
}

SCENARIO("fixes of another time than the IMU are no reason to record for longer") {
  const Events events = with_imu_ahead(drive_of("walk", 3102, true), 1000.0);
  CHECK_THROWS_WITH(calibrated(events), Contains("no IMU samples around them"));
}

}  // namespace stamps_test
