/// The Kalman engine's verdicts on the measurements of a recording.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/events.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/estimation/offline/judgement.hpp>
#include <sonopose/estimation/offline/smoother.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/samples/pose.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <vector>

namespace judgement_test {

using namespace sonopose;
using estimation::offline::JudgedFix;
using estimation::offline::Segment;

template <class Scenario>
std::vector<Event> events_of(const Scenario& scenario, std::uint64_t seed, double duration_s) {
  return sim::record(scenario, {.seed = seed, .duration_s = duration_s}).events;
}

double since_start_s(const std::vector<Event>& events, TimeNs time_ns) {
  return seconds_between(available_at_ns(events.front()), time_ns);
}

SCENARIO("measurements are judged as the engine judged them") {
  GIVEN("a walk with wrong tracks of up to two seconds") {
    const sim::Scenario& scenario = sim::find_scenario("outlier_bursts");
    const std::vector<Event> events = events_of(scenario, 31, 60.0);
    const std::vector<Segment> segments = estimation::offline::judged({}, events);
    REQUIRE(segments.size() == 1);
    const Segment& segment = segments.front();

    THEN("the fixes on wrong tracks are rejected, and nearly all others are used") {
      int wrong_used = 0;
      int right = 0;
      int right_used = 0;
      for (const JudgedFix& fix : segment.fixes) {
        const double time_s = since_start_s(events, fix.measured.time_ns);
        const auto& bursts = scenario.disturbances.outlier_bursts;
        const bool wrong = std::any_of(bursts.begin(), bursts.end(), [&](const sim::OutlierBurst& burst) {
          return time_s >= burst.begin_s && time_s < burst.begin_s + burst.duration_s;
        });
        if (wrong && fix.used) ++wrong_used;
        right += wrong ? 0 : 1;
        right_used += !wrong && fix.used ? 1 : 0;
      }
      CHECK(wrong_used == 0);
      CHECK(right_used > 0.98 * right);
    }
    THEN("each list is in the order of measurement, and the IMU begins at most a second before the fixes") {
      const auto by_time = [](const auto& a, const auto& b) {
        return a.measured.time_ns < b.measured.time_ns;
      };
      CHECK(std::is_sorted(segment.fixes.begin(), segment.fixes.end(), by_time));
      CHECK(std::is_sorted(segment.headings.begin(), segment.headings.end(), by_time));
      CHECK(segment.imu.front().time_ns <= segment.fixes.front().measured.time_ns);
      CHECK(seconds_between(segment.imu.front().time_ns, segment.fixes.front().measured.time_ns) <= 1.0);
    }
    THEN("a fix counts with the noise of the beacons, 1.5 to 2.5 cm, once that is learned") {
      for (const JudgedFix& fix : segment.fixes) {
        if (since_start_s(events, fix.measured.time_ns) < 10.0) continue;
        const double std_m = std::sqrt(fix.covariance_world_m2(0, 0));
        CHECK(std_m > 0.01);
        if (!fix.used) CHECK(std_m < 0.04);
      }
    }
    THEN("the verdicts are those of the engine's reports") {
      std::map<std::uint64_t, bool> reported;
      estimation::kalman::Engine engine{settings::Settings{}};
      for (const Event& event : events) {
        const auto result = estimation::process(engine, event);
        if (const auto* report = std::get_if<FixReport>(&result)) {
          reported[report->sequence] = (report->flags & fix_used) != 0;
        }
      }
      REQUIRE(reported.size() == segment.fixes.size());
      for (const JudgedFix& fix : segment.fixes) CHECK(reported.at(fix.sequence) == fix.used);
    }
  }
}

SCENARIO("the smoother starts from the attitude at the time that it states") {
  GIVEN("a body that turns at 9 rad/s, with a fast IMU") {
    sim::Scenario spin = sim::find_scenario("spin");
    spin.sensors.imu_rate_hz = GENERATE(100.0, 200.0, 1000.0);
    const std::uint64_t seed = GENERATE(range(31U, 34U));
    CAPTURE(spin.sensors.imu_rate_hz, seed);
    const sim::Recording run = sim::record(spin, {.seed = seed, .duration_s = 12.0});
    const std::vector<Segment> segments = estimation::offline::judged({}, run.events);
    REQUIRE(segments.size() == 1);
    const Segment& segment = segments.front();
    const auto truth = std::find_if(run.truth.begin(), run.truth.end(), [&](const TruthSample& sample) {
      return sample.time_ns == segment.settled_ns;
    });
    REQUIRE(truth != run.truth.end());
    THEN("its attitude is the true one within half a degree") {
      constexpr double half_a_degree_rad = 0.0087;
      CHECK(segment.settled.q_body_to_world.angularDistance(truth->q_body_to_world) < half_a_degree_rad);
    }
  }
}

SCENARIO("times are those of the measurement") {
  GIVEN("settings that name a fixed delay of 100 ms, and a calibrated gyroscope") {
    settings::Settings settings;
    settings.delay.source = settings::DelaySource::fixed;
    settings.delay.processing_s = 0.1;
    settings.calibration.gyroscope.offset_z_radps = 0.02;
    const std::vector<Event> events = events_of(sim::find_scenario("walk"), 32, 10.0);
    const auto segments = estimation::offline::judged(settings, events);
    REQUIRE(segments.size() == 1);
    THEN("a fix was measured 100 ms before its receipt, and the offset is removed from the rates") {
      std::map<std::uint64_t, TimeNs> received;
      std::map<TimeNs, double> yaw_rates;
      for (const Event& event : events) {
        if (const auto* fix = std::get_if<UltrasonicFix>(&event))
          received[fix->sequence] = fix->received_time_ns;
        if (const auto* imu = std::get_if<ImuSample>(&event)) {
          yaw_rates[imu->sensor_time_ns] = imu->angular_velocity_body_radps.z();
        }
      }
      for (const JudgedFix& fix : segments[0].fixes) {
        CHECK(received.at(fix.sequence) - fix.measured.time_ns == to_ns(0.1));
      }
      for (const auto& imu : segments[0].imu) {
        CHECK(imu.rate_body_radps.z() == Approx(yaw_rates.at(imu.time_ns) - 0.02).margin(1e-12));
      }
    }
  }
}

SCENARIO("a pose that the user sets is judged at its arrival") {
  GIVEN("a walk whose fixes and headings end after 10 s") {
    std::vector<Event> events = events_of(sim::find_scenario("walk"), 32, 20.0);
    std::erase_if(events, [begin_ns = available_at_ns(events.front())](const Event& event) {
      return !std::holds_alternative<ImuSample>(event) &&
             seconds_between(begin_ns, available_at_ns(event)) > 10.0;
    });
    const auto arrival = std::find_if(events.begin(), events.end(), [&](const Event& event) {
      return since_start_s(events, available_at_ns(event)) > 15.0;
    });
    REQUIRE(arrival != events.end());
    WHEN("a pose 20 m away is set after 15 s, with the stamp of whatever clock") {
      constexpr std::uint64_t sequence = 1'000'000;
      const TimeNs now_ns = std::get<ImuSample>(*std::prev(arrival)).sensor_time_ns;
      const TimeNs stamp_ns = now_ns + to_ns(GENERATE(0.0, 2.0, -30.0));
      UltrasonicFix fix;
      fix.sequence = sequence;
      fix.emission_time_ns = fix.received_time_ns = stamp_ns;
      fix.flags = ultrasonic_flag_set_pose;
      fix.position_world_m = {20, 0, 1};
      fix.covariance_world_m2 = Covariance<3>::from_matrix(0.01 * Eigen::Matrix3d::Identity());
      const PairHeading heading{.sequence = sequence,
                                .emission_time_ns = stamp_ns,
                                .received_time_ns = stamp_ns,
                                .heading_world_rad = 2.0,
                                .valid = true,
                                .std_rad = 0.1,
                                .flags = heading_flag_of_body | heading_flag_set_pose};
      events.insert(events.insert(arrival, heading) + 1, fix);
      const auto segments = estimation::offline::judged({}, events);
      THEN("a segment begins there and then, with its position and yaw") {
        REQUIRE(segments.size() == 2);
        const JudgedFix& first = segments[1].fixes.front();
        CHECK(first.sequence == sequence);
        CHECK(first.used);
        CHECK(first.measured.time_ns == now_ns);
        const auto poses = estimation::offline::smoothed({}, segments[1], {});
        REQUIRE_FALSE(poses.empty());
        CHECK((poses.front().position_world_m - fix.position_world_m).norm() < 0.3);
        CHECK(std::abs(geometry::wrap_angle(geometry::yaw_of(poses.front().q_body_to_world) - 2.0)) < 0.2);
      }
    }
  }
}

SCENARIO("a segment ends with the samples before a silence of the IMU") {
  GIVEN("a walk without headings in which the IMU is silent for five seconds") {
    sim::Scenario scenario = sim::find_scenario("no_heading");
    scenario.disturbances.imu_outages = {{20.0, 5.0}};
    const std::vector<Event> events = events_of(scenario, 33, 40.0);
    const auto segments = estimation::offline::judged({}, events);
    THEN("there are two segments, and the second begins after the silence") {
      REQUIRE(segments.size() == 2);
      CHECK(since_start_s(events, segments[0].imu.back().time_ns) < 20.1);
      CHECK(since_start_s(events, segments[1].imu.front().time_ns) > 24.9);
    }
  }
}

SCENARIO("fixes of a frozen track are taken back from the first repetition on") {
  GIVEN("a walk whose fixes repeat one position for three seconds") {
    std::vector<Event> events = events_of(sim::find_scenario("walk"), 34, 30.0);
    const TimeNs begin_ns = available_at_ns(events.front());
    const auto is_frozen = [&](TimeNs time_ns) {
      const double time_s = seconds_between(begin_ns, time_ns);
      return time_s > 20.0 && time_s < 23.0;
    };
    std::optional<Vector3d> repeated_world_m;
    for (auto* fix : test::each<UltrasonicFix>(events)) {
      if (!is_frozen(fix->emission_time_ns)) continue;
      if (!repeated_world_m) repeated_world_m = fix->position_world_m;
      fix->position_world_m = *repeated_world_m;
    }
    WHEN("it is judged") {
      const auto segments = estimation::offline::judged({}, events);
      REQUIRE(segments.size() == 1);
      THEN("no repetition counts, only the first fix at that position") {
        int used = 0;
        int repeated = 0;
        for (const JudgedFix& fix : segments[0].fixes) {
          if (!is_frozen(fix.measured.time_ns)) continue;
          ++repeated;
          used += fix.used ? 1 : 0;
        }
        CHECK(repeated > 20);
        CHECK(used == 1);
      }
    }
  }
}

}  // namespace judgement_test
