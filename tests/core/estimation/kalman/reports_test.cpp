/// The Kalman engine's report on each fix: verdict, hypothesis and IMU model.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <variant>
#include <vector>

namespace kalman_reports_test {

using namespace sonopose;
using namespace sonopose::estimation;

/// Reports of an engine on these events, in order.
std::vector<FixReport> reports_on(const std::vector<Event>& events) {
  kalman::Engine engine{settings::Settings{}};
  std::vector<FixReport> reports;
  for (const Event& event : events) {
    const EventResult result = process(engine, event);
    if (const auto* report = std::get_if<FixReport>(&result)) reports.push_back(*report);
  }
  return reports;
}

double share_of(const std::vector<FixReport>& reports, auto&& predicate) {
  REQUIRE(reports.size() > 100);
  const auto count = std::count_if(reports.begin(), reports.end(), predicate);
  return static_cast<double>(count) / static_cast<double>(reports.size());
}

SCENARIO("the fixes select the model of process noise that fits the IMU") {
  GIVEN("a kart, with an IMU that is good or has twenty times the noise") {
    const std::uint64_t seed = GENERATE(range(31U, 36U));
    CAPTURE(seed);
    sim::Scenario kart = sim::find_scenario("kart");
    const auto share_of_first = [&] {
      const auto reports = reports_on(sim::record(kart, {.seed = seed, .duration_s = 60.0}).events);
      return share_of(reports, [](const FixReport& report) { return report.model == 0; });
    };
    THEN("the first model, of a good IMU, is in use for the good one, and not for the other") {
      CHECK(share_of_first() > 0.9);
      kart.sensors.accel_noise_mps2 *= 20.0;
      kart.sensors.gyro_noise_radps *= 20.0;
      CHECK(share_of_first() < 0.5);
    }
  }
}

SCENARIO("a wrong track is reported as such, and followed by a second hypothesis") {
  GIVEN("a walk whose fixes are 0.7 m off for a second") {
    const std::uint64_t seed = GENERATE(range(41U, 46U));
    CAPTURE(seed);
    sim::Scenario walk = sim::find_scenario("walk");
    constexpr double begin_s = 15.0;
    walk.disturbances.outlier_bursts = {
        {.begin_s = begin_s, .duration_s = 1.0, .offset_world_m = {0.7, 0.0, 0.0}}};
    const sim::Recording run = sim::record(walk, {.seed = seed, .duration_s = 25.0});
    std::vector<FixReport> correct;
    std::vector<FixReport> wrong;
    for (const FixReport& report : reports_on(run.events)) {
      const double time_s = seconds_between(run.truth.front().time_ns, report.emission_time_ns);
      if (time_s < 6.0) continue;
      (time_s >= begin_s && time_s < begin_s + 1.0 ? wrong : correct).push_back(report);
    }
    REQUIRE(wrong.size() > 5);
    THEN("its fixes are outliers, beyond the gate, and change nothing") {
      for (const FixReport& report : wrong) {
        CHECK((report.flags & fix_outlier) != 0);
        CHECK((report.flags & fix_used) == 0);
        CHECK(report.weight == 0.0);
        REQUIRE(report.test_ratio);
        CHECK(*report.test_ratio > 1.0);
        CHECK((report.innovation_world_m - Vector3d(0.7, 0.0, 0.0)).norm() < 0.15);
        CHECK(report.jump_world_m.norm() == 0.0);
      }
    }
    THEN("the first belongs to the main hypothesis, the others to the second") {
      CHECK(wrong.front().hypothesis == 0);
      CHECK(std::all_of(wrong.begin() + 1, wrong.end(),
                        [](const auto& report) { return report.hypothesis == 1; }));
    }
    THEN("the correct ones are used by the main hypothesis, within the gate") {
      CHECK(share_of(correct, [](const FixReport& report) {
              return (report.flags & fix_used) != 0 && report.hypothesis == 0 &&
                     report.test_ratio.value_or(2.0) < 1.0;
            }) > 0.98);
    }
  }
}

}  // namespace kalman_reports_test
