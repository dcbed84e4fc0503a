#include "doctor/probe/beacon_probe.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>

namespace beacon_probe_test {

using namespace sonopose;
using namespace sonopose::doctor::rules;
using namespace sonopose::doctor::probe;

constexpr TimeNs begin_ns = 1'000'000'000'000;
constexpr TimeNs period_ns = 10'000'000;
constexpr TimeNs window_ns = 3'000'000'000;

ImuSample imu(std::uint64_t sequence, TimeNs at_ns) {
  ImuSample sample;
  sample.sequence = sequence;
  sample.bridge_time_ns = at_ns;
  sample.specific_force_body_mps2 = {0, 0, 9.8};
  return sample;
}

/// A probe with an IMU sample every 10 ms of the window, except those for which `lost(sequence)`.
template <class Lost>
BeaconProbe fed(const Lost& lost) {
  BeaconProbe probe;
  probe.begin(begin_ns, {});
  std::uint64_t sequence = 1000;
  for (TimeNs at_ns = begin_ns; at_ns < begin_ns + window_ns; at_ns += period_ns) {
    ++sequence;
    if (!lost(sequence)) probe.on(imu(sequence, at_ns), at_ns + 1'000'000, 42);
  }
  return probe;
}

BeaconObservation observation_of(const BeaconProbe& probe) {
  return probe.observation(begin_ns + window_ns, {});
}

bool none(std::uint64_t /*sequence*/) {
  return false;
}

TEST_CASE("A stream's rate and longest silence are those of the window") {
  const BeaconObservation beacon = observation_of(fed([](std::uint64_t n) { return n > 1100 && n <= 1120; }));
  CHECK(beacon.imu.samples == 280);
  CHECK(beacon.imu.rate_hz == Approx(280 / 3.0));
  CHECK(beacon.imu.longest_silence_s == Approx(0.21));
  CHECK(beacon.fix.samples == 0);
  CHECK(beacon.fix.longest_silence_s == Approx(3.0));
}

TEST_CASE("A silence at the end of the window counts too") {
  CHECK(observation_of(fed([](std::uint64_t n) { return n > 1200; })).imu.longest_silence_s ==
        Approx(1.0).epsilon(0.02));
}

TEST_CASE("Silences longer than the deadline are counted, with their total") {
  BeaconProbe probe;
  probe.begin(begin_ns, {.pose_s = 0.1});
  // Poses for 0.75 s, then none for 0.25 s, four times.
  for (TimeNs at_ns = 0; at_ns < 4'000'000'000; at_ns += period_ns) {
    if (at_ns % 1'000'000'000 < 750'000'000) probe.on(FusedPose{}, begin_ns + at_ns);
  }
  const auto pose = probe.observation(begin_ns + 4'000'000'000, {}).pose;
  CHECK(pose.silences == 4);
  CHECK(pose.silent_s == Approx(4 * 0.26).epsilon(0.02));
  CHECK(pose.longest_silence_s == Approx(0.26));
}

TEST_CASE("The time in which the doctor does not run is no silence, and does not excuse another one") {
  constexpr TimeNs pause_ns = 900'000'000;
  BeaconProbe probe;
  probe.begin(begin_ns, {.imu_s = 0.1});
  const auto take = [&](TimeNs at_ns, TimeNs unwatched_ns) {
    const TimeNs now_ns = begin_ns + at_ns;
    probe.on(imu(1, now_ns), {now_ns, now_ns, unwatched_ns}, 1);
  };
  take(10'000'000, 0);
  take(10'000'000 + pause_ns, pause_ns);
  CHECK(probe.observation(begin_ns + 20'000'000 + pause_ns, {}).imu.silences == 0);
  take(10'000'000 + pause_ns + 500'000'000, 0);
  const auto imu = probe.observation(begin_ns + 600'000'000 + pause_ns, {}).imu;
  CHECK(imu.silences == 1);
  CHECK(imu.longest_silence_s == Approx(0.5));
}

TEST_CASE("A pair that is lost for a part of the window is observed") {
  const auto lost_s = [](const std::function<bool(double)>& is_valid) {
    BeaconProbe probe;
    probe.begin(begin_ns, {});
    for (double t = 0.05; t < 12; t += 0.1) {
      probe.on(UltrasonicFix{}, begin_ns + to_ns(t));
      PairHeading heading;
      heading.valid = is_valid(t);
      probe.on(heading, begin_ns + to_ns(t));
    }
    return probe.observation(begin_ns + to_ns(12), {}).pair_lost_s;
  };
  CHECK(lost_s([](double) { return true; }) == 0);
  CHECK(lost_s([](double t) { return std::fmod(t, 0.4) > 0.1; }) == 0);  // a quarter of the headings is lost
  CHECK(lost_s([](double t) { return t < 6; }) >= 4);                    // all are lost in the second half
  CHECK(lost_s([](double t) { return t > 3 && t < 7; }) > 0);
}

TEST_CASE("Velocities in another unit are observed beside the fixes") {
  const auto fault = [](double unit) {
    BeaconProbe probe;
    probe.begin(begin_ns, {});
    for (double t = 0.05; t < 12; t += 0.1) {
      UltrasonicFix fix;
      fix.emission_time_ns = begin_ns + to_ns(t);
      fix.received_time_ns = fix.emission_time_ns + to_ns(0.07);
      fix.position_world_m = {1.5 * t, 0, 0};
      probe.on(fix, fix.emission_time_ns);
      TwistSample twist;
      twist.emission_time_ns = fix.emission_time_ns;
      twist.axes = twist_velocity_x;
      twist.velocity_body_mps = {1.5 * unit, 0, 0};
      probe.on(twist, twist.emission_time_ns);
    }
    return probe.observation(begin_ns + to_ns(12), {}).velocity_fault.value_or("");
  };
  CHECK(fault(1.0).empty());
  CHECK_THAT(fault(1000.0), Catch::Contains("1e+03 times") && Catch::Contains("mm s^-1"));
  CHECK_THAT(fault(3.6), Catch::Contains("km h^-1"));
}

TEST_CASE("Outliers of a body that stands do not make its velocities wrong") {
  BeaconProbe probe;
  probe.begin(begin_ns, {});
  for (int i = 0; i < 400; ++i) {
    UltrasonicFix fix;
    fix.emission_time_ns = begin_ns + to_ns(0.1 * i);
    fix.received_time_ns = fix.emission_time_ns + to_ns(0.07);
    fix.position_world_m = {i % 60 == 30 ? 1.0 : 0.0, 0, 0};
    probe.on(fix, fix.received_time_ns);
    TwistSample twist;
    twist.emission_time_ns = fix.emission_time_ns;
    twist.axes = twist_velocity_x;
    probe.on(twist, twist.emission_time_ns);
  }
  CHECK_FALSE(probe.observation(begin_ns + to_ns(41), {}).velocity_fault);
}

TEST_CASE("Headings of the body, as of a compass, do not show a pair that could be lost") {
  BeaconProbe probe;
  probe.begin(begin_ns, {});
  for (double t = 0.05; t < 12; t += 0.1) {
    probe.on(UltrasonicFix{}, begin_ns + to_ns(t));
    probe.on(PairHeading{.valid = true, .flags = heading_flag_of_body}, begin_ns + to_ns(t));
  }
  const auto beacon = probe.observation(begin_ns + to_ns(12), {});
  CHECK(beacon.heading.samples == 120);
  CHECK(beacon.pair_headings == 0);
  CHECK(beacon.pair_lost_s == 0);
  WHEN("the user sets the pose") {
    BeaconProbe set;
    set.begin(begin_ns, {});
    set.on(PairHeading{.valid = true, .flags = heading_flag_of_body | heading_flag_set_pose}, begin_ns + 1);
    THEN("its heading is not one of a stream that then falls silent") {
      CHECK(set.observation(begin_ns + to_ns(12), {}).heading.samples == 0);
    }
  }
}

TEST_CASE("Two tags of a body at rest are no motion") {
  BeaconProbe probe = fed(none);
  for (TimeNs at_ns = begin_ns; at_ns < begin_ns + window_ns; at_ns += 10 * period_ns) {
    UltrasonicFix fix;
    fix.sequence = unnumbered;
    fix.point_body_m.y() = (at_ns - begin_ns) % (20 * period_ns) == 0 ? 0.3 : -0.3;
    fix.position_world_m = fix.point_body_m;
    probe.on(fix, at_ns);
  }
  const BeaconObservation beacon = observation_of(probe);
  CHECK(beacon.fix.samples == 30);
  CHECK(beacon.rest);
}

TEST_CASE("Samples before the window are excluded") {
  BeaconProbe probe;
  for (std::uint64_t n = 1; n <= 100; ++n)
    probe.on(imu(n, begin_ns - 1'000'000'000), begin_ns - 1'000'000'000, 1);
  probe.begin(begin_ns, {});
  const BeaconObservation beacon = observation_of(probe);
  CHECK(beacon.imu.samples == 0);
  CHECK(probe.writers().empty());
  CHECK_FALSE(beacon.rest);
}

TEST_CASE("Missing sequence numbers are counted over all streams") {
  SECTION("no event is missing") {
    CHECK(observation_of(fed(none)).events_missing == 0);
  }
  SECTION("three events are missing") {
    CHECK(observation_of(fed([](std::uint64_t n) {
            return n == 1050 || n == 1051 || n == 1180;
          })).events_missing == 3);
  }
  SECTION("a fix fills a gap between IMU samples") {
    BeaconProbe probe = fed([](std::uint64_t n) { return n == 1050; });
    UltrasonicFix fix;
    fix.sequence = 1050;
    probe.on(fix, begin_ns + 600'000'000);
    CHECK(observation_of(probe).events_missing == 0);
  }
  SECTION("events that may still be in transit are not missing") {
    CHECK(observation_of(fed([](std::uint64_t n) { return n == 1299; })).events_missing == 0);
  }
  SECTION("a restarted bridge restarts its numbering") {
    BeaconProbe probe = fed(none);
    for (std::uint64_t n = 1; n < 50; ++n) probe.on(imu(n, begin_ns), begin_ns + 2'500'000'000, 43);
    CHECK(observation_of(probe).events_missing == 0);
  }
}

TEST_CASE("The clock offset of the bridge is a median") {
  BeaconProbe probe = fed(none);
  probe.on(imu(5000, begin_ns - 900'000'000'000), begin_ns, 42);  // an outlier
  CHECK(observation_of(probe).bridge_ahead_s.value() == Approx(-0.001).margin(1e-6));
}

TEST_CASE("A step of the host's clock during the look is no silence") {
  BeaconProbe probe;
  probe.begin(begin_ns, {.imu_s = 0.1});
  for (TimeNs at_ns = 0; at_ns < window_ns; at_ns += period_ns) {
    const HostTime host_ns = begin_ns + at_ns + (at_ns > window_ns / 2 ? 3'600'000'000'000 : 0);
    probe.on(imu(1 + static_cast<std::uint64_t>(at_ns / period_ns), host_ns), {begin_ns + at_ns, host_ns, 0},
             1);
  }
  const auto beacon = observation_of(probe);
  CHECK(beacon.imu.silences == 0);
  CHECK(beacon.imu.rate_hz == Approx(100.0));
  CHECK(beacon.bridge_ahead_s.value() == Approx(0.0).margin(1e-6));
}

TEST_CASE("The share of the poses with a status bit is that of the window") {
  BeaconProbe probe;
  FusedPose pose;
  pose.status = status_frozen_track;
  probe.on(pose, begin_ns - 1);  // before the window
  probe.begin(begin_ns, {});
  for (const std::uint32_t status : {status_stale | status_low_trust, status_stale | status_imu_gap}) {
    pose.status = status;
    probe.on(pose, begin_ns + 1);
  }
  const StatusCounts counts = observation_of(probe).status_counts;
  CHECK(counts.share_of(status_stale) == 1.0);
  CHECK(counts.share_of(status_low_trust) == 0.5);
  CHECK(counts.share_of(status_frozen_track) == 0.0);
  CHECK(BeaconProbe().observation(begin_ns, {}).status_counts.share_of(status_stale) == 0.0);
}

TEST_CASE("A frozen track explains that its poses are stale") {
  BeaconProbe probe;
  probe.begin(begin_ns, {});
  FusedPose pose;
  for (const std::uint32_t status : {status_frozen_track | status_stale, std::uint32_t{status_stale}}) {
    pose.status = status;
    probe.on(pose, begin_ns + 1);
  }
  const StatusCounts counts = observation_of(probe).status_counts;
  CHECK(counts.share_of(status_frozen_track) == 0.5);
  CHECK(counts.share_of(status_stale) == 0.5);
}

TEST_CASE("Innovations of outliers are kept, and those of used fixes are not") {
  BeaconProbe probe;
  probe.begin(begin_ns, {});
  FixReport report;
  report.innovation_world_m = {0.5, 0, 0};
  report.flags = fix_used;
  probe.on(report, begin_ns + 1);
  report.flags = fix_outlier;
  probe.on(report, begin_ns + 1);
  const FixOutcomes outcomes = observation_of(probe).fix_outcomes;
  CHECK(outcomes.reports == 2);
  REQUIRE(outcomes.outliers_m.size() == 1);
  CHECK(outcomes.outliers_m.front().x() == 0.5);
}

TEST_CASE("Outcomes of fixes are those of the last two minutes") {
  BeaconProbe probe;
  probe.begin(begin_ns, {});
  for (int s = 0; s < 600; ++s) {
    FixReport report;
    report.applied_time_ns = begin_ns;
    report.flags = s % 2 == 0 ? fix_outlier : fix_too_late;
    probe.on(report, begin_ns + s * TimeNs{1'000'000'000});
  }
  const FixOutcomes outcomes = observation_of(probe).fix_outcomes;
  CHECK(outcomes.reports == 121);
  const std::uint64_t too_old = outcomes.refused.at(static_cast<std::size_t>(FixRefusal::too_old));
  CHECK(outcomes.outliers_m.size() + too_old == outcomes.reports);
}

TEST_CASE("The calibration of the fusion is applied to the means") {
  const settings::Settings settings =
      settings_from({.address = 7,
                     .values = {{"calibration.axes", "+x-z+y"},
                                {"calibration.accelerometer.offset_z_mps2", "1.8"},
                                {"calibration.nothing_known", "3"},
                                {"documented.drift.jump_alpha", "nonsense"}}});
  const auto beacon = fed(none).observation(begin_ns + window_ns, settings);
  REQUIRE(beacon.rest);
  // (0, 0, 9.8) minus the offset is 8 on the sensor's Z, which is body -Y.
  CHECK(beacon.rest->mean_force_body_mps2.isApprox(Vector3d(0, -8.0, 0), 1e-9));
}

TEST_CASE("A fusion that has ended does not hide the one that runs") {
  BeaconProbe probe;
  probe.begin(begin_ns, {});
  FusionStatus status;
  for (std::uint64_t id = 1; id <= 1000; ++id) {  // each has a lower strength than its predecessor
    status.fusion_id = id;
    status.strength = static_cast<std::int32_t>(2000 - id);
    status.fixes_used = id;
    probe.on(status);
    if (id < 1000) probe.end_fusion(id);
  }
  const auto beacon = probe.observation(begin_ns + window_ns, {});
  REQUIRE(beacon.fusions.size() == 1);
  REQUIRE(beacon.fusion);
  CHECK(beacon.fusion->fixes_used == 1000);
}

TEST_CASE("The losses of a fusion that has crashed and returned are not hidden") {
  BeaconProbe probe;
  probe.begin(begin_ns, {});
  const auto report = [&probe](std::uint64_t id, std::uint64_t lost) {
    FusionStatus status;
    status.fusion_id = id;
    status.events_lost = lost;
    probe.on(status);
  };
  report(1, 5);
  report(1, 45);
  probe.end_fusion(1);
  SECTION("with a new id") {
    report(2, 0);
    const auto beacon = observation_of(probe);
    REQUIRE(beacon.fusions.size() == 1);
    CHECK(beacon.fusion->fusion_id == 2);
    REQUIRE(beacon.ended_fusions.size() == 1);
    CHECK(beacon.ended_fusions.front().before.events_lost == 5);
    CHECK(beacon.ended_fusions.front().latest.events_lost == 45);
  }
  SECTION("as the same one, whose liveliness was lost for a while") {
    report(1, 46);
    const auto beacon = observation_of(probe);
    CHECK(beacon.ended_fusions.empty());
    CHECK(beacon.fusion_before->events_lost == 5);
    CHECK(beacon.fusion->events_lost == 46);
  }
}

TEST_CASE("The losses of a standby that has ended are not those of a consumer") {
  BeaconProbe probe;
  probe.begin(begin_ns, {});
  const auto report = [&probe](std::uint64_t id, std::int32_t strength, TimeNs time_ns) {
    FusionStatus status;
    status.fusion_id = id;
    status.role = FusionRole::serving;
    status.strength = strength;
    status.time_ns = time_ns;
    status.events_lost = static_cast<std::uint64_t>(time_ns);
    probe.on(status);
  };
  report(1, 200, 1);
  report(2, 100, 2);
  report(1, 200, 3);
  report(2, 100, 4);
  SECTION("while the stronger fusion serves on") {
    probe.end_fusion(2);
    report(1, 200, 5);
    CHECK(observation_of(probe).ended_fusions.empty());
  }
  SECTION("but those of the stronger one are") {
    probe.end_fusion(1);
    report(2, 100, 5);
    REQUIRE(observation_of(probe).ended_fusions.size() == 1);
    CHECK(observation_of(probe).ended_fusions.front().latest.fusion_id == 1);
  }
  SECTION("and so are those of a fusion that a stronger one has replaced") {
    probe.end_fusion(1);
    probe.end_fusion(2);
    report(3, 300, 9);
    const auto ended = observation_of(probe).ended_fusions;
    CHECK(ended.size() == 2);
  }
}

TEST_CASE("A jump to other fixes counts once, and one after a freeze does not") {
  BeaconProbe probe;
  probe.begin(begin_ns, {});
  double at_s = 1;
  const auto report = [&](std::uint32_t flags, double jump_m) {
    FixReport fix;
    fix.flags = flags;
    fix.jump_world_m = {jump_m, 0, 0};
    probe.on(fix, begin_ns + to_ns(at_s));
    at_s += 0.1;
  };
  const auto jump = [&] {  // 0.8 m in steps of less than 0.3 m
    for (int i = 0; i < 4; ++i) report(fix_used | fix_stuck_forced, 0.2);
    report(fix_used, 0);
  };
  for (int i = 0; i < 4; ++i) report(fix_used | fix_stuck_forced, i % 2 == 0 ? 0.2 : -0.2);  // noise
  report(fix_used, 0);
  CHECK(observation_of(probe).fix_outcomes.relocations == 0);
  jump();
  jump();
  CHECK(observation_of(probe).fix_outcomes.relocations == 2);
  CHECK(observation_of(probe).fix_outcomes.longest_relocation_m == Approx(0.8));
  report(fix_frozen, 0);
  jump();
  CHECK(observation_of(probe).fix_outcomes.relocations == 2);
  at_s += 30;
  jump();
  CHECK(observation_of(probe).fix_outcomes.relocations == 3);
}

TEST_CASE("A look of an hour keeps the samples of two minutes, and counts all") {
  BeaconProbe probe;
  probe.begin(begin_ns, {});
  constexpr std::uint64_t samples = 360'000;  // 100 Hz
  for (std::uint64_t n = 1; n <= samples; ++n) {
    if (n % 1000 == 0) continue;  // one lost sample every ten seconds
    const TimeNs at_ns = begin_ns + static_cast<TimeNs>(n) * period_ns;
    probe.on(imu(n, at_ns), at_ns + 1'000'000, 42);
  }
  const auto hour = probe.observation(begin_ns + static_cast<TimeNs>(samples) * period_ns, {});
  CHECK(hour.imu.samples == samples - samples / 1000);
  CHECK(hour.imu.rate_hz == Approx(99.9).epsilon(1e-3));
  CHECK(hour.events_missing >= 11);  // those of the last two minutes
  CHECK(hour.events_missing <= 12);
  CHECK(hour.events_expected == Approx(12'000).epsilon(0.01));
}

TEST_CASE("What was received is kept for two minutes") {
  Latest<int> latest;
  for (int s = 0; s <= 3600; ++s) latest.add(begin_ns + s * TimeNs{1'000'000'000}, s);
  CHECK(latest.has_dropped());
  CHECK(latest.entries().size() == 121);
  CHECK(latest.entries().front().value == 3480);
}

}  // namespace beacon_probe_test
