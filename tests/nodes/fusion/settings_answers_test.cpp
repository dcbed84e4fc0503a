/// Replies to settings requests: warnings, and the event from which a change applies.

#include "fusion/estimators_feeder.hpp"
#include "settings_client/settings_report.hpp"
#include <sonopose/settings/preset.hpp>

#include <catch2/catch.hpp>
#include <fmt/format.h>

namespace settings_answers_test {

using namespace sonopose;
using namespace sonopose::fusion;
using namespace sonopose::fusion::test;
using Catch::Contains;

SCENARIO("the settings of beacons without their own can be queried") {
  config::FusionConfig config;
  config.assign("documented.trust.n_min=3");
  config.assign("documented.imu_weight=low");
  Feeder feeder(false, config);
  CHECK(feeder.settings_for_all().address == all_beacons);
  CHECK(feeder.settings_for_all().from_sequence == 0);
  CHECK(feeder.settings_for_all().settings.trust.n_min == 3);
  CHECK(feeder.settings_for_all().settings.drift.jump_alpha ==
        settings::balance_of(settings::ImuWeight::low).jump_alpha);
  feeder.requests.answer(request(7, {{"documented.trust.n_base", "5"}}));
  CHECK(feeder.settings_for_all().settings.trust.n_base == settings::TrustSettings{}.n_base);
  feeder.requests.answer(request(all_beacons, {{"documented.trust.n_base", "9"}}, 500));
  feeder.requests.answer(request(all_beacons, {{"documented.trust.sigma_m", "0.5"}}));
  CHECK(feeder.settings_for_all().settings.trust.n_base == 9);
  CHECK(feeder.settings_for_all().settings.trust.sigma_m == 0.5);
  CHECK(feeder.settings_for_all().from_sequence == 500);
}

SCENARIO("item 1: a setting that a preset replaces is accepted with a warning") {
  Feeder feeder(false);
  const BeaconAddress address = GENERATE(BeaconAddress{7}, all_beacons);
  const auto reply = feeder.requests.answer(request(address, {{"documented.drift.jump_alpha", "0.9"}}));
  CHECK(reply.accepted);
  CHECK_THAT(reply.reason, Contains("documented.drift.jump_alpha") && Contains("medium") && Contains("user"));
  const auto user = feeder.requests.answer(request(address, {{"documented.imu_weight", "user"},
                                                             {"documented.drift.jump_alpha", "0.9"},
                                                             {"documented.velocity.blend_weight", "0.05"}}));
  CHECK(user.accepted);
  CHECK(user.reason.empty());
  feeder.push_all(walk(7, 1.0));
  CHECK(feeder.changes.back().settings.drift.jump_alpha == 0.9);
}

SCENARIO("a magnetometer that the engine would ignore is refused") {
  Feeder feeder(false, {});
  const BeaconAddress address = GENERATE(BeaconAddress{7}, all_beacons);
  const auto reply = feeder.requests.answer(request(address, {{"documented.attitude.magnetometer", "true"}}));
  CHECK_FALSE(reply.accepted);
  CHECK_THAT(reply.reason, Contains("documented.attitude.magnetometer") && Contains("kalman"));
  CHECK(feeder.requests
            .answer(request(address,
                            {{"documented.attitude.magnetometer", "true"}, {"fusion.engine", "documented"}}))
            .accepted);
}

SCENARIO("a contradiction to the present settings is accepted with a warning") {
  Feeder feeder(false);
  const BeaconAddress address = GENERATE(BeaconAddress{7}, all_beacons);
  const auto ask = [&](SettingAssignment assignment) {
    return feeder.requests.answer(request(address, {std::move(assignment)}));
  };
  CHECK(ask({"documented.trust.n_max", "50"}).reason.empty());
  const auto reply = ask({"documented.trust.stuck_n", "60"});
  CHECK(reply.accepted);
  CHECK_THAT(reply.reason,
             Contains("documented.trust.stuck_n = 60") && Contains("documented.trust.n_max = 50"));
  CHECK(ask({"documented.trust.sigma_m", "0.5"})
            .reason.empty());  // warned once, in the reply to the request that causes it
}

SCENARIO("the reply to a request for all beacons names each one's event") {
  config::FusionConfig config;
  config.assign("beacon.8.documented.trust.n_base=5");  // configured, but without samples
  Feeder feeder(false, config);
  const auto ask = [&](std::uint64_t from) {
    return feeder.requests.answer(request(all_beacons, {{"documented.trust.sigma_m", "0.5"}}, from)).details;
  };
  CHECK(ask(0).empty());
  const auto nine = walk(9, 1.0);
  const auto seven = walk(7, 2.0);
  feeder.push_all(nine);
  feeder.push_all(seven);
  const std::uint64_t seven_next = seven.size() + 1;
  const std::uint64_t nine_next = nine.size() + 1;
  CHECK(ask(0) == fmt::format("7: event {}, 9: event {}", seven_next, nine_next));
  CHECK(ask(nine_next + 5) == fmt::format("7: event {}, 9: event {}", seven_next, nine_next + 5));
  CHECK(ask(5000) == "7: event 5000, 9: event 5000");
  CHECK(feeder.requests.answer(request(7, {{"documented.trust.sigma_m", "0.5"}})).details.empty());
}

SCENARIO("a reply names the beacons whose own value a change for all leaves alone") {
  GIVEN("beacon 7 without values of its own, 8 with one from the start, 11 with one but not received") {
    config::FusionConfig config;
    config.assign("beacon.8.admission.min_quality_percent=55");
    config.assign("beacon.11.admission.min_quality_percent=40");
    Feeder feeder(false, config);
    const auto seven = walk(7, 1.0);
    feeder.push_all(seven);
    feeder.push_all(walk(8, 1.0));
    const std::string next_of_seven = fmt::format("7: event {}", seven.size() + 1);
    const auto ask = [&](std::vector<SettingAssignment> assignments) {
      auto reply = feeder.requests.answer(request(all_beacons, std::move(assignments)));
      CHECK(reply.accepted);
      return reply;
    };
    WHEN("all are given another value") {
      const auto reply = ask({{"admission.min_quality_percent", "60"}});
      THEN("only 7 is said to change, and the values that stay are named") {
        CHECK(reply.details == next_of_seven + "; unchanged: 8");
        CHECK_FALSE(settings_client::changes_no_known_beacon(reply));
        CHECK_THAT(reply.reason,
                   Contains("admission.min_quality_percent") && Contains("beacon 8 (55), 11 (40)"));
      }
    }
    WHEN("all are also given a value that none has of its own") {
      const auto reply = ask({{"admission.min_quality_percent", "60"}, {"frozen.moved_m", "0.4"}});
      THEN("8 changes too, but the value that stays is named") {
        CHECK_THAT(reply.details, Contains(next_of_seven + ", 8: event ") && !Contains("unchanged"));
        CHECK_THAT(reply.reason, Contains("beacon 8 (55), 11 (40)") && !Contains("frozen.moved_m"));
      }
    }
    WHEN("all are given the value that 8 has already") {
      THEN("8 has what was asked for") {
        CHECK_THAT(ask({{"admission.min_quality_percent", "55"}}).reason, !Contains("8 (55)"));
      }
    }
    WHEN("7 gets its own one too") {
      feeder.requests.answer(request(7, {{"admission.min_quality_percent", "50"}}));
      THEN("no beacon is said to change") {
        const auto reply = ask({{"admission.min_quality_percent", "60"}});
        CHECK(reply.details == "unchanged: 7, 8");
        CHECK(settings_client::changes_no_known_beacon(reply));
      }
    }
  }
}

SCENARIO("the answer to a change of the engine states that the estimate starts again") {
  GIVEN("a beacon with the Kalman engine") {
    Feeder feeder(false, {});
    feeder.push_all(walk(7, 1.0));
    WHEN("it gets the documented engine") {
      const auto answer = feeder.requests.answer(request(7, {{"fusion.engine", "documented"}}));
      THEN("it is accepted, and says so") {
        CHECK(answer.accepted);
        CHECK_THAT(answer.reason, Contains("the estimate restarts and reset_counter rises"));
      }
    }
  }
}

}  // namespace settings_answers_test
