/// Guarantees of every estimator (estimator.hpp), checked for each of them and for AnyEstimator.

#include "support/allocations.hpp"
#include "support/bits.hpp"
#include "support/engine_driver.hpp"
#include "support/events.hpp"
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/estimation/snapshot_fields.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>
#include <optional>
#include <tuple>
#include <variant>
#include <vector>

namespace estimator_test {

using namespace sonopose;
using namespace sonopose::estimation;

settings::Settings with(settings::Settings settings, settings::EngineKind engine) {
  settings.engine.engine = engine;
  return settings;
}

struct AnyDocumented : AnyEstimator {
  explicit AnyDocumented(const settings::Settings& settings)
      : AnyEstimator(with(settings, settings::EngineKind::documented)) {}
};

struct AnyKalman : AnyEstimator {
  explicit AnyKalman(const settings::Settings& settings)
      : AnyEstimator(with(settings, settings::EngineKind::kalman)) {}
};

constexpr double speed_mps = 1.5;

/// A body that departs into a curve.
test::Truth drive(double time_s) {
  return test::departure(speed_mps, 0.3)(time_s);
}

/// Measurements of that drive: IMU at 100 Hz, fixes and headings at 12.5 Hz.
std::vector<Event> events(double duration_s) {
  std::vector<Event> events;
  std::uint64_t sequence = 0;
  for (int k = 0; k < static_cast<int>(duration_s * 100.0); ++k) {
    const double time_s = 0.01 * k;
    const test::Truth truth = drive(time_s);
    const TimeNs now_ns = test::epoch_ns + to_ns(time_s);
    ImuSample imu = test::imu_on(truth, now_ns);
    imu.sequence = ++sequence;
    events.emplace_back(imu);
    if (k % 8 != 7) continue;
    UltrasonicFix fix;
    fix.address = 7;
    fix.sequence = ++sequence;
    fix.emission_time_ns = now_ns - to_ns(0.068);
    fix.received_time_ns = now_ns;
    fix.position_world_m = drive(time_s - 0.068).position_world_m;
    fix.measured_delay_s = 0.068;
    events.emplace_back(fix);
    events.emplace_back(
        PairHeading{7, ++sequence, fix.emission_time_ns, now_ns, drive(time_s - 0.068).yaw_rad, true});
  }
  return events;
}

struct Run {
  std::vector<FusedPose> poses;
  std::vector<FixReport> reports;
};

template <class T>
Run run(T& estimator, const std::vector<Event>& events, std::size_t from = 0) {
  Run run;
  for (std::size_t i = from; i < events.size(); ++i) {
    const EventResult output = process(estimator, events[i]);
    if (const auto* pose = std::get_if<FusedPose>(&output)) run.poses.push_back(*pose);
    if (const auto* report = std::get_if<FixReport>(&output)) run.reports.push_back(*report);
  }
  return run;
}

template <class Sample>
bool same_bits(const std::vector<Sample>& a, const std::vector<Sample>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Sample& x, const Sample& y) { return test::bits_of(x) == test::bits_of(y); });
}

bool is_finite(const FusedPose& pose) {
  return pose.position_world_m.allFinite() && pose.velocity_world_mps.allFinite() &&
         std::abs(pose.q_body_to_world.norm() - 1.0) < 1e-9 && pose.angular_velocity_body_radps.allFinite() &&
         pose.acceleration_world_mps2.allFinite();
}

using AllEstimators = std::tuple<documented::Engine, kalman::Engine, AnyDocumented, AnyKalman>;

TEMPLATE_LIST_TEST_CASE("the same events and settings give the same bits", "", AllEstimators) {
  const auto log = events(6.0);
  TestType one{settings::Settings{}};
  TestType two{settings::Settings{}};
  const Run first = run(one, log);
  const Run second = run(two, log);
  CHECK(first.poses.size() == 600);
  CHECK(first.reports.size() == 75);
  CHECK(same_bits(first.poses, second.poses));
  CHECK(same_bits(first.reports, second.reports));
  CHECK(one.snapshot() == two.snapshot());
  CHECK(one.counters() == two.counters());
  CHECK(one.counters().imu_samples == 600);
  CHECK(one.time_ns() == first.poses.back().time_ns);
}

TEMPLATE_LIST_TEST_CASE("a copy and an estimator restored from a snapshot continue with the same bits", "",
                        AllEstimators) {
  const auto log = events(8.0);
  const std::size_t half = log.size() / 2;
  TestType whole{settings::Settings{}};
  const Run expected = run(whole, log);
  TestType first{settings::Settings{}};
  run(first, {log.begin(), log.begin() + static_cast<std::ptrdiff_t>(half)});
  TestType second{settings::Settings{}};
  CHECK_FALSE(second.snapshot() == first.snapshot());
  second.restore(first.snapshot());
  TestType copy = first;
  run(copy, log, half);
  CHECK(copy.snapshot() == whole.snapshot());
  const Run rest = run(second, log, half);
  REQUIRE(rest.poses.size() < expected.poses.size());
  CHECK(same_bits(rest.poses, {expected.poses.end() - static_cast<std::ptrdiff_t>(rest.poses.size()),
                               expected.poses.end()}));
  CHECK(second.snapshot() == whole.snapshot());
  CHECK(second.counters() == whole.counters());
}

/// Shifts every third fix by 3 m, delivers its predecessor after it, and then adds a fix that is refused.
std::vector<Event> with_late_and_refused(const std::vector<Event>& log) {
  std::vector<Event> changed;
  std::optional<UltrasonicFix> held_back;
  int fixes = 0;
  for (const Event& event : log) {
    const auto* fix = std::get_if<UltrasonicFix>(&event);
    if (fix != nullptr) ++fixes;
    if (fix != nullptr && fixes % 3 == 1) {
      held_back = *fix;
    } else if (fix != nullptr && fixes % 3 == 2 && held_back) {
      UltrasonicFix off = *fix;
      off.position_world_m.x() += 3.0;
      changed.emplace_back(off);
      held_back->received_time_ns = fix->received_time_ns;
      held_back->measured_delay_s = seconds_between(held_back->emission_time_ns, fix->received_time_ns);
      changed.emplace_back(*held_back);
      off.position_world_m.x() = std::numeric_limits<double>::quiet_NaN();
      changed.emplace_back(off);
    } else {
      changed.push_back(event);
    }
  }
  return changed;
}

TEMPLATE_LIST_TEST_CASE("catching up at any time changes no result", "", AllEstimators) {
  const auto log = with_late_and_refused(events(8.0));
  TestType never{settings::Settings{}};
  const Run expected = run(never, log);
  for (const std::size_t every : {1U, 3U, 7U}) {
    TestType estimator{settings::Settings{}};
    Run caught_up;
    for (std::size_t i = 0; i < log.size(); ++i) {
      const EventResult output = process(estimator, log[i]);
      if (const auto* pose = std::get_if<FusedPose>(&output)) caught_up.poses.push_back(*pose);
      if (const auto* report = std::get_if<FixReport>(&output)) caught_up.reports.push_back(*report);
      if (i % every == 0) estimator.finish_pending_work();
    }
    CHECK(same_bits(caught_up.poses, expected.poses));
    CHECK(same_bits(caught_up.reports, expected.reports));
    CHECK(estimator.snapshot() == never.snapshot());
    never.finish_pending_work();
    CHECK(estimator.snapshot() == never.snapshot());
  }
}

TEMPLATE_LIST_TEST_CASE("samples that are not finite are counted and never reach a pose", "", AllEstimators) {
  const double bad =
      GENERATE(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
               -std::numeric_limits<double>::infinity());
  TestType estimator{settings::Settings{}};
  std::uint64_t invalid = 0;
  std::size_t count = 0;
  std::size_t imu_count = 0;
  for (Event event : events(6.0)) {
    ++count;
    if (auto* imu = std::get_if<ImuSample>(&event); imu != nullptr && ++imu_count % 20 == 0) {
      (imu_count % 40 == 0 ? imu->specific_force_body_mps2 : imu->angular_velocity_body_radps).y() = bad;
      ++invalid;
    }
    if (auto* fix = std::get_if<UltrasonicFix>(&event); fix != nullptr && count % 3 == 0) {
      fix->position_world_m.z() = bad;
    }
    const EventResult output = process(estimator, event);
    if (const auto* pose = std::get_if<FusedPose>(&output)) REQUIRE(is_finite(*pose));
  }
  CHECK(invalid > 20);
  CHECK(estimator.counters().samples_invalid == invalid);
}

TEMPLATE_LIST_TEST_CASE("a stamp that goes backward is counted and gives no pose", "", AllEstimators) {
  TestType estimator{settings::Settings{}};
  const auto log = events(2.0);
  const Run before = run(estimator, log);
  ImuSample late = std::get<ImuSample>(log.front());
  CHECK_FALSE(estimator.predict(late));
  CHECK(estimator.counters().samples_invalid == 1);
  CHECK(estimator.time_ns() == before.poses.back().time_ns);
  late.sensor_time_ns = -1;
  CHECK_FALSE(estimator.predict(late));
  CHECK(estimator.counters().samples_invalid == 2);
}

/// Calls `change(index, sample)` for each IMU sample.
template <class Change>
void for_each_imu(std::vector<Event>& log, Change change) {
  std::size_t index = 0;
  for (auto* imu : test::each<ImuSample>(log)) change(index++, *imu);
}

/// Largest position error of the poses from `from_s` on.
double worst_error_m(const std::vector<FusedPose>& poses, double from_s) {
  double worst_m = 0.0;
  for (const FusedPose& pose : poses) {
    const double time_s = seconds_between(test::epoch_ns, pose.time_ns);
    if (time_s < from_s) continue;
    worst_m = std::max(worst_m, (pose.position_world_m - drive(time_s).position_world_m).norm());
  }
  return worst_m;
}

TEMPLATE_LIST_TEST_CASE("one corrupt stamp costs one sample", "", AllEstimators) {
  auto log = events(10.0);
  for_each_imu(log, [](std::size_t index, ImuSample& imu) {
    if (index == 500) imu.sensor_time_ns += to_ns(1000.0);
  });
  TestType estimator{settings::Settings{}};
  const Run all = run(estimator, log);
  CHECK(all.poses.size() == 999);
  CHECK(estimator.counters().samples_invalid == 1);
  CHECK(estimator.reset_counter() == 0);
  CHECK(worst_error_m(all.poses, 4.5) < 0.03);
}

TEMPLATE_LIST_TEST_CASE("samples without any specific force are counted and not integrated as a free fall",
                        "", AllEstimators) {
  auto log = events(10.0);
  for_each_imu(log, [](std::size_t index, ImuSample& imu) {
    if (index >= 700 && index < 719) imu.specific_force_body_mps2.setZero();  // too short for an IMU gap
  });
  TestType estimator{settings::Settings{}};
  const Run all = run(estimator, log);
  CHECK(estimator.counters().samples_invalid == 19);
  CHECK(worst_error_m(all.poses, 4.5) < 0.05);  // a free fall of 0.2 s drops by 0.2 m
}

TEMPLATE_LIST_TEST_CASE("samples that share a stamp are not duplicates", "", AllEstimators) {
  auto log = events(20.0);
  constexpr TimeNs coarse_ns = 20'000'000;
  for_each_imu(log, [](std::size_t, ImuSample& imu) {
    imu.sensor_time_ns -= (imu.sensor_time_ns - test::epoch_ns) % coarse_ns;
  });
  TestType estimator{settings::Settings{}};
  const Run all = run(estimator, log);
  CHECK(all.poses.size() == 2000);
  CHECK(estimator.counters().samples_invalid == 0);
  CHECK(estimator.counters().imu_gaps == 0);
  // Stamps are up to 10 ms early: 1.5 cm at this speed, on both the inertial path and the fixes.
  CHECK(worst_error_m({all.poses.back()}, 0.0) < 2.0 * 0.015);
  CHECK(all.poses.back().velocity_world_mps.norm() == Approx(speed_mps).epsilon(0.05));
}

TEMPLATE_LIST_TEST_CASE("a reset discards the state, keeps the counters and raises reset_counter", "",
                        AllEstimators) {
  TestType estimator{settings::Settings{}};
  const auto log = events(4.0);
  const Run first = run(estimator, log);
  CHECK(first.poses.back().reset_counter == 0);
  estimator.reset();
  CHECK(estimator.reset_counter() == 1);
  CHECK(estimator.time_ns() == 0);
  CHECK(estimator.counters().imu_samples == 400);
  const Run second = run(estimator, log);
  CHECK(second.poses.back().reset_counter == 1);
  for (std::size_t i = 0; i < first.poses.size(); ++i) {
    REQUIRE(second.poses[i].status == first.poses[i].status);
    REQUIRE(second.poses[i].position_world_m == first.poses[i].position_world_m);
    REQUIRE(second.poses[i].q_body_to_world.coeffs() == first.poses[i].q_body_to_world.coeffs());
  }
  CHECK(estimator.counters().imu_samples == 800);
}

TEMPLATE_LIST_TEST_CASE("settings are replaced without a change of the state", "", AllEstimators) {
  TestType estimator{settings::Settings{}};
  run(estimator, events(3.0));
  const auto before = estimator.snapshot();
  settings::Settings other = estimator.settings();
  other.admission.max_specific_force_mps2 = 30.0;
  estimator.configure(other);
  CHECK(estimator.settings().admission.max_specific_force_mps2 == 30.0);
  CHECK(estimator.snapshot() == before);
  ImuSample strong = test::imu_on(test::Truth{}, test::epoch_ns + to_ns(3.0));
  strong.specific_force_body_mps2.x() = 31.0;
  CHECK_FALSE(estimator.predict(strong));
}

TEMPLATE_LIST_TEST_CASE("a fix that is not used says so and names itself", "", AllEstimators) {
  TestType estimator{settings::Settings{}};
  UltrasonicFix fix;
  fix.address = 9;
  fix.sequence = 12;
  fix.emission_time_ns = 5;
  fix.position_world_m = {1, 2, 3};
  const FixReport report = estimator.correct(fix);  // before any IMU sample
  CHECK((report.flags & fix_used) == 0);
  CHECK(report.address == 9);
  CHECK(report.sequence == 12);
  CHECK(report.emission_time_ns == 5);
  CHECK(report.position_world_m == Vector3d(1, 2, 3));
  CHECK(estimator.counters().fixes_used == 0);
}

TEMPLATE_LIST_TEST_CASE("events do not allocate", "", AllEstimators) {
  const bool has_headings = GENERATE(true, false);
  const bool has_late_fixes = GENERATE(false, true);
  const bool has_silence = GENERATE(false, true);
  CAPTURE(has_headings, has_late_fixes, has_silence);
  std::vector<Event> log = events(12.0);
  if (!has_headings) {
    std::erase_if(log, [](const Event& event) { return std::holds_alternative<PairHeading>(event); });
  }
  if (has_late_fixes) log = with_late_and_refused(log);
  if (has_silence) log.erase(log.begin() + 600, log.begin() + 900);  // more than 2 s
  TestType estimator{settings::Settings{}};
  const std::size_t before = test::allocations();
  for (const Event& event : log) static_cast<void>(process(estimator, event));
  const settings::Settings same = estimator.settings();
  estimator.configure(same);
  estimator.reset();
  CHECK(test::allocations() == before);
}

TEST_CASE("AnyEstimator becomes the kind of the snapshot that it is restored from") {
  using settings::EngineKind;
  AnyKalman kalman{settings::Settings{}};
  run(kalman, events(2.0));
  AnyDocumented estimator{settings::Settings{}};
  CHECK(estimator.kind() == EngineKind::documented);
  estimator.restore(kalman.snapshot());
  CHECK(estimator.kind() == EngineKind::kalman);
  CHECK(kind_of(estimator.snapshot()) == EngineKind::kalman);
  CHECK(estimator.snapshot() == kalman.snapshot());
  for (const EngineKind kind : {EngineKind::documented, EngineKind::kalman}) {
    CHECK(kind_of(initial_snapshot(kind)) == kind);
  }
}

TEST_CASE("another engine in the settings starts the estimate again") {
  settings::Settings settings;
  settings.engine.engine = settings::EngineKind::documented;
  AnyEstimator estimator{settings};
  const auto log = events(4.0);
  run(estimator, log);
  settings.engine.engine = settings::EngineKind::kalman;
  estimator.configure(settings);
  CHECK(estimator.kind() == settings::EngineKind::kalman);
  CHECK(estimator.time_ns() == 0);
  CHECK(estimator.reset_counter() == 1);
  CHECK(estimator.counters().imu_samples == 400);
  AnyEstimator fresh{settings};
  const Run after = run(estimator, log);
  const Run expected = run(fresh, log);
  CHECK(after.poses.back().position_world_m == expected.poses.back().position_world_m);
  estimator.configure(settings);  // the same settings again
  CHECK(estimator.reset_counter() == 1);
}

}  // namespace estimator_test
