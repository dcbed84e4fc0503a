/// Findings about recorded input.

#include "recording/input_check.hpp"

#include "recording/standing_events.hpp"
#include "support/events.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

namespace input_check_test {

using namespace sonopose;
using namespace sonopose::recording;
using Catch::Contains;
using Catch::EndsWith;
using sonopose::test::standing;
using sonopose::test::start_ns;

/// The findings after a change of each IMU sample.
std::vector<std::string> with_imu(const std::function<void(ImuSample&)>& change) {
  std::vector<Event> events = standing();
  for (auto* imu : test::each<ImuSample>(events)) change(*imu);
  return input_findings("log", events);
}

SCENARIO("good input has no finding") {
  CHECK(input_findings("log", standing()).empty());
}

SCENARIO("a wrong unit or clock is found, with the unit to name") {
  GIVEN("an IMU in microseconds, read as nanoseconds") {
    const auto findings = with_imu([](ImuSample& imu) { imu.sensor_time_ns /= 1000; });
    THEN("the unit is proposed, and the fixes do not belong to these times") {
      REQUIRE(findings.size() == 2);
      CHECK_THAT(findings[0], Contains("log: the IMU samples come at 100000 Hz") && Contains("in us?") &&
                                  Contains("at 100 Hz") && Contains("timestamp [us]"));
      CHECK_THAT(findings[1], Contains("most fixes are after the IMU samples"));
    }
  }
  GIVEN("an IMU in seconds without decimals") {
    const auto findings =
        with_imu([](ImuSample& imu) { imu.sensor_time_ns = imu.sensor_time_ns / 10'000'000; });
    THEN("the rate is a finding") {
      REQUIRE_FALSE(findings.empty());
      CHECK_THAT(findings[0], Contains("the IMU samples come at 1e+09 Hz"));
    }
  }
  GIVEN("an IMU in milliseconds, read as seconds") {
    const auto findings = with_imu(
        [](ImuSample& imu) { imu.sensor_time_ns = start_ns + 1000 * (imu.sensor_time_ns - start_ns); });
    THEN("the rate is a finding") {
      REQUIRE_FALSE(findings.empty());
      CHECK_THAT(findings[0], Contains("the IMU samples come at 0.1 Hz"));
    }
  }
  GIVEN("stamps that lost their last digits") {
    const auto findings = with_imu([](ImuSample& imu) { imu.sensor_time_ns = start_ns; });
    THEN("they are counted") {
      REQUIRE_FALSE(findings.empty());
      CHECK_THAT(findings[0], Contains("999 of 1000 IMU samples have the stamp of the one before"));
    }
  }
  GIVEN("a specific force in g") {
    const auto findings =
        with_imu([](ImuSample& imu) { imu.specific_force_body_mps2 /= standard_gravity_mps2; });
    THEN("the unit is proposed") {
      REQUIRE(findings.size() == 1);
      CHECK_THAT(findings[0], Contains("accelerometer reads 1 m/s^2") && Contains("a_x [g]"));
    }
  }
  GIVEN("an accelerometer without gravity") {
    const auto findings =
        with_imu([](ImuSample& imu) { imu.specific_force_body_mps2.z() -= standard_gravity_mps2; });
    THEN("that is the finding") {
      REQUIRE(findings.size() == 1);
      CHECK_THAT(findings[0], Contains("was gravity removed?"));
    }
  }
  GIVEN("an accelerometer that is dead") {
    const auto findings = with_imu([](ImuSample& imu) { imu.specific_force_body_mps2.setZero(); });
    THEN("that is the finding") {
      REQUIRE(findings.size() == 1);
      CHECK_THAT(findings[0], Contains("the accelerometer reads 0 0 0 for 9.99 s"));
    }
  }
  GIVEN("times of reception in another unit") {
    std::vector<Event> events = standing();
    for (auto* fix : test::each<UltrasonicFix>(events)) fix->received_time_ns /= 1000;
    const auto findings = input_findings("log", events);
    THEN("the fixes seem to arrive before they are emitted") {
      REQUIRE(findings.size() == 1);
      CHECK_THAT(findings[0],
                 Contains("the fixes are received 16983") && Contains(" s before their emission"));
    }
  }
  GIVEN("fixes of another clock, and one IMU sample with a wrong stamp") {
    std::vector<Event> events = standing();
    for (auto* fix : test::each<UltrasonicFix>(events)) {
      fix->emission_time_ns += 100'000'000'000;
      fix->received_time_ns += 100'000'000'000;
    }
    std::get<ImuSample>(events.back()).sensor_time_ns += 200'000'000'000;
    THEN("the one stamp does not hide it") {
      const auto findings = input_findings("log", events);
      REQUIRE_FALSE(findings.empty());
      CHECK_THAT(findings[0], Contains("most fixes are after the IMU samples"));
    }
  }
  GIVEN("a gyroscope of the wrong sign, and headings") {
    std::vector<Event> events = standing();
    const auto heading_rad = [](TimeNs time_ns) { return seconds_between(start_ns, time_ns); };
    for (Event& event : events) {
      if (auto* imu = std::get_if<ImuSample>(&event)) imu->angular_velocity_body_radps.z() -= 1.0;
      const auto* fix = std::get_if<UltrasonicFix>(&event);
      if (fix == nullptr) continue;
      PairHeading heading;
      heading.emission_time_ns = fix->emission_time_ns;
      heading.received_time_ns = fix->received_time_ns;
      heading.valid = true;
      heading.heading_world_rad = std::remainder(heading_rad(fix->emission_time_ns), 2 * std::numbers::pi);
      event = heading;
    }
    THEN("the gain is the finding") {
      const auto findings = input_findings("log", events);
      REQUIRE(findings.size() == 1);
      CHECK_THAT(findings[0],
                 Contains("measures -1.00 of the turns that the headings show: are the headings clockwise"));
    }
  }
  GIVEN("an axis that keeps its value while the others vary") {
    int count = 0;
    const auto findings = with_imu([&count](ImuSample& imu) {
      imu.specific_force_body_mps2.x() = 0;
      imu.specific_force_body_mps2.y() = 1e-3 * ++count;
      imu.specific_force_body_mps2.z() += 1e-3 * count;
    });
    THEN("it is named") {
      REQUIRE(findings.size() == 1);
      CHECK_THAT(findings[0], Contains("axis x of the accelerometer is stuck at 0.00 m/s^2"));
    }
  }
  GIVEN("rates in degrees per second") {
    const auto findings = with_imu([](ImuSample& imu) { imu.angular_velocity_body_radps.z() += 90.0; });
    THEN("the unit is proposed") {
      REQUIRE(findings.size() == 1);
      CHECK_THAT(findings[0], Contains("w_x [deg s^-1]"));
    }
  }
}

/// The findings after a change of each fix, by its time since the start.
std::vector<std::string> with_fixes(const std::function<void(UltrasonicFix&, double)>& change) {
  std::vector<Event> events = standing();
  for (auto* fix : test::each<UltrasonicFix>(events)) {
    change(*fix, seconds_between(start_ns, fix->emission_time_ns));
  }
  return input_findings("log", events);
}

SCENARIO("positions that are not in metres are found") {
  constexpr double radius_m = 2.0;
  const auto on_circle = [](double time_s, double unit) -> Vector3d {
    return Vector3d(radius_m * std::cos(time_s), radius_m * std::sin(time_s), 0.5) * unit;
  };
  GIVEN("a circle at 2 m/s") {
    THEN("in metres there is no finding, except each tenth fix at a default position 30 m away") {
      CHECK(with_fixes([&](UltrasonicFix& fix, double time_s) {
              fix.position_world_m = on_circle(time_s, 1.0);
            }).empty());
      int count = 0;
      const auto findings = with_fixes([&](UltrasonicFix& fix, double time_s) {
        fix.position_world_m = on_circle(time_s, 1.0);
        if (++count % 10 == 0) fix.position_world_m = {30.0, 0.0, 0.0};
      });
      REQUIRE(findings.size() == 1);
      CHECK_THAT(findings[0], Contains("8 of 84 fixes are 30.00 0.00 0.00 m, a default position"));
    }
    THEN("in millimetres and centimetres it contradicts the IMU") {
      const double unit = GENERATE(100.0, 1000.0);
      const auto findings = with_fixes(
          [&](UltrasonicFix& fix, double time_s) { fix.position_world_m = on_circle(time_s, unit); });
      REQUIRE(findings.size() == 1);
      CHECK_THAT(findings[0], Contains("the positions accelerate by more than") && Contains("x [mm]"));
    }
  }
  GIVEN("a body at rest, in whole millimetres") {
    const auto findings = with_fixes([](UltrasonicFix& fix, double /*unused*/) {
      fix.position_world_m = {1500.0, 230.0, 0.0};
    });
    THEN("the numbers show it") {
      REQUIRE(findings.size() == 1);
      CHECK_THAT(findings[0], Contains("all positions are whole numbers, up to 1500; are they in mm"));
    }
  }
}

SCENARIO("positions that are sent again while the IMU moves are found") {
  std::vector<Event> events = standing();
  const auto with_acceleration = [&events](double most_mps2) {
    for (auto* imu : test::each<ImuSample>(events)) {
      const double at_s = seconds_between(start_ns, imu->sensor_time_ns);
      imu->specific_force_body_mps2 = {0, 0, standard_gravity_mps2};
      imu->specific_force_body_mps2 +=
          most_mps2 * Vector3d(std::sin(2 * at_s), 0.1 * std::sin(3 * at_s), 0.1 * std::sin(5 * at_s));
    }
    return input_findings("log", events);
  };
  CHECK(with_acceleration(0).empty());  // at rest
  const auto findings = with_acceleration(1.0);
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0], Contains("83 of 84 fixes repeat the position of the one before"));
  int count = 0;
  for (auto* fix : test::each<UltrasonicFix>(events)) {
    fix->position_world_m.x() = 0.1 * std::floor(count++ / 2.0);
  }
  CHECK(with_acceleration(1.0).empty());
}

SCENARIO("headings in radians are found") {
  std::vector<Event> events = standing();
  for (auto* imu : test::each<ImuSample>(events)) imu->angular_velocity_body_radps.z() += 1.0;
  const auto findings_with = [&](double unit_rad) {
    std::vector<Event> all = events;
    for (int i = 0; i < 80; ++i) {
      PairHeading heading;
      heading.emission_time_ns = start_ns + i * 120'000'000LL;
      heading.received_time_ns = heading.emission_time_ns + 70'000'000;
      const double turned_rad = std::remainder(0.12 * i, 2 * std::numbers::pi);
      heading.heading_world_rad = unit_rad * turned_rad;
      heading.valid = true;
      all.emplace_back(heading);
    }
    return input_findings("log", all);
  };
  CHECK(findings_with(1.0).empty());
  const auto findings = findings_with(std::numbers::pi / 180.0);
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0], Contains("are they in rad?") && Contains("heading [rad]"));
}

SCENARIO("a quality that is a share is found") {
  const auto findings_with = [](double good, double poor) {
    return with_fixes(
        [=](UltrasonicFix& fix, double time_s) { fix.quality_percent = time_s < 5.0 ? good : poor; });
  };
  CHECK(findings_with(98.0, 0.5).empty());
  CHECK(findings_with(1.0, 0.0).empty());  // may be a flag
  const auto findings = findings_with(1.0, 0.85);
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0], Contains("at most 1 %; is it a share from 0 to 1?") && Contains("quality [1]"));
}

SCENARIO("findings about imported tables propose an option of the import") {
  std::vector<Event> events = standing();
  for (auto* imu : test::each<ImuSample>(events)) imu->specific_force_body_mps2 /= standard_gravity_mps2;
  csv::ColumnNames names;
  names.columns_by_reader = {{{"a_x", "Acc 1"}, {"a_y", "Acc 2"}, {"a_z", "Acc 3"}}};
  const auto findings = input_findings("log", events, &names);
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0], Contains("--column \"a_x [g]=Acc 1\" --column \"a_y [g]=Acc 2\""));
}

SCENARIO("times that are taken for seconds may be in milliseconds") {
  std::vector<Event> events = standing();
  for (auto* imu : test::each<ImuSample>(events)) {
    imu->sensor_time_ns += 999 * (imu->sensor_time_ns - start_ns);
  }
  csv::ColumnNames names;
  names.columns_by_reader = {{{"timestamp", "t"}}, {{"timestamp", "t"}}};
  names.file_by_reader = {"imu.csv", "positions.csv"};
  CHECK_THAT(input_findings("log", events, &names)[0], EndsWith("check their unit"));
  names.readers_in_seconds = {0};
  CHECK_THAT(
      input_findings("log", events, &names)[0],
      Contains("the IMU samples come at 0.1 Hz by their stamps; are these in ms? Then they come at 100 Hz") &&
          EndsWith("add --column \"imu.csv:timestamp [ms]=t\""));
}

SCENARIO("fixes of a clock that is some seconds ahead are found") {
  const auto shifted_by = [](double seconds) {
    return with_fixes([seconds](UltrasonicFix& fix, double /*unused*/) {
      fix.emission_time_ns += to_ns(seconds);
      fix.received_time_ns += to_ns(seconds);
    });
  };
  CHECK(shifted_by(0.5).empty());  // may be the order in which drivers start and end
  REQUIRE(shifted_by(3.0).size() == 1);
  CHECK_THAT(shifted_by(3.0)[0], Contains("the fixes begin 3.000 s and end 2.970 s after the IMU samples"));
  CHECK_THAT(shifted_by(-3.0)[0], Contains("before the IMU samples"));
}

SCENARIO("fixes of another clock than the headings of their pair are found") {
  const auto findings_with = [](TimeNs shift_ns) {
    std::vector<Event> events = standing();
    std::vector<Event> headings;
    for (auto* fix : test::each<UltrasonicFix>(events)) {
      PairHeading heading;
      heading.emission_time_ns = fix->emission_time_ns;
      heading.received_time_ns = fix->received_time_ns;
      heading.valid = true;
      headings.emplace_back(heading);
      fix->emission_time_ns += shift_ns;
      fix->received_time_ns += shift_ns;
    }
    events.insert(events.end(), headings.begin(), headings.end());
    return input_findings("log", events);
  };
  CHECK(findings_with(0).empty());
  CHECK(findings_with(100'000'000).empty());
  for (const TimeNs shift_ns : {TimeNs{500'000'000}, TimeNs{-300'000'000}}) {
    const auto findings = findings_with(shift_ns);
    REQUIRE(findings.size() == 1);
    CHECK_THAT(findings[0], Contains("the fixes begin ") &&
                                Contains(shift_ns > 0 ? "after the headings" : "before the headings"));
  }
}

SCENARIO("impossible receptions and qualities are found") {
  CHECK_THAT(
      with_fixes([](UltrasonicFix& fix, double /*unused*/) { fix.received_time_ns -= 200'000'000; })[0],
      Contains("the fixes are received 0.130 s before their emission"));
  CHECK_THAT(with_fixes([](UltrasonicFix& fix, double /*unused*/) { fix.quality_percent = 230; })[0],
             Contains("the quality of fixes is up to 230 %"));
}

SCENARIO("the order of the stamps is checked") {
  GIVEN("a reversed file") {
    std::vector<Event> events = standing();
    const std::vector<Event> reversed(events.rbegin(), events.rend());
    THEN("both streams are named") {
      const auto findings = input_findings("log", reversed);
      REQUIRE(findings.size() == 2);
      CHECK_THAT(findings[0], Contains("the IMU samples are in reverse order of time: 999 of 1000"));
      CHECK_THAT(findings[1], Contains("the fixes are in reverse order"));
    }
  }
  GIVEN("a clock that was set back by two seconds") {
    int count = 0;
    const auto findings = with_imu([&count](ImuSample& imu) {
      if (++count > 500) imu.sensor_time_ns -= 2'000'000'000;
    });
    THEN("the step is counted, with its size") {
      REQUIRE(findings.size() == 1);
      CHECK_THAT(findings[0],
                 Contains("199 of 1000 IMU samples") && Contains("in 1 step back, the first by 1.990 s"));
    }
  }
}

SCENARIO("missing samples are a finding") {
  std::vector<Event> events = standing();
  std::erase_if(events, [](const Event& event) { return std::holds_alternative<ImuSample>(event); });
  const auto findings = input_findings("log", events);
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0], Contains("there is no IMU sample"));
}

SCENARIO("velocities in another unit are found by the fixes") {
  GIVEN("a body that drives at 1 m/s, with velocities at 20 Hz") {
    const auto factor = GENERATE(1.0, 3.6, 100.0, 1000.0, 8.0, 0.1);
    const Eigen::Index axis = GENERATE(0, 1);  // the IMU may be turned on the robot
    std::vector<Event> events = standing();
    for (auto* fix : test::each<UltrasonicFix>(events)) {
      fix->position_world_m.x() = seconds_between(start_ns, fix->emission_time_ns);
    }
    for (int i = 0; i < 200; ++i) {
      TwistSample twist;
      twist.emission_time_ns = twist.received_time_ns = start_ns + i * 50'000'000LL;
      twist.velocity_body_mps[axis] = factor;
      twist.axes = axis == 0 ? twist_velocity_x : twist_velocity_y;
      events.emplace_back(twist);
    }
    const auto findings = input_findings("log", events);
    THEN("the unit is proposed, unless it is right or unknown") {
      REQUIRE(findings.size() == (factor == 1.0 ? 0 : 1));
      if (factor == 3.6) CHECK_THAT(findings[0], Contains("in km h^-1?") && Contains("v_x [km h^-1]"));
      if (factor == 100.0) CHECK_THAT(findings[0], Contains("in cm s^-1?"));
      if (factor == 1000.0) CHECK_THAT(findings[0], Contains("in mm s^-1?"));
      if (factor == 8.0 || factor == 0.1) CHECK_THAT(findings[0], Contains("check their unit"));
    }
  }
}

SCENARIO("velocities that turn against the gyroscope are found") {
  GIVEN("a body that turns to and fro at up to 0.5 rad/s, and wheels that measure it with a slip of 30 %") {
    const double gain = GENERATE(1.0, 1.3, -1.3, 0.0);
    std::vector<Event> events = standing();
    const auto rate_radps = [](TimeNs time_ns) { return 0.5 * std::sin(seconds_between(start_ns, time_ns)); };
    for (auto* imu : test::each<ImuSample>(events)) {
      imu->angular_velocity_body_radps.z() += rate_radps(imu->sensor_time_ns);
    }
    for (int i = 0; i < 200; ++i) {
      TwistSample twist;
      twist.emission_time_ns = twist.received_time_ns = start_ns + i * 50'000'000LL;
      twist.angular_velocity_body_radps.z() = gain * rate_radps(twist.emission_time_ns);
      twist.axes = twist_velocity_x | twist_angular_velocity_z;
      events.emplace_back(twist);
    }
    const auto findings = input_findings("log", events);
    THEN("the other sense of rotation is a finding, and slip and wheels that measure no turn are none") {
      CHECK(findings.size() == (gain < 0 ? 1 : 0));
      if (gain < 0) CHECK_THAT(findings.at(0), Contains("are left and right wheels swapped"));
    }
  }
}

}  // namespace input_check_test
