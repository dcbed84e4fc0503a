/// The rules, each tested with artificial histories that keep and break it.

#include "faults/history_checker.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

namespace history_checker_test {

using namespace sonopose;
using namespace sonopose::faults;
using Catch::Contains;

constexpr BeaconAddress beacon = 7;
constexpr TimeNs host_zero_ns = 1'700'000'000'000'000'000;  // host time at steady time 0
constexpr TimeNs ms = 1'000'000;
constexpr TimeNs period_ns = 5 * ms;

constexpr SteadyTime at(double time_s) {
  return {to_ns(time_s)};
}

/// Id of the process of the fusion with this strength.
constexpr ProcessId process_of(std::int32_t strength) {
  return static_cast<ProcessId>(strength);
}

/// The pose of the IMU sample that left the bridge at `sent`, received 0.5 ms later.
Arrival pose_at(SteadyTime sent, std::int32_t strength = 300) {
  Arrival pose;
  pose.received = sent + ms / 2;
  pose.received_host_ns = host_zero_ns + pose.received.ns;
  pose.process = process_of(strength);
  pose.writer = process_of(strength);
  pose.strength = strength;
  pose.address = beacon;
  pose.time_ns = host_zero_ns + sent.ns - ms;
  pose.bridge_time_ns = host_zero_ns + sent.ns;
  return pose;
}

Published imu_at(SteadyTime sent) {
  return {sent, beacon, static_cast<std::uint64_t>(sent.ns / period_ns), host_zero_ns + sent.ns};
}

FusionReport report_at(double time_s, std::int32_t strength, std::uint64_t events_lost = 0) {
  FusionReport report{at(time_s), process_of(strength), {}};
  report.status.address = beacon;
  report.status.strength = strength;
  report.status.role = FusionRole::serving;
  report.status.events_lost = events_lost;
  return report;
}

/// fusion-300 serves at 200 Hz from 5 s to 10 s, fusion-200 stands by; the line has garbage at 6 s.
History undisturbed() {
  History history;
  history.plan.fusions = 2;
  history.end = at(10);
  history.imu_period_ns = period_ns;
  for (SteadyTime sent = at(5); sent < at(10); sent += period_ns) {
    history.imu.push_back(imu_at(sent));
    history.poses.push_back(pose_at(sent));
  }
  history.statuses = {report_at(4.5, 300), report_at(4.5, 200), report_at(9.5, 300), report_at(9.5, 200)};
  history.episodes = {{{.fault = Fault::garbage}, {at(6), at(6.2)}}};
  history.lives = {{Role::bridge, {at(1)}}, {Role::first_fusion, {at(1)}}, {Role::second_fusion, {at(1)}}};
  return history;
}

void erase_poses(History& history, double from_s, double until_s) {
  std::erase_if(history.poses, [&](const Arrival& pose) {
    return pose.received >= at(from_s) && pose.received < at(until_s);
  });
}

void erase_imu(History& history, double from_s, double until_s) {
  std::erase_if(history.imu, [&](const Published& imu) {
    return imu.received >= at(from_s) && imu.received < at(until_s);
  });
}

/// Makes fusion-200 serve from `from_s` on.
void pass_on(History& history, double from_s) {
  for (Arrival& pose : history.poses) {
    if (pose.received >= at(from_s)) pose.process = pose.writer = process_of(pose.strength = 200);
  }
}

/// fusion-300 is killed at 7 s, the consumer learns it 100 ms later, and fusion-200 is received from
/// `until_s` on.
History takeover(double until_s) {
  History history = undisturbed();
  erase_poses(history, 7, until_s);
  pass_on(history, 7);
  history.losses.push_back({at(7.1), process_of(300)});
  history.lives[1].interval.until = at(7);
  history.episodes.push_back({{.fault = Fault::kill, .target = Role::first_fusion}, {at(7), at(7.3)}});
  return history;
}

/// The bridge is silent from 7 s to 7.3 s, then sends its backlog within 10 ms. Both fusions claim the beacon
/// simultaneously. fusion-200 is received until it is `ahead` samples ahead, then fusion-300.
History claim_after_silence(int ahead) {
  History history = undisturbed();
  erase_imu(history, 7, 7.315);
  erase_poses(history, 7, 7.315);
  std::vector<Arrival> backlog;
  const auto add = [&](int sample, std::int32_t strength) {
    Arrival pose = pose_at(at(7.3) + sample * ms / 6, strength);
    pose.received = at(7.3) + sample * ms / 6 + static_cast<TimeNs>(strength == 300 ? ahead : 0) * ms / 6;
    pose.time_ns = host_zero_ns + at(7).ns + sample * period_ns;
    backlog.push_back(pose);
  };
  for (int sample = 0; sample < 60; ++sample) {
    history.imu.push_back(imu_at(at(7.3) + sample * ms / 6));
    if (sample < ahead) add(sample, 200);
  }
  for (int sample = 0; sample < 60; ++sample) add(sample, 300);
  history.poses.insert(history.poses.end(), backlog.begin(), backlog.end());
  std::stable_sort(history.poses.begin(), history.poses.end(),
                   [](const Arrival& a, const Arrival& b) { return a.received < b.received; });
  std::stable_sort(history.imu.begin(), history.imu.end(),
                   [](const Published& a, const Published& b) { return a.received < b.received; });
  return history;
}

/// First pose received at or after `time_s`.
Arrival& pose_after(History& history, double time_s) {
  return *std::find_if(history.poses.begin(), history.poses.end(),
                       [&](const Arrival& pose) { return pose.received >= at(time_s); });
}

using Violations = std::vector<std::string>;
const Violations none;

Violations violations_of(const History& history) {
  return HistoryChecker(history).check().violations;
}

SCENARIO("a history that keeps every promise has no violations") {
  const Verdict verdict = HistoryChecker(undisturbed()).check();
  CHECK(verdict.violations == none);
  CHECK(verdict.owner_changes == 0);
  CHECK(verdict.missing_counted + verdict.missing_uncounted == 0);
  CHECK(verdict.longest_age_ns == ms / 2);
  CHECK(verdict.longest_silence_ns <= 0);  // each pose came when due
  CHECK(verdict.recovery_ns == 0);
}

SCENARIO("a run without any pose is no good run") {
  CHECK(violations_of(History{}).size() == 1);
}

SCENARIO("a beacon that was fed and never heard is a violation") {
  History history = undisturbed();
  history.beacons = {beacon};
  CHECK(violations_of(history) == none);
  history.beacons.push_back(beacon + 1);
  REQUIRE(violations_of(history).size() == 1);
  CHECK_THAT(violations_of(history).front(), Contains("beacon 8: not recovered"));
}

SCENARIO("late poses end no silence, and a fusion that continues sends one at most beside a warm one") {
  History history = undisturbed();
  const auto mark_late = [&history](double from_s, double until_s) {
    for (Arrival& pose : history.poses) {
      if (pose.received >= at(from_s) && pose.received < at(until_s)) pose.status = status_late;
    }
  };
  GIVEN("late poses for 0.3 s") {
    mark_late(7, 7.3);
    const Violations violations = violations_of(history);
    THEN("a promise is broken") {
      REQUIRE(violations.size() == 2);
      CHECK_THAT(violations[0] + violations[1],
                 Contains("late beside a warm fusion") && Contains("no pose for 300"));
    }
  }
  GIVEN("a single one") {
    mark_late(7, 7.004);
    THEN("no promise is broken") {
      CHECK(violations_of(history) == none);
    }
  }
  GIVEN("some that a busy machine kept waiting") {
    mark_late(7, 7.05);
    THEN("they are no violation if it waited shortly before") {
      CHECK_THAT(violations_of(history).at(0), Contains("late beside a warm fusion"));
      history.stalls = {{at(6.9), at(6.98)}};
      CHECK(violations_of(history) == none);
    }
  }
  GIVEN("a step of the bridge's clock, after which all are late") {
    history.episodes.push_back({{.fault = Fault::clock_step, .target = Role::bridge}, {at(6.5), at(6.5)}});
    mark_late(7, 7.3);
    THEN("no promise is broken") {
      CHECK(violations_of(history) == none);
    }
  }
}

SCENARIO("lost packets of the bridge excuse short silences, and no change of the owner by themselves") {
  History history = undisturbed();
  history.plan.loss = Loss{Role::bridge, 50};
  GIVEN("a silence that the requests for the lost packets explain") {
    erase_poses(history, 7, 7.15);
    for (FusionReport& report : history.statuses)
      report.status.samples_lost += report.received > at(7) ? 30U : 0U;
    THEN("no promise is broken") {
      CHECK(violations_of(history) == none);
    }
  }
  GIVEN("a longer one") {
    erase_poses(history, 7, 7.2);
    for (FusionReport& report : history.statuses)
      report.status.samples_lost += report.received > at(7) ? 40U : 0U;
    THEN("a promise is broken") {
      REQUIRE(violations_of(history).size() == 1);
      CHECK_THAT(violations_of(history).front(), Contains("beside a warm fusion"));
    }
  }
  GIVEN("a weaker fusion that is received for no other reason") {
    pass_on(history, 7);
    THEN("a promise is broken") {
      REQUIRE(violations_of(history).size() == 1);
      CHECK_THAT(violations_of(history).front(), Contains("although fusion-300 owns the beacon"));
    }
  }
  GIVEN("one that is received after a gap in the samples") {
    erase_imu(history, 6.95, 7);
    erase_poses(history, 6.95, 7);
    pass_on(history, 7);
    THEN("no promise is broken") {
      CHECK(violations_of(history) == none);
    }
  }
}

SCENARIO("poses whose samples the observer missed are few") {
  History history = undisturbed();
  erase_imu(history, 7, 7.0499);  // ten samples
  CHECK(violations_of(history) == none);
  erase_imu(history, 8, 8.0049);
  REQUIRE(violations_of(history).size() == 1);
  CHECK_THAT(violations_of(history).front(), Contains("samples of too many poses are unknown"));
}

SCENARIO("stamps rise") {
  GIVEN("a fusion whose stamp steps back, and one that repeats a stamp") {
    THEN("a promise is broken") {
      for (const TimeNs back_ns : {period_ns + ms, period_ns}) {
        History history = undisturbed();
        pose_after(history, 8).time_ns -= back_ns;
        CHECK(violations_of(history).size() == 1);
        CHECK_THAT(violations_of(history).front(), Contains("steps back"));
      }
    }
  }
  GIVEN("an engine that was initialised again") {
    History history = undisturbed();
    for (Arrival& pose : history.poses) {
      if (pose.received < at(8)) continue;
      pose.time_ns -= 20 * ms;
      pose.reset_counter = 1;
    }
    THEN("its time starts again") {
      CHECK(violations_of(history) == none);
    }
  }
  GIVEN("a fusion that is received with older samples while no fusion serves") {
    THEN("a step back is a violation beside a fusion with a strength of its own") {
      for (const std::int32_t strength : {0, 300}) {
        History history = undisturbed();
        history.lives.clear();
        for (Arrival& pose : history.poses) {
          if (pose.received < at(8)) pose.strength = strength;
        }
        pass_on(history, 8);
        for (Arrival& pose : history.poses) {
          if (pose.strength == 200) pose.received += 200 * ms;
        }
        for (Arrival& pose : history.poses) {
          if (pose.strength == 200) continue;
          pose.received += 190 * ms;
          pose.bridge_time_ns += 190 * ms;
          pose.time_ns += 190 * ms;
        }
        history.losses.push_back({at(8.2), process_of(300)});
        const auto violations = violations_of(history);
        const bool steps_back = std::any_of(
            violations.begin(), violations.end(),
            [](const std::string& text) { return text.find("steps back by 185.0 ms") != std::string::npos; });
        CHECK(steps_back == (strength == 300));
      }
    }
  }
  GIVEN("a stronger fusion that is 20 samples behind in a backlog of the bridge") {
    THEN("a step back among samples that the bridge sent at once is allowed") {
      CHECK(violations_of(claim_after_silence(20)) == none);
    }
  }
  GIVEN("a new owner that starts 60 ms ago, of samples that the bridge sent then") {
    History history = takeover(7.1);
    pose_after(history, 7).bridge_time_ns = pose_at(at(6.94)).bridge_time_ns;
    pose_after(history, 7).time_ns = pose_at(at(6.94)).time_ns;
    history.statuses[3].status.events_lost = 40;  // the samples until its next pose
    THEN("it is a step back") {
      const auto violations = violations_of(history);
      REQUIRE(violations.size() == 1);
      CHECK_THAT(violations.front(), Contains("steps back") && Contains("from fusion-300 to fusion-200"));
    }
  }
}

SCENARIO("no pose is older than declared, unless it is marked") {
  History history = undisturbed();
  erase_poses(history, 8, 8.31);  // keeps the rest in order
  Arrival old = pose_at(at(8));
  old.received = at(8.3051);
  history.poses.push_back(old);
  std::stable_sort(history.poses.begin(), history.poses.end(),
                   [](const Arrival& a, const Arrival& b) { return a.received < b.received; });
  history.lives.clear();  // disables the silence check
  history.statuses[2].status.events_lost = 70;
  CHECK_THAT(violations_of(history).front(), Contains("305.1 ms old"));
  WHEN("it is marked") {
    pose_after(history, 8.305).status = status_late;
    THEN("it is allowed, and then poses flow") {
      CHECK_THAT(violations_of(history), !Catch::VectorContains(std::string("old")));
    }
  }
}

SCENARIO("what a bridge sends after a stop is marked if it is old") {
  History history = undisturbed();
  history.episodes = {{{.fault = Fault::stop, .target = Role::bridge}, {at(6), at(7)}}};
  erase_imu(history, 6, 7.004);
  erase_poses(history, 6, 7.004);
  const auto add_backlog = [&](std::uint32_t status) {
    for (int i = 0; i <= 200; ++i) {
      const SteadyTime sent = at(7) + i * ms / 100;
      history.imu.push_back(imu_at(sent));
      Arrival pose = pose_at(sent);
      pose.time_ns = host_zero_ns + at(6).ns + i * period_ns;
      const bool is_old = pose.received_host_ns - pose.time_ns > 250 * ms;
      pose.status = is_old ? status : 0U;
      history.poses.push_back(pose);
    }
    std::ranges::sort(history.poses, {}, &Arrival::received);
    std::ranges::sort(history.imu, {}, &Published::received);
  };
  GIVEN("marked poses") {
    add_backlog(status_late);
    THEN("no promise is broken") {
      CHECK(violations_of(history) == none);
    }
  }
  GIVEN("poses without a mark") {
    add_backlog(0U);
    const auto violations = violations_of(history);
    THEN("a promise is broken") {
      REQUIRE(violations.size() == 1);
      CHECK_THAT(violations.front(),
                 Contains("is not marked, but its sample was 1000.0 ms old when it left"));
    }
  }
}

SCENARIO("a fusion that is stopped writes at most the pose that it has in hand when it continues") {
  for (const int old : {1, 2}) {
    History history = takeover(7.105);
    history.episodes.back() = {{.fault = Fault::stop, .target = Role::first_fusion}, {at(7), at(7.6)}};
    const auto next = std::find_if(history.poses.begin(), history.poses.end(),
                                   [](const Arrival& pose) { return pose.received >= at(7.6001); });
    std::vector<Arrival> in_hand;
    for (int i = 0; i < old; ++i) {
      in_hand.push_back(pose_at(at(6.995)));
      in_hand.back().received = at(7.6001) + i;
    }
    history.poses.insert(next, in_hand.begin(), in_hand.end());
    CHECK(violations_of(history).empty() == (old == 1));
  }
}

SCENARIO("no pose is from the future") {
  History history = undisturbed();
  for (Arrival& pose : history.poses) pose.time_ns += 12 * ms;
  REQUIRE(violations_of(history).size() == 1);
  CHECK_THAT(violations_of(history).front(), Contains("in the future"));
  GIVEN("a bridge whose clock was set forward by 10 ms before") {
    history.episodes.push_back(
        {{.fault = Fault::clock_step, .target = Role::bridge, .amount_ns = 10 * ms}, {at(5), at(5)}});
    THEN("stamps are in its clock") {
      CHECK(violations_of(history) == none);
    }
  }
}

SCENARIO("a beacon has one owner") {
  GIVEN("one pose of the weaker fusion between those of the stronger one") {
    History history = undisturbed();
    Arrival& pose = pose_after(history, 8);
    pose.process = pose.writer = process_of(pose.strength = 200);
    const auto violations = violations_of(history);
    THEN("a promise is broken") {
      REQUIRE(violations.size() == 1);
      CHECK_THAT(violations.front(), Contains("fusion-200 is received although fusion-300 owns"));
    }
  }
  GIVEN("a takeover after a kill") {
    THEN("the weaker one is received") {
      CHECK(violations_of(takeover(7.105)) == none);
    }
  }
  GIVEN("a takeover without a reason") {
    History history = takeover(7.105);
    history.losses.clear();
    history.episodes.pop_back();
    THEN("the weaker one must not be received, and nothing counts the samples between them") {
      CHECK(violations_of(history).size() == 2);
    }
  }
}

SCENARIO("every missing number is counted") {
  GIVEN("three samples without a pose") {
    History history = undisturbed();
    erase_poses(history, 8, 8.015);
    WHEN("nobody counts them") {
      const Verdict verdict = HistoryChecker(history).check();
      REQUIRE(verdict.violations.size() == 1);
      CHECK_THAT(verdict.violations.front(), Contains("3 samples have no pose of fusion-300, and 3 of them"));
      CHECK(verdict.missing_uncounted == 3);
    }
    WHEN("the fusion counts two of them as lost and one as invalid") {
      history.statuses[2].status.events_lost = 2;
      history.statuses[2].status.samples_invalid = 1;
      const Verdict verdict = HistoryChecker(history).check();
      CHECK(verdict.violations == none);
      CHECK(verdict.missing_counted == 3);
    }
    WHEN("it had counted them before") {
      history.statuses[0].status.events_lost = history.statuses[2].status.events_lost = 3;
      CHECK(violations_of(history).size() == 1);
    }
    WHEN("another fusion counts them") {
      history.statuses[3].status.events_lost = 3;
      CHECK(violations_of(history).size() == 1);
    }
    WHEN("the consumer's reader counts them") {
      history.consumer_lost = 3;
      CHECK(violations_of(history) == none);
    }
    WHEN("the consumer's reader counts them, and another fusion's poses are missing too") {
      pass_on(history, 9);
      erase_poses(history, 9.2, 9.215);
      history.losses.push_back({at(9), process_of(300)});
      history.consumer_lost = GENERATE(3U, 6U);
      const Verdict verdict = HistoryChecker(history).check();
      CHECK(verdict.missing_uncounted == 6 - history.consumer_lost);
    }
    WHEN("a second beacon misses three too, and the transport counts for the process") {
      const std::uint64_t lost = GENERATE(3U, 6U);
      const BeaconAddress second = beacon + 1;
      for (Published imu : std::vector(history.imu)) {
        imu.address = second;
        history.imu.push_back(imu);
      }
      for (Arrival pose : std::vector(history.poses)) {
        pose.address = second;
        history.poses.push_back(pose);
      }
      for (FusionReport report : std::vector(history.statuses)) {
        report.status.address = second;
        history.statuses.push_back(report);
      }
      for (FusionReport& report : history.statuses) {
        if (report.received > at(9) && report.process == process_of(300)) report.status.samples_lost = lost;
      }
      const Verdict verdict = HistoryChecker(history).check();
      CHECK(verdict.missing_counted == lost);
      CHECK(verdict.missing_uncounted == 6 - lost);
      CHECK(verdict.violations.empty() == (lost == 6));
    }
  }
  GIVEN("a fusion that is stopped between the judgement of a pose and its writing") {
    History history = undisturbed();
    history.episodes.back() = {{.fault = Fault::stop, .target = Role::first_fusion}, {at(7.9999), at(8.05)}};
    for (Arrival& pose : history.poses) {
      if (pose.received > at(7.995) && pose.received < at(8.05)) pose.received = at(8.05);
    }
    THEN("that pose is not missing") {
      CHECK(HistoryChecker(history).check().missing_uncounted == 0);
    }
  }
}

SCENARIO("silence is at most the lease and a tenth while a warm fusion lives") {
  CHECK(violations_of(takeover(7.105)) == none);
  History history = takeover(7.12);
  REQUIRE(violations_of(history).size() == 1);
  CHECK_THAT(violations_of(history).front(), Contains("no pose for 120.0 ms beside a warm fusion"));
  WHEN("the machine stalled for 10 ms of it") {
    history.stalls = {{at(7.05), at(7.056)}, {at(7.054), at(7.06)}};
    CHECK(violations_of(history) == none);
  }
  WHEN("two of the bridge's samples were lost meanwhile") {
    history = takeover(7.117);
    REQUIRE(violations_of(history).size() == 1);
    std::erase_if(history.imu,
                  [](const Published& imu) { return imu.received > at(7.097) && imu.received < at(7.107); });
    CHECK(violations_of(history) == none);
  }
  WHEN("the other fusion was not warm") {
    history.statuses[1].status.role = FusionRole::warming;
    CHECK(violations_of(history) == none);
  }
  WHEN("the bridge's clock was set back by as much") {
    history.episodes.front() = {{.fault = Fault::clock_step, .target = Role::bridge, .amount_ns = -80 * ms},
                                {at(7.0), at(7.0)}};
    CHECK(violations_of(history) == none);
  }
  WHEN("the bridge's clock was set back only after most of it, or was set ahead") {
    const TimeNs amount_ns = GENERATE(-80, 80) * ms;
    history = takeover(7.3);
    history.episodes.front() = {{.fault = Fault::clock_step, .target = Role::bridge, .amount_ns = amount_ns},
                                {at(7.25), at(7.25)}};
    REQUIRE(violations_of(history).size() == 1);
    CHECK_THAT(violations_of(history).front(), Contains("beside a warm fusion"));
  }
  WHEN("the bridge was silent too") {
    erase_imu(history, 7.01, 7.115);
    CHECK(violations_of(history) == none);
  }
  WHEN("the bridge is silent, and an old pose arrives meanwhile") {
    erase_imu(history, 7.01, 7.3);
    erase_poses(history, 7.13, 7.3);
    CHECK(violations_of(history) == none);
  }
}

SCENARIO("three seconds after the last fault poses flow as before") {
  GIVEN("poses of an engine that initialises, or uses no fixes, for as long") {
    const double ready_s = GENERATE(9.1, 9.3);
    const std::uint32_t flag = GENERATE(std::uint32_t{status_initialising}, std::uint32_t{status_stale});
    History history = undisturbed();
    for (Arrival& pose : history.poses) {
      if (pose.received < at(ready_s)) pose.status = flag;
    }
    const Verdict verdict = HistoryChecker(history).check();
    THEN("it is a violation above three seconds") {
      CHECK(verdict.violations.empty() == (ready_s < 9.2));
      CHECK(seconds_between(0, verdict.recovery_ns) == Approx(ready_s - 6.2).margin(0.01));
    }
  }
  GIVEN("poses that end") {
    History history = undisturbed();
    erase_poses(history, 9.8, 10);
    THEN("a promise is broken") {
      REQUIRE(violations_of(history).size() == 1);
      CHECK_THAT(violations_of(history).front(), Contains("not recovered"));
    }
  }
}

}  // namespace history_checker_test
