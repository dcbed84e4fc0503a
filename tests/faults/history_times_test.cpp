/// Rules of times: stamps rise, and no pose is too old or from the future.

#include "faults/artificial_history.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace history_times_test {

using namespace sonopose;
using namespace sonopose::faults;
using namespace sonopose::faults::artificial;
using Catch::Contains;

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
    const bool is_old = pose.received_host_ns - pose.time_ns > 250 * ms;
    if (is_old) pose.status = status_late;
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

SCENARIO("poses whose samples the observer missed are few") {
  History history = undisturbed();
  erase_imu(history, 7, 7.0499);  // ten samples
  CHECK(violations_of(history) == none);
  erase_imu(history, 8, 8.0049);
  REQUIRE(violations_of(history).size() == 1);
  CHECK_THAT(violations_of(history).front(), Contains("samples of too many poses are unknown"));
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

SCENARIO("a pose is marked if its stamp is old, wherever it was delayed") {
  History history = undisturbed();
  const double step_s = GENERATE(0.0, 3.0, 9.5);
  CAPTURE(step_s);
  if (step_s > 0) {
    const TimeNs amount_ns = GENERATE(-10'000 * ms, 10'000 * ms);
    history.episodes.push_back({{.fault = Fault::clock_step, .target = Role::bridge, .amount_ns = amount_ns},
                                {at(step_s), at(step_s)}});
    for (Arrival& pose : history.poses) {
      if (pose.received >= at(step_s)) pose.time_ns += amount_ns;
      if (pose.received >= at(step_s)) pose.bridge_time_ns += amount_ns;
    }
  }
  for (Arrival& pose : history.poses) {
    if (pose.received >= at(8)) pose.time_ns -= 200 * ms;  // on the line
    if (pose.received >= at(8)) pose.received_host_ns += 150 * ms;
  }
  history.lives.clear();
  const auto violations = violations_of(history);
  const auto is_named = [](const std::string& text) {
    return text.find("is not marked, but its stamp is 35") != std::string::npos;
  };
  CHECK(std::any_of(violations.begin(), violations.end(), is_named));
}

SCENARIO("the clock of a bridge gives no ages for four seconds after a step") {
  History history = undisturbed();
  history.episodes.push_back(
      {{.fault = Fault::clock_step, .target = Role::bridge, .amount_ns = -500 * ms}, {at(7), at(7)}});
  CHECK(violations_of(history) == none);
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

}  // namespace history_times_test
