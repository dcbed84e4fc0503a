/// The Kalman engine with wrong first fixes.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/poses_of.hpp"
#include "support/seeds.hpp"
#include <sonopose/estimation/kalman/engine.hpp>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <random>
#include <vector>

namespace wrong_start_test {

using namespace sonopose;
using namespace sonopose::estimation;

/// Draws a log that starts at a random time. Up to three of its first fixes and a random share of the others
/// are on a second track or anywhere.
sim::Recording draw_log(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto draw = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto draw_below = [&random](int count) {
    return std::uniform_int_distribution<int>(0, count - 1)(random);
  };
  constexpr std::array scenarios{"moving_start", "forklift", "kart", "drone", "walk", "circle"};
  const char* const scenario = scenarios.at(static_cast<std::size_t>(draw_below(scenarios.size())));
  const double begin_s = draw(0, 25);
  sim::Recording log = sim::record(sim::find_scenario(scenario), {.seed = seed, .duration_s = begin_s + 40});
  const TimeNs begin_ns = log.truth.front().time_ns + to_ns(begin_s);
  std::erase_if(log.events, [&](const Event& event) { return available_at_ns(event) < begin_ns; });
  std::erase_if(log.truth, [&](const TruthSample& truth) { return truth.time_ns < begin_ns; });

  const Vector3d direction(draw(-1, 1), draw(-1, 1), draw(-0.3, 0.3));
  const Vector3d second_track_m = direction.normalized() * draw(0.4, 5);
  const bool is_scattered = draw_below(2) == 0;
  const double wrong_share = draw(0, 0.3);
  int first_wrong = draw_below(4);
  for (Event& event : log.events) {
    auto* const fix = std::get_if<UltrasonicFix>(&event);
    if (fix == nullptr || (first_wrong-- <= 0 && draw(0, 1) > wrong_share)) continue;
    const Vector3d anywhere_m(draw(-4, 4), draw(-4, 4), draw(-1, 1));
    fix->position_world_m += is_scattered ? anywhere_m : second_track_m;
  }
  return log;
}

struct Error {
  double since_begin_s = 0;
  double position_m = 0;
};

std::vector<Error> errors_of(const std::vector<FusedPose>& poses, const std::vector<TruthSample>& truth) {
  std::vector<Error> errors;
  auto next = truth.begin();
  for (const FusedPose& pose : poses) {
    while (next != truth.end() && next->time_ns < pose.time_ns) ++next;
    if (next == truth.end() || next->time_ns != pose.time_ns) continue;
    errors.push_back({seconds_between(truth.front().time_ns, pose.time_ns),
                      (pose.position_world_m - next->position_world_m).norm()});
  }
  return errors;
}

/// RMS position error from 6 s after the start.
double rms_m(const std::vector<Error>& errors) {
  double squares = 0.0;
  int count = 0;
  for (const Error& error : errors) {
    if (error.since_begin_s < 6.0) continue;
    squares += error.position_m * error.position_m;
    ++count;
  }
  REQUIRE(count > 100);
  return std::sqrt(squares / count);
}

/// Longest time with an error above 1 m.
double longest_lost_s(const std::vector<Error>& errors) {
  double longest_s = 0.0;
  double last_right_s = 0.0;
  for (const Error& error : errors) {
    if (error.position_m < 1.0) last_right_s = error.since_begin_s;
    longest_s = std::max(longest_s, error.since_begin_s - last_right_s);
  }
  return longest_s;
}

void remove_headings(sim::Recording& log) {
  std::erase_if(log.events, [](const Event& event) { return std::holds_alternative<PairHeading>(event); });
}

SCENARIO("the Kalman engine overcomes a wrong start", "[accuracy]") {
  GIVEN("logs that begin in motion and with wrong fixes, with a pair heading or without") {
    const bool has_heading = GENERATE(true, false);
    std::vector<double> errors_m;
    constexpr std::uint64_t first_seed = 6001;  // no parameter was tuned on these seeds
    const std::size_t runs = test::seeds(30, 120);
    for (std::uint64_t seed = first_seed; seed < first_seed + runs; ++seed) {
      sim::Recording log = draw_log(seed);
      if (!has_heading) remove_headings(log);
      kalman::Engine engine{settings::Settings{}};
      errors_m.push_back(rms_m(errors_of(test::poses_of(engine, log.events), log.truth)));
    }
    std::sort(errors_m.begin(), errors_m.end());
    const auto lost =
        std::count_if(errors_m.begin(), errors_m.end(), [](double error_m) { return error_m > 0.2; });
    fmt::print("wrong start, {} heading: median {:.1f} cm, 90 % below {:.1f} cm, {} of {} above 20 cm\n",
               has_heading ? "with" : "without", 100 * errors_m.at(runs / 2),
               100 * errors_m.at(runs * 9 / 10), lost, runs);
    THEN("after 6 s nearly all are as good as others") {
      CHECK(errors_m.at(runs / 2) < 0.03);
      CHECK(errors_m.at(runs * 9 / 10) < 0.06);
      CHECK(30 * lost <= static_cast<int>(runs));
    }
  }
}

SCENARIO("the Kalman engine searches the yaw again where all of its starts are wrong") {
  GIVEN("a kart in a curve without a heading, half of whose first fixes are wrong") {
    // The wrong fixes bend all starts, which leave the track at 10 to 20 m/s.
    sim::Recording log = draw_log(5990785);
    remove_headings(log);
    kalman::Engine engine{settings::Settings{}};
    const auto errors = errors_of(test::poses_of(engine, log.events), log.truth);
    THEN("the pose is lost for less than 3 s") {
      CHECK(longest_lost_s(errors) < 3.0);
    }
  }
}

SCENARIO("the Kalman engine stays where it is when the fixes of a resting body are wrong for a while") {
  GIVEN("a body at rest without a heading, whose fixes are anywhere from 8 to 10 s") {
    const std::uint64_t seed = GENERATE(as<std::uint64_t>(), 31, 32, 33, 34, 35);
    sim::Recording log = sim::record(sim::find_scenario("rest"), {.seed = seed, .duration_s = 15.0});
    remove_headings(log);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> anywhere_m(-4.0, 4.0);
    const TimeNs begin_ns = log.truth.front().time_ns;
    for (Event& event : log.events) {
      auto* const fix = std::get_if<UltrasonicFix>(&event);
      if (fix == nullptr) continue;
      const double since_begin_s = seconds_between(begin_ns, fix->emission_time_ns);
      if (since_begin_s < 8.0 || since_begin_s > 10.0) continue;
      fix->position_world_m += Vector3d(anywhere_m(random), anywhere_m(random), 0.0);
    }
    kalman::Engine engine{settings::Settings{}};
    const auto errors = errors_of(test::poses_of(engine, log.events), log.truth);
    THEN("the pose follows none of them, although no start of the search explains them") {
      REQUIRE(errors.size() > 1000);
      CHECK(std::count_if(errors.begin(), errors.end(), [](const Error& error) {
              return error.since_begin_s > 2.0 && error.position_m > 0.2;
            }) == 0);
    }
  }
}

SCENARIO("a start that is corrected counts as a jump") {
  GIVEN("a body at rest whose first fix is 3 m off") {
    constexpr TimeNs epoch_ns = 1'700'000'000'000'000'000;
    kalman::Engine engine{settings::Settings{}};
    TimeNs corrected_ns = 0;
    double longest_s = 0.0;
    for (int k = 0; k < 300; ++k) {
      const TimeNs now_ns = epoch_ns + to_ns(0.01 * k);
      ImuSample imu;
      imu.sensor_time_ns = imu.bridge_time_ns = now_ns;
      imu.specific_force_body_mps2 = {0.0, 0.0, standard_gravity_mps2};
      const auto pose = engine.predict(imu);
      REQUIRE(pose);
      if ((pose->status & status_converging) != 0) {
        REQUIRE(corrected_ns != 0);
        longest_s = seconds_between(corrected_ns, now_ns);
      }
      if (k % 8 != 4) continue;
      UltrasonicFix fix;
      fix.emission_time_ns = fix.received_time_ns = now_ns;
      fix.measured_delay_s = 0.0;
      fix.position_world_m = {k == 4 ? 3.0 : 0.01 * std::sin(k), 0.0, 0.0};
      if ((engine.correct(fix).flags & fix_stuck_forced) != 0 && corrected_ns == 0) corrected_ns = now_ns;
    }
    THEN("the pose converges for half a second") {
      CHECK(corrected_ns != 0);
      CHECK(longest_s == Approx(0.5).margin(0.011));
    }
  }
}

}  // namespace wrong_start_test
