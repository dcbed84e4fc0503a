/// Fixes of a mirrored map, and of another clock than the IMU's, while the beacon moves.

#include "doctor/replayed.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace changes_test {

using namespace sonopose;
using namespace sonopose::doctor::test;
using Catch::Contains;

/// Changes the fixes, and the headings if wanted.
void change(std::vector<Event>& events, const std::function<void(UltrasonicFix&)>& of_fix,
            const std::function<void(PairHeading&)>& of_heading = {}) {
  for (Event& event : events) {
    if (auto* const fix = std::get_if<UltrasonicFix>(&event)) of_fix(*fix);
    auto* const heading = std::get_if<PairHeading>(&event);
    if (heading != nullptr && of_heading) of_heading(*heading);
  }
  std::ranges::stable_sort(events, {}, [](const Event& event) { return available_at_ns(event); });
}

struct Mirror {
  const char* remedy;
  std::function<Vector3d(const Vector3d&)> of;
};

const std::vector<Mirror> mirrors{
    {"; change the sign of y at", [](const Vector3d& at) { return Vector3d(at.x(), -at.y(), at.z()); }},
    {"; change the sign of x at", [](const Vector3d& at) { return Vector3d(-at.x(), at.y(), at.z()); }},
    {"; exchange x and y at", [](const Vector3d& at) { return Vector3d(at.y(), at.x(), at.z()); }},
    {"; exchange x and y, and change the sign of both at",
     [](const Vector3d& at) { return Vector3d(-at.y(), -at.x(), at.z()); }}};

TEST_CASE("Mirrored fixes are found by right headings, with the change that corrects them") {
  std::uint64_t seed = 2501;
  for (const char* const scenario : {"walk", "kart", "forklift", "drone"}) {
    const Mirror& mirror = mirrors.at(seed % mirrors.size());
    auto events = events_of(scenario, seed++, 32.5);
    change(events, [&](UltrasonicFix& fix) { fix.position_world_m = mirror.of(fix.position_world_m); });
    const std::string problems = problems_of(observed(events, {}, {8, 24}));
    CAPTURE(scenario, mirror.remedy, problems);
    CHECK_THAT(problems, Contains("its fixes are mirrored") && Contains(mirror.remedy));
    CHECK_THAT(problems, !Contains("gyroscope") && !Contains("accelerometer") && !Contains("mount offset"));
  }
}

TEST_CASE("A mirrored map is found without headings, and with those of the map") {
  std::uint64_t seed = 2601;
  for (const char* const scenario : {"walk", "kart", "forklift", "drone"}) {
    const bool has_headings = scenario == std::string("forklift");  // it drives straight for long
    auto events = events_of(scenario, seed++, 32.5,
                            [&](sim::SensorSettings& sensors) { sensors.pair_heading = has_headings; });
    change(
        events, [](UltrasonicFix& fix) { fix.position_world_m.y() *= -1; },
        [](PairHeading& heading) { heading.heading_world_rad *= -1; });
    const std::string problems = problems_of(observed(events, {}, {8, 24}));
    CAPTURE(scenario, has_headings, problems);
    CHECK_THAT(problems, Contains("its fixes are mirrored") &&
                             Contains("; exchange x and y, or change the sign of one of them at"));
    CHECK_THAT(problems, !Contains("gyroscope") && !Contains("accelerometer"));
  }
}

TEST_CASE("Stamps of fixes and IMU of different clocks are found, with the value to try") {
  struct Case {
    const char* scenario;
    double ahead_s;
    bool has_headings;
  };
  std::uint64_t seed = 2701;
  for (const Case& each :
       {Case{"walk", -0.25, true}, Case{"walk", 0.3, true}, Case{"kart", 0.3, false},
        Case{"kart", -0.8, true}, Case{"forklift", -0.4, false}, Case{"drone", 0.2, false}}) {
    auto events = events_of(each.scenario, seed++, 32.5,
                            [&](sim::SensorSettings& sensors) { sensors.pair_heading = each.has_headings; });
    const auto shift = [&](auto& sample) { sample.emission_time_ns += to_ns(each.ahead_s); };
    change(events, shift, shift);
    const std::string problems = problems_of(observed(events, {}, {8, 24}));
    CAPTURE(each.scenario, each.ahead_s, each.has_headings, problems);
    const bool is_younger = each.ahead_s < 0;  // what is older may have another delay
    CHECK_THAT(problems, Contains(is_younger ? "the stamps of fixes and IMU are of different clocks"
                                             : "another delay, or another clock than that of the IMU"));
    CHECK_THAT(problems, !Contains("gyroscope") && !Contains("accelerometer") && !Contains("mount offset") &&
                             !Contains("mirrored"));
    const bool is_possible = std::abs(each.ahead_s) < 0.5;  // the limits of the setting
    const std::string before = is_possible ? "try delay.correction_s=" : "or add ";
    const std::size_t at = problems.find(before);
    REQUIRE(at != std::string::npos);
    CHECK(std::stod(problems.substr(at + before.size())) ==
          Approx(is_possible ? each.ahead_s : -each.ahead_s).margin(0.03));
  }
}

TEST_CASE("Stamps of different clocks are found although the first samples have a gap") {
  auto events = events_of("walk", 2711, 32.5);
  const TimeNs gap_ns = available_at_ns(events.front()) + to_ns(8.0 + 4.0);
  std::erase_if(events, [&](const Event& event) {
    const auto* const imu = std::get_if<ImuSample>(&event);
    return imu != nullptr && std::abs(imu->sensor_time_ns - gap_ns) < to_ns(0.075);
  });
  const auto shift = [](auto& sample) { sample.emission_time_ns += to_ns(0.4); };
  change(events, shift, shift);
  const std::string problems = problems_of(observed(events, {}, {8, 24}));
  CAPTURE(problems);
  CHECK_THAT(problems, Contains("another delay, or another clock than that of the IMU"));
  CHECK_THAT(problems, !Contains("mirrored") && !Contains("wrong sign") && !Contains("mount offset"));
}

TEST_CASE("Stamps that the fusion does not use are not corrected") {
  auto events = events_of("walk", 2712, 32.5);
  const auto shift = [](auto& sample) { sample.emission_time_ns += to_ns(0.3); };
  change(events, shift, shift);
  settings::Settings settings;
  settings.delay.extrapolate = false;
  const std::string problems = problems_of(observed(events, settings, {8, 24}));
  CHECK_THAT(problems, !Contains("delay.") && !Contains("of different clocks"));
  CHECK_THAT(problems, !Contains("mirrored") && !Contains("wrong sign") && !Contains("mount offset"));
}

TEST_CASE("A turned compass is named beside a pair that gives no valid heading") {
  std::vector<Event> events;
  for (const Event& event : events_of("forklift", 2713, 20.5)) {
    events.push_back(event);
    auto* const pair = std::get_if<PairHeading>(&events.back());
    if (pair == nullptr) continue;
    PairHeading compass = *pair;
    pair->valid = false;
    compass.sequence = unnumbered;
    compass.flags |= heading_flag_of_body;
    compass.heading_world_rad += 1.0;
    events.emplace_back(compass);
  }
  const std::string problems = problems_of(observed(events, {}, {8, 12}));
  CAPTURE(problems);
  CHECK_THAT(problems, Contains("its headings are 57") && Contains("not from north"));
  CHECK_THAT(problems, !Contains("mount offset"));
}

}  // namespace changes_test
