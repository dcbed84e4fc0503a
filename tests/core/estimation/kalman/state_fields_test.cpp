/// Invalid saved states of the Kalman engine.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/state_fields.hpp>

#include <catch2/catch.hpp>

#include <limits>
#include <string>

namespace kalman_state_fields_test {

using namespace sonopose;
using namespace sonopose::estimation;
using namespace sonopose::estimation::kalman;

/// A walk of 5 s.
Snapshot moving_state() {
  const sim::Recording walk = sim::record(sim::find_scenario("walk"), {.seed = 5, .duration_s = 5.0});
  Engine engine{settings::Settings{}};
  for (const Event& event : walk.events) process(engine, event);
  return engine.snapshot();
}

/// Name of the invalid field after `change`.
template <class Change>
std::string fault_after(const Change& change) {
  Snapshot snapshot = moving_state();
  change(snapshot);
  const auto fault = find_fault(snapshot);
  return fault ? std::string(fault->field) : "none";
}

SCENARIO("every state of a run may be restored") {
  GIVEN("runs with wrong tracks, an unknown yaw, gaps of the IMU and a map that turns") {
    const char* const scenario =
        GENERATE("walk", "no_heading", "wrong_tracks", "imu_gaps", "moved_map", "rest");
    CAPTURE(scenario);
    const sim::Recording run = sim::record(sim::find_scenario(scenario), {.seed = 3, .duration_s = 60.0});
    THEN("no state has a fault") {
      Engine engine{settings::Settings{}};
      int count = 0;
      for (const Event& event : run.events) {
        process(engine, event);
        if (++count % 500 != 0) continue;
        const auto fault = find_fault(engine.snapshot());
        const std::string text = fault ? std::string(fault->field) + " " + std::string(fault->fault) : "none";
        REQUIRE(text == "none");
      }
    }
  }
}

SCENARIO("an impossible state is refused by the field at fault") {
  const auto filter_of = [](Snapshot& snapshot) -> Filter& { return snapshot.history.base.bank[0].filter; };
  GIVEN("the state of a walk") {
    THEN("it has no fault") {
      CHECK(fault_after([](Snapshot&) {}) == "none");
    }
    THEN("no index or count may point outside of its array") {
      CHECK(fault_after([](Snapshot& s) { s.history.base.bank.best_index = s.history.base.bank.size(); }) ==
            "best_index");
      CHECK(fault_after([](Snapshot& s) { s.history.base.bank.best_index = -1; }) == "best_index");
      CHECK(fault_after([](Snapshot& s) {
              s.history.base.bank.hypotheses.resize(HypothesisBank::capacity + 1);
            }) == "hypotheses");
      CHECK(fault_after([](Snapshot& s) { s.history.base.bank.clear(); }) == "hypotheses");
      CHECK(fault_after([](Snapshot& s) { s.history.imu.resize(imu_capacity + 1, s.history.imu.back()); }) ==
            "imu");
      CHECK(fault_after([](Snapshot& s) {
              s.history.fixes.resize(aiding_capacity + 1, s.history.fixes.back());
            }) == "fixes");
    }
    THEN("there is one hypothesis of each trusting model, and at most one of each other track") {
      CHECK(fault_after([](Snapshot& s) {
              s.history.base.bank.remove(s.history.base.bank.find(ImuModel::rough));
            }) == "hypotheses");
      CHECK(fault_after([](Snapshot& s) { s.history.base.bank[3].imu = ImuModel::quiet; }) == "hypotheses");
      const auto add = [](Snapshot& s, Track track) {
        s.history.base.bank.spawn(s.history.base.bank.best()).track = track;
      };
      CHECK(fault_after([&](Snapshot& s) { add(s, Track::other); }) == "none");
      CHECK(fault_after([&](Snapshot& s) {
              add(s, Track::former);
              add(s, Track::former);
            }) == "hypotheses");
      CHECK(fault_after([&](Snapshot& s) {
              add(s, Track::other);
              add(s, Track::turned);
            }) == "hypotheses");
      CHECK(fault_after([&](Snapshot& s) {
              for (int i = closed_model_count; i < HypothesisBank::capacity; ++i) {
                s.history.base.bank.spawn(s.history.base.bank.best()).imu = ImuModel::distrusts_imu;
              }
            }) == "hypotheses");
      CHECK(fault_after([&](Snapshot& s) {
              add(s, Track::other);
              s.history.base.bank.best_index = s.history.base.bank.size() - 1;
            }) == "best_index");
    }
    THEN("no count or time may overflow") {
      CHECK(fault_after([](Snapshot& s) { s.history.base.rest.samples = std::numeric_limits<int>::max(); }) ==
            "samples");
      CHECK(fault_after([](Snapshot& s) { s.history.base.bank[0].missed_in_row = -1; }) == "missed_in_row");
      CHECK(fault_after([](Snapshot& s) {
              s.history.base.imu.time_ns = std::numeric_limits<TimeNs>::min();
            }) == "time_ns");
      CHECK(fault_after([](Snapshot& s) { s.admission.announced_ns = std::numeric_limits<TimeNs>::max(); }) ==
            "admission.announced_ns");
    }
    THEN("a covariance is finite, symmetric and positive") {
      CHECK(fault_after([&](Snapshot& s) { filter_of(s).covariance(2, 2) = -1.0; }) == "hypotheses");
      CHECK(fault_after([&](Snapshot& s) { filter_of(s).covariance(1, 2) += 1e-6; }) == "hypotheses");
      CHECK(fault_after([&](Snapshot& s) { filter_of(s).covariance(0, 0) = std::nan(""); }) == "hypotheses");
      CHECK(fault_after([&](Snapshot& s) {
              filter_of(s).covariance(0, 9) = filter_of(s).covariance(9, 0) = 10.0;
            }) == "hypotheses");
      CHECK(fault_after([&](Snapshot& s) { filter_of(s).delay_variance_s2 = -1.0; }) == "hypotheses");
      CHECK(fault_after([](Snapshot& s) {
              s.history.fixes.back().has_covariance = true;
              s.history.fixes.back().covariance_world_m2 = -Matrix3d::Identity();
            }) == "fixes");
    }
    THEN("a noise is positive") {
      CHECK(fault_after([](Snapshot& s) { s.history.base.noise.any_quality.vertical_m2.variance = 0.0; }) ==
            "any_quality");
      CHECK(fault_after([](Snapshot& s) { s.history.base.noise.bins[1].horizontal_m2.samples = -1.0; }) ==
            "bins");
      CHECK(fault_after([](Snapshot& s) { s.history.base.noise.heading_rad2.variance = -1.0; }) ==
            "heading_rad2");
      CHECK(fault_after([](Snapshot& s) {
              s.history.base.noise.any_quality.horizontal_m2.motion_variance = 0.0;
            }) == "any_quality");
      CHECK(fault_after([](Snapshot& s) {
              s.history.base.noise.bins[1].vertical_m2.motion_variance = -1.0;
            }) == "bins");
      CHECK(fault_after([](Snapshot& s) { s.history.base.noise.heading_rad2.motion_variance = 0.0; }) ==
            "heading_rad2");
      CHECK(fault_after([](Snapshot& s) { s.history.base.slow_error.power_m4 = -1.0; }) == "slow_error");
    }
    THEN("what was learned of times is within its limits") {
      CHECK(fault_after([](Snapshot& s) { s.history.base.imu.nominal_imu_period_s = -0.01; }) ==
            "nominal_imu_period_s");
      CHECK(fault_after([](Snapshot& s) { s.history.base.imu.nominal_imu_period_s = 5.1; }) ==
            "nominal_imu_period_s");
      CHECK(fault_after([](Snapshot& s) { s.history.base.headings.interval_s = std::nan(""); }) ==
            "interval_s");
      CHECK(fault_after([](Snapshot& s) { s.history.base.headings.interval_s = 10.1; }) == "interval_s");
      CHECK(fault_after([](Snapshot& s) { s.history.base.wrong_tracks.longest_s = -1.0; }) == "longest_s");
      CHECK(fault_after([](Snapshot& s) { s.history.base.rest.fixes.weight = -1.0; }) == "rest.fixes");
      CHECK(fault_after([](Snapshot& s) { s.history.base.rest.headings.time_squares_s2 = -1.0; }) ==
            "rest.headings");
    }
    THEN("no event is older than the state") {
      CHECK(fault_after([](Snapshot& s) { s.history.imu.front().time_ns -= 1'000'000'000; }) == "imu");
      CHECK(fault_after([](Snapshot& s) { s.history.fixes.front().time_ns -= 2'000'000'000; }) == "fixes");
      CHECK(fault_after([](Snapshot& s) { s.history.headings.front().time_ns -= 2'000'000'000; }) ==
            "headings");
    }
  }
}

}  // namespace kalman_state_fields_test
