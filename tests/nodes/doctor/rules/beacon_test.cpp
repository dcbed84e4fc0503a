#include "doctor/rules/healthy_system.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>

namespace beacon_test {

using namespace sonopose;
using namespace sonopose::doctor::rules;
using namespace sonopose::doctor::rules::test;
using Catch::Contains;

/// Severity of the finding with `text` in a healthy system whose beacon `change` has modified.
template <class Change>
Severity severity(const std::string& text, const Change& change) {
  return found(findings_with(change), text).severity;
}

TEST_CASE("Missing streams and silences longer than the deadline are reported") {
  CHECK(severity("no IMU samples received", [](auto& b) { b.imu = {}; }) == Severity::error);
  CHECK(severity("no fixes received", [](auto& b) { b.fix = {}; }) == Severity::warning);
  CHECK(severity("no pair headings received", [](auto& b) {
          b.heading = {};
          b.pair_headings = b.valid_pair_headings = 0;
        }) == Severity::note);
  CHECK(severity("24 of 24 pair headings of the hardware are invalid",
                 [](auto& b) { b.valid_pair_headings = 0; }) == Severity::warning);
  CHECK(severity("no poses of this beacon", [](auto& b) { b.pose = {}; }) == Severity::error);
  CHECK(severity("no IMU samples for 0.35 s", [](auto& b) { b.imu.longest_silence_s = 0.35; }) ==
        Severity::warning);
  CHECK(severity("no IMU samples for 0.15 s", [](auto& b) { b.imu.longest_silence_s = 0.15; }) ==
        Severity::note);
  CHECK(severity("no IMU samples for 0.15 s", [](auto& b) {
          b.imu = {24, 8.0, 0.15, 0.1};
        }) == Severity::warning);
  CHECK(severity("no IMU samples for", [](auto& b) { b.imu.longest_silence_s = 0.09; }) == Severity::ok);
  CHECK(severity("no fixes for 2.60 s", [](auto& b) { b.fix = {1, 0.33, 2.6, 2.5}; }) == Severity::warning);
  CHECK(severity("no poses for 1.00 s", [](auto& b) { b.pose.longest_silence_s = 1; }) == Severity::warning);
}

TEST_CASE("Short silences that return are a problem, single ones are a note") {
  const auto silences = [](std::uint64_t count, double window_s) {
    Observations observations = healthy();
    observations.window_s = window_s;
    observations.beacons.front().pose = {6000, 100.0, 0.25, 0.1, count, 0.25 * static_cast<double>(count)};
    return found(diagnose(observations), "no poses for 0.25 s");
  };
  CHECK(silences(1, 8).severity == Severity::note);
  CHECK(silences(2, 8).severity == Severity::note);
  CHECK(silences(3, 8).severity == Severity::warning);
  CHECK_THAT(silences(8, 8).what, Contains("8 such silences, 2.00 s in total"));
  CHECK(silences(3, 3600).severity == Severity::note);
  CHECK(silences(60, 3600).severity == Severity::note);
  CHECK(silences(900, 3600).severity == Severity::warning);  // a sixteenth of the time
}

TEST_CASE("Poses that are silent with the IMU are not reported twice") {
  CHECK(severity("no poses for", [](auto& b) {
          b.imu = {300, 100.0, 0.5, 0.1, 1, 0.5};
          b.pose = {300, 100.0, 0.52, 0.1, 1, 0.52};
        }) == Severity::ok);
  CHECK(severity("no poses for", [](auto& b) {  // the poses have more silences than the IMU
          b.imu = {300, 100.0, 0.5, 0.1, 1, 0.5};
          b.pose = {300, 100.0, 0.52, 0.1, 5, 1.0};
        }) == Severity::warning);
}

TEST_CASE("A pair that is lost during the look is a problem") {
  CHECK(severity("for about 4 s, less than half of its fixes had a pair heading",
                 [](auto& b) { b.pair_lost_s = 4; }) == Severity::warning);
  CHECK(severity("no pair headings for 3.00 s", [](auto& b) { b.heading = {24, 8.0, 3.0, 2.5, 1, 3.0}; }) ==
        Severity::note);
  CHECK(severity("no pair headings for", [](auto& b) {  // there were no fixes either
          b.heading = {24, 8.0, 3.0, 2.5, 1, 3.0};
          b.fix = {24, 8.0, 3.0, 2.5, 1, 3.0};
        }) == Severity::ok);
}

TEST_CASE("Headings of a compass are not taken for those of a pair") {
  const auto with_compass = [](auto& b) { b.pair_headings = b.valid_pair_headings = 0; };
  CHECK(severity("pair", with_compass) == Severity::ok);
  const auto interrupted = [&](auto& b) {
    with_compass(b);
    b.heading = {24, 8.0, 3.0, 2.5, 1, 3.0};
  };
  CHECK(severity("no headings for 3.00 s", interrupted) == Severity::note);
  CHECK(severity("pair", interrupted) == Severity::ok);
  CHECK(severity("although its fixes are those of a pair", [&](auto& b) {
          with_compass(b);
          b.pair_fixes = 24;
        }) == Severity::warning);
}

TEST_CASE("A pair without headings is a problem, a single beacon is not") {
  CHECK(severity("mount_offset_deg=90 configures a pair", [](auto& b) {
          b.heading = {};
          b.fusion_settings.heading.mount_offset_deg = 90;
        }) == Severity::warning);
  CHECK(severity("its fixes are those of a pair", [](auto& b) {
          b.heading = {};
          b.pair_headings = b.valid_pair_headings = 0;
          b.pair_fixes = 20;
        }) == Severity::warning);
}

TEST_CASE("A status that lasts for a part of the window is reported, however long the window is") {
  Observations observations = healthy();
  observations.window_s = 60;
  for (int i = 0; i < 100; ++i) {
    observations.beacons.front().status_counts.add(i < 2 ? status_frozen_track | status_initialising : 0U);
  }
  const auto findings = diagnose(observations);
  CHECK(found(findings, "repeat one position although the IMU measures motion (1.2 of 60 s)").severity ==
        Severity::warning);
  CHECK(found(findings, "initialising").severity == Severity::ok);  // it is over
}

TEST_CASE("A frozen track does not hide a silence of the fixes at another time") {
  Observations observations = healthy();
  observations.window_s = 60;
  for (int second = 0; second < 60; ++second) {
    const bool is_frozen = second < 3;
    const bool is_stale = second >= 20 && second < 26;
    observations.beacons.front().status_counts.add(is_frozen  ? std::uint32_t{status_frozen_track}
                                                   : is_stale ? std::uint32_t{status_stale}
                                                              : 0U);
  }
  const auto findings = diagnose(observations);
  CHECK(found(findings, "repeat one position although the IMU measures motion (3.0 of 60 s)").severity ==
        Severity::warning);
  CHECK(found(findings, "no valid fix for longer than outage.stale_after_s (6.0 of 60 s)").severity ==
        Severity::warning);
}

TEST_CASE("Fixes that the hardware flags as unavailable have a specific remedy") {
  const auto findings = findings_with([](auto& b) {
    b.fix = {};
    b.status->fixes_unavailable = 30;
  });
  CHECK_THAT(found(findings, "not available").remedy, Contains("stationary beacons"));
}

TEST_CASE("Two bridges of one beacon are reported, without gaps in their numbering") {
  const auto findings = findings_with([](auto& b) {
    b.bridges.push_back({"sonopose-bridge", "rover", 200});
    b.events_missing = 900;
    b.events_expected = 1800;
  });
  CHECK(found(findings,
              "2 bridges publish it: sonopose-bridge (process 100 on rover), sonopose-bridge (process 200")
            .severity == Severity::error);
  CHECK(found(findings, "not received").severity == Severity::ok);
  CHECK(severity("its bridge detects another bridge", [](auto& b) { b.status->other_bridges = 1; }) ==
        Severity::error);
}

TEST_CASE("Lost events are a consequence of a second bridge, and not reported beside it") {
  const auto lose_events = [](auto& b) {
    b.status->other_bridges = 1;
    b.fusion->events_lost = 300;
    b.events_missing = 300;
    b.events_expected = 1000;
  };
  CHECK(severity("its bridge detects another bridge", lose_events) == Severity::error);
  CHECK(severity("its fusion lost", lose_events) == Severity::ok);
  CHECK(severity("not received", lose_events) == Severity::ok);
}

TEST_CASE("Fixes far from the height of a planar body are a problem with a remedy") {
  CHECK(severity("the fixes are 1.50 m above motion.height_m", [](auto& b) {
          b.height_problem = estimation::aiding::HeightProblem{"the fixes are 1.50 m above motion.height_m",
                                                               "set motion.height_m=1.50"};
        }) == Severity::warning);
}

TEST_CASE("Only increases of counters are reported") {
  CHECK(severity("5 checksum errors and 80 lost bytes", [](auto& b) {
          b.status->crc_errors = 5;
          b.status->bytes_lost = 80;
        }) == Severity::warning);
  CHECK(severity("checksum errors", [](auto& b) {
          b.status_before->crc_errors = 5;
          b.status->crc_errors = 5;
        }) == Severity::ok);
  CHECK(severity("checksum errors", [](auto& b) {  // the bridge restarted
          b.status_before->crc_errors = 50;
          b.status->crc_errors = 5;
        }) == Severity::ok);
  CHECK(severity("its fusion lost 30 events", [](auto& b) { b.fusion->events_lost = 30; }) ==
        Severity::warning);
  CHECK(severity("its fusion lost 2 events", [](auto& b) { b.fusion->events_lost = 2; }) == Severity::note);
  CHECK(severity("its fusion lost 30 events", [](auto& b) {  // most of them before it crashed and returned
          b.fusion->events_lost = 2;
          b.ended_fusions.push_back({*b.fusion_before, *b.fusion});
          b.ended_fusions.front().latest.events_lost = 28;
        }) == Severity::warning);
  CHECK(severity("its fusion rejected 20 samples: not finite, out of range, out of order, or too late",
                 [](auto& b) { b.fusion->samples_invalid = 20; }) == Severity::warning);
  CHECK(severity("its fusion rejected 2 samples", [](auto& b) { b.fusion->samples_invalid = 2; }) ==
        Severity::note);
  CHECK(severity("2 of its samples have impossible values",
                 [](auto& b) { b.status->samples_rejected = 2; }) == Severity::warning);
  CHECK(severity("1 of its samples has impossible values", [](auto& b) { b.status->samples_rejected = 1; }) ==
        Severity::warning);
  const auto relayed = [](auto& b) {
    b.bridges.front().name = "sonopose-ros2";
    b.status->samples_rejected = 253;
  };
  CHECK(severity("253 messages of its ROS 2 drivers are not used", relayed) == Severity::warning);
  CHECK(severity("impossible values", relayed) == Severity::ok);
  CHECK(severity("its clock was reset 1 time:", [](auto& b) { b.status->clock_resets = 1; }) ==
        Severity::warning);
}

TEST_CASE("Missing events are compared with those of the same time") {
  const auto missing = [](std::uint64_t count) {
    return severity("events were not received", [count](auto& b) {
      b.imu.samples = 360'000;  // during an hour
      b.events_missing = count;
      b.events_expected = 12'000;  // during the last two minutes
    });
  };
  CHECK(missing(119) == Severity::note);
  CHECK(missing(121) == Severity::warning);
}

/// Numbers of refused fixes by cause.
FixOutcomes outcomes_of(std::uint64_t reports,
                        std::initializer_list<std::pair<FixRefusal, std::uint64_t>> refused) {
  FixOutcomes outcomes{.reports = reports, .outliers_m = {}};
  for (const auto& [cause, count] : refused) outcomes.refused.at(static_cast<std::size_t>(cause)) = count;
  return outcomes;
}

TEST_CASE("Refused fixes are reported by their share") {
  const auto refused = [](std::uint64_t count) {
    return severity("refuses " + std::to_string(count) + " of its 100 fixes", [&](auto& b) {
      b.fix_outcomes = outcomes_of(100, {{FixRefusal::too_old, count}});
    });
  };
  CHECK(refused(100) == Severity::warning);
  CHECK(refused(60) == Severity::warning);
  CHECK(refused(20) == Severity::note);
  CHECK(refused(5) == Severity::ok);
}

TEST_CASE("The causes of refused fixes are named with their remedies, the most frequent one first") {
  const auto finding = [](const FixOutcomes& outcomes) {
    return found(findings_with([&](auto& b) {
                   b.fix_outcomes = outcomes;
                   b.fusion_settings.admission.min_quality_percent = 80;
                 }),
                 "its fusion refuses");
  };
  const Finding poor = finding(outcomes_of(170, {{FixRefusal::low_quality, 54}}));
  CHECK(poor.what ==
        "its fusion refuses 54 of its 170 fixes: 54 of a quality below admission.min_quality_percent");
  CHECK_THAT(poor.remedy, Contains("line of sight") && Contains("admission.min_quality_percent") &&
                              !Contains("clock") && !Contains("stamps"));
  const Finding old = finding(outcomes_of(100, {{FixRefusal::too_old, 98}, {FixRefusal::low_quality, 2}}));
  CHECK_THAT(old.what,
             Contains("98 too old") && Contains(", 2 of a quality below admission.min_quality_percent"));
  CHECK_THAT(old.remedy, Contains("one clock") && !Contains("quality"));
  CHECK_THAT(finding(outcomes_of(100, {{FixRefusal::too_new, 30}})).remedy, Contains("one clock"));
  CHECK_THAT(finding(outcomes_of(100, {{FixRefusal::invalid, 30}})).remedy,
             Contains("admission.max_position_m") && !Contains("clock"));
  const Finding both = finding(outcomes_of(100, {{FixRefusal::low_quality, 30}, {FixRefusal::too_old, 20}}));
  CHECK_THAT(both.remedy, Contains("line of sight") && Contains("one clock"));
}

TEST_CASE("Fixes that are refused for want of an IMU are not reported twice") {
  CHECK(severity("refuses", [](auto& b) {
          b.imu = {};
          b.fix_outcomes = outcomes_of(100, {{FixRefusal::no_imu, 100}});
        }) == Severity::ok);
}

TEST_CASE("The clock of a beacon is shown as what it is") {
  const auto rates = [](double offset_s) {
    return found(findings_with([&](auto& b) {
                   b.status->time_ns = 1'795'793'274'053'000'000;  // in November 2026
                   b.status->clock_offset_s = offset_s;
                 }),
                 "IMU 100.0 Hz")
        .what;
  };
  CHECK_THAT(rates(0.033), Contains("clock offset 0.033 s, jitter"));
  CHECK_THAT(rates(0.7), !Contains("0.7"));  // all is well does not belong beside it
  CHECK_THAT(rates(1795793154.053), Contains("its clock is not set: it counts from its start, 2.0 min ago") &&
                                        !Contains("1795793154"));
  CHECK_THAT(rates(3 * 3600.0), Contains("its clock is 3.0 h behind"));
  CHECK_THAT(rates(-86400.0 * 400), Contains("its clock is 400.0 d ahead"));
}

TEST_CASE("Readers and writers of IMU samples that are no fusion do not hide the faults of the beacons") {
  Observations observations = healthy();
  observations.beacons.front().pose = {};
  const EndpointObservation other_type = endpoint("sonopose/imu", "other::Imu", "consumer");
  SECTION("a foreign reader of another type") {
    observations.readers.push_back(other_type);
    CHECK(found(diagnose(observations), "reads it as type other::Imu").severity == Severity::error);
    CHECK(found(diagnose(observations), "no poses of this beacon").severity == Severity::error);
  }
  SECTION("the fusion itself: the missing poses are a consequence") {
    observations.readers.front().type = "other::Imu";
    CHECK(found(diagnose(observations), "reads it as type other::Imu").severity == Severity::error);
    CHECK(found(diagnose(observations), "no poses of this beacon").severity == Severity::ok);
  }
  SECTION("one of two fusions") {
    observations.writers.push_back(endpoint("sonopose/pose", "sonopose::FusedPose", "standby", exclusive(1)));
    observations.readers.push_back(endpoint("sonopose/imu", "other::Imu", "standby"));
    CHECK(found(diagnose(observations), "no poses of this beacon").severity == Severity::error);
  }
}

TEST_CASE("A nearly empty battery is reported, an unknown voltage is not") {
  CHECK(severity("battery is at 3.45 V", [](auto& b) { b.status->battery_v = 3.45; }) == Severity::warning);
  CHECK(severity("battery", [](auto& b) { b.status->battery_v = 3.6; }) == Severity::ok);
  CHECK(severity("battery", [](auto& b) { b.status->battery_v = std::nullopt; }) == Severity::ok);
}

TEST_CASE("Clocks: offset of another machine, and jitter") {
  const auto other_host = [](double ahead_s) {
    return [ahead_s](auto& b) {
      b.bridges.front().host = "lander";
      b.bridge_ahead_s = ahead_s;
    };
  };
  CHECK(severity("300 ms ahead of the clock of this machine", other_host(0.3)) == Severity::warning);
  CHECK(severity("300 ms behind the clock of this machine", other_host(-0.3)) == Severity::warning);
  CHECK(severity("of this machine", other_host(-0.005)) == Severity::ok);
  CHECK(severity("300 ms ahead of the clock", [](auto& b) { b.bridge_ahead_s = 0.3; }) == Severity::warning);
  CHECK(severity("300 ms to arrive", [](auto& b) { b.bridge_ahead_s = -0.3; }) == Severity::warning);
  CHECK(severity("jitter of 80 ms", [](auto& b) { b.status->clock_jitter_s = 0.08; }) == Severity::warning);
}

TEST_CASE("Velocities that are not used, or mostly rejected, are a problem") {
  CHECK(severity("its velocities are not used: they are newer than the IMU samples",
                 [](auto& b) { b.fusion->velocities_unused = 150; }) == Severity::warning);
  CHECK(severity("its velocities contradict the estimate, as when wheels slip: 90 of 150 are rejected",
                 [](auto& b) {
                   b.fusion->velocities_used = 60;
                   b.fusion->velocities_rejected = 90;
                 }) == Severity::warning);
  CHECK(severity("velocities", [](auto& b) {
          b.fusion->velocities_used = 150;
          b.fusion->velocities_unused = 30;
        }) == Severity::ok);
}

TEST_CASE("Velocities in another unit are no slip of wheels") {
  const auto in_mm = [](auto& b) {
    b.velocity_fault = "the velocities are 990 times the speed of the fixes (median); are they in mm s^-1?";
    b.fusion->velocities_rejected = 90;
  };
  CHECK(severity("990 times the speed of the fixes", in_mm) == Severity::error);
  CHECK(severity("as when wheels slip", in_mm) == Severity::ok);
}

TEST_CASE("Status bits of the poses in the window are reported") {
  struct Case {
    std::uint32_t bits;
    const char* text;
    Severity severity;
  };
  for (const Case& c :
       {Case{status_uncalibrated, "not at rest for long enough", Severity::warning},
        Case{status_stale, "no valid fix for longer", Severity::warning},
        Case{status_heading_unknown, "heading is unknown", Severity::warning},
        Case{status_frozen_track, "repeat one position", Severity::warning},
        Case{status_low_trust, "low trust in the fixes", Severity::warning},
        Case{status_overloaded, "overloaded and skips poses", Severity::warning},
        Case{status_late, "old on arrival", Severity::warning},
        Case{status_late | status_overloaded, "old on arrival", Severity::ok},  // a consequence
        Case{status_imu_gap, "stream has gaps", Severity::warning},
        Case{status_initialising, "is initialising", Severity::warning},
        Case{status_rotating_fast | status_converging | status_predicted, "", Severity::ok}}) {
    CAPTURE(c.text);
    CHECK(severity(c.text, [&](auto& b) { b.status_counts.add(c.bits); }) == c.severity);
  }
  SECTION("for a single beacon, an unknown heading is a note") {
    CHECK(severity("heading is unknown", [](auto& b) {
            b.status_counts.add(status_heading_unknown);
            b.heading = {};
          }) == Severity::note);
  }
  SECTION("a stale pose is a consequence of two bridges, but not of scattered outliers") {
    const auto stale = [](auto& b) { b.status_counts.add(status_stale); };
    CHECK(severity("no valid fix for longer", [&](auto& b) {
            stale(b);
            b.bridges.push_back({"sonopose-bridge", "rover", 200});
          }) == Severity::ok);
    CHECK(severity("no valid fix for longer", [&](auto& b) {
            stale(b);
            b.fix_outcomes.reports = 60;
            for (int i = 0; i < 12; ++i) b.fix_outcomes.outliers_m.emplace_back(std::cos(i), std::sin(i), 0);
          }) == Severity::warning);
  }
  SECTION("during initialisation, other bits are not reported") {
    CHECK(severity("no valid fix for longer",
                   [](auto& b) { b.status_counts.add(status_initialising | status_stale); }) == Severity::ok);
  }
}

TEST_CASE(
    "At rest, specific force along another axis than +z is a wrong mount, and the remedy names the setting") {
  const auto finding = [](const Vector3d& force) {
    return found(findings_with([&](auto& b) { b.rest->mean_force_body_mps2 = force; }),
                 "specific force is along");
  };
  CHECK(finding({0, 0, 9.8}).severity == Severity::ok);
  CHECK(finding({0, 0, -9.8}).severity == Severity::warning);
  CHECK_THAT(finding({0, 0, -9.8}).what, Contains("along -z of the body"));
  CHECK_THAT(finding({0, 9.8, 0}).what, Contains("along +y of the body"));
  // Body Z must be the sensor axis that points up; X can remain.
  CHECK_THAT(finding({0, 9.8, 0}).remedy, Contains("calibration.axes=+x-z+y;"));
  CHECK_THAT(finding({-9.8, 0, 0}).remedy, Contains("-x;"));
}

TEST_CASE(
    "A mount that the settings describe is correct, and a wrong one is reported with the sensor's axis") {
  const auto axes_of = [](std::string_view name) {
    const auto choices = calibration::choices_of(calibration::Axes{});
    calibration::AxesSettings settings;
    settings.axes =
        static_cast<calibration::Axes>(std::find(choices.begin(), choices.end(), name) - choices.begin());
    return settings;
  };
  const auto findings = findings_with([&](auto& b) {
    b.rest->axes = axes_of("+y+z+x");  // body Y is the sensor's Z, which points up
    b.rest->mean_force_body_mps2 = {0, 9.8, 0};
  });
  CHECK_THAT(found(findings, "specific force is along").what, Contains("along +y of the body"));
  CHECK_THAT(found(findings, "specific force is along").remedy, Contains("+z;"));
}

TEST_CASE("The magnitude of gravity and the gyro bias are checked at rest") {
  CHECK(severity("reads 10.60 m/s² instead of 9.81", [](auto& b) {
          b.rest->mean_force_body_mps2 = {0, 0, 10.6};
        }) == Severity::warning);
  CHECK(severity("instead of 9.81", [](auto& b) {
          b.rest->mean_force_body_mps2 = {0, 0, 10.1};
        }) == Severity::ok);
  CHECK(severity("does not measure gravity", [](auto& b) {
          b.rest->mean_force_body_mps2 = {0, 0, 0};
        }) == Severity::error);
  CHECK(severity("its gyroscope reads", [](auto& b) {
          b.rest->mean_rate_body_radps = {0, 0.1, 0};
        }) == Severity::warning);
  CHECK(severity("tilted by 20°", [](auto& b) {
          b.rest->mean_force_body_mps2 = {3.35, 0, 9.2};
        }) == Severity::note);
}

}  // namespace beacon_test
