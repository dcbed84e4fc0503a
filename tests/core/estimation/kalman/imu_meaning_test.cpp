/// IMU samples that are instantaneous, and those that are means over an interval.

#include "evaluation/score/score.hpp"
#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/poses_of.hpp"
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <variant>
#include <vector>

namespace imu_meaning_test {

using namespace sonopose;

/// Replaces every `count` IMU samples by one: their mean, or the last of them.
std::vector<Event> thinned(const std::vector<Event>& events, int count, bool as_mean) {
  std::vector<Event> thinned;
  Vector3d rate_sum_body_radps = Vector3d::Zero();
  Vector3d force_sum_body_mps2 = Vector3d::Zero();
  int summed = 0;
  for (const Event& event : events) {
    const auto* imu = std::get_if<ImuSample>(&event);
    if (imu == nullptr) {
      thinned.push_back(event);
      continue;
    }
    rate_sum_body_radps += imu->angular_velocity_body_radps;
    force_sum_body_mps2 += imu->specific_force_body_mps2;
    if (++summed < count) continue;
    ImuSample sample = *imu;
    if (as_mean) {
      sample.angular_velocity_body_radps = rate_sum_body_radps / count;
      sample.specific_force_body_mps2 = force_sum_body_mps2 / count;
    }
    thinned.emplace_back(sample);
    rate_sum_body_radps.setZero();
    force_sum_body_mps2.setZero();
    summed = 0;
  }
  return thinned;
}

/// RMS attitude error after 10 s with samples declared to have this meaning.
double attitude_rms_rad(std::vector<Event> events, const std::vector<TruthSample>& truth,
                        ImuMeaning declared) {
  for (Event& event : events) {
    if (auto* imu = std::get_if<ImuSample>(&event)) imu->meaning = declared;
  }
  estimation::kalman::Engine engine{settings::Settings{}};
  evaluation::TruthTrack track(truth);
  double squares = 0.0;
  int count = 0;
  for (const FusedPose& pose : test::poses_of(engine, events)) {
    const auto at = track.at(pose.time_ns);
    if (!at || seconds_between(truth.front().time_ns, pose.time_ns) < 10.0) continue;
    const double apart_rad = pose.q_body_to_world.angularDistance(at->q_body_to_world);
    squares += apart_rad * apart_rad;
    ++count;
  }
  REQUIRE(count > 300);
  return std::sqrt(squares / count);
}

SCENARIO("the attitude is more accurate with the correct meaning of the IMU samples") {
  // Together: where the noise of the fixes is the largest error of a body, the meaning hardly matters.
  GIVEN("five hand-held bodies whose IMU of 1 kHz is reduced to 25 Hz") {
    const bool is_mean = GENERATE(true, false);
    CAPTURE(is_mean);
    const ImuMeaning right = is_mean ? ImuMeaning::mean_since_last : ImuMeaning::instant;
    const ImuMeaning wrong = is_mean ? ImuMeaning::instant : ImuMeaning::mean_since_last;
    sim::Scenario hand_held = sim::find_scenario("hand_held");
    hand_held.sensors.imu_rate_hz = 1000.0;
    double right_rad2 = 0.0;
    double wrong_rad2 = 0.0;
    for (std::uint64_t seed = 51; seed < 56; ++seed) {
      const sim::Recording run = sim::record(hand_held, {.seed = seed, .duration_s = 30.0});
      const auto events = thinned(run.events, 40, is_mean);
      right_rad2 += std::pow(attitude_rms_rad(events, run.truth, right), 2);
      wrong_rad2 += std::pow(attitude_rms_rad(events, run.truth, wrong), 2);
    }
    THEN("the wrong meaning at least doubles the error") {
      CHECK(4.0 * right_rad2 < wrong_rad2);
    }
  }
}

}  // namespace imu_meaning_test
