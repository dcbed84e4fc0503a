/// Replies to settings requests: warnings, and the event from which a change applies.

#include "fusion/estimators_feeder.hpp"
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
  config.assign("trust.n_min=3");
  config.assign("fusion.imu_weight=low");
  Feeder feeder(false, config);
  CHECK(feeder.settings_for_all().address == all_beacons);
  CHECK(feeder.settings_for_all().from_sequence == 0);
  CHECK(feeder.settings_for_all().settings.trust.n_min == 3);
  CHECK(feeder.settings_for_all().settings.drift.jump_alpha ==
        settings::balance_of(settings::ImuWeight::low).jump_alpha);
  feeder.requests.answer(request(7, {{"trust.n_base", "5"}}));
  CHECK(feeder.settings_for_all().settings.trust.n_base == settings::TrustSettings{}.n_base);
  feeder.requests.answer(request(all_beacons, {{"trust.n_base", "9"}}, 500));
  feeder.requests.answer(request(all_beacons, {{"trust.sigma_m", "0.5"}}));
  CHECK(feeder.settings_for_all().settings.trust.n_base == 9);
  CHECK(feeder.settings_for_all().settings.trust.sigma_m == 0.5);
  CHECK(feeder.settings_for_all().from_sequence == 500);
}

SCENARIO("item 1: a setting that a preset replaces is accepted with a warning") {
  Feeder feeder(false);
  const BeaconAddress address = GENERATE(BeaconAddress{7}, all_beacons);
  const auto reply = feeder.requests.answer(request(address, {{"drift.jump_alpha", "0.9"}}));
  CHECK(reply.accepted);
  CHECK_THAT(reply.reason, Contains("drift.jump_alpha") && Contains("medium") && Contains("user"));
  const auto user = feeder.requests.answer(request(
      address,
      {{"fusion.imu_weight", "user"}, {"drift.jump_alpha", "0.9"}, {"velocity.blend_weight", "0.05"}}));
  CHECK(user.accepted);
  CHECK(user.reason.empty());
  feeder.push_all(walk(7, 1.0));
  CHECK(feeder.changes.back().settings.drift.jump_alpha == 0.9);
}

SCENARIO("a magnetometer that the engine would ignore is refused") {
  Feeder feeder(false, {});
  const BeaconAddress address = GENERATE(BeaconAddress{7}, all_beacons);
  const auto reply = feeder.requests.answer(request(address, {{"attitude.magnetometer", "true"}}));
  CHECK_FALSE(reply.accepted);
  CHECK_THAT(reply.reason, Contains("attitude.magnetometer") && Contains("kalman"));
  CHECK(feeder.requests
            .answer(request(address, {{"attitude.magnetometer", "true"}, {"fusion.engine", "documented"}}))
            .accepted);
}

SCENARIO("a contradiction to the present settings is accepted with a warning") {
  Feeder feeder(false);
  const BeaconAddress address = GENERATE(BeaconAddress{7}, all_beacons);
  const auto ask = [&](SettingAssignment assignment) {
    return feeder.requests.answer(request(address, {std::move(assignment)}));
  };
  CHECK(ask({"trust.n_max", "50"}).reason.empty());
  const auto reply = ask({"trust.stuck_n", "60"});
  CHECK(reply.accepted);
  CHECK_THAT(reply.reason, Contains("trust.stuck_n = 60") && Contains("trust.n_max = 50"));
  CHECK(ask({"trust.sigma_m", "0.5"})
            .reason.empty());  // reported once, in the reply to the request that causes it
}

SCENARIO("the reply to a request for all beacons names each one's event") {
  config::FusionConfig config;
  config.assign("beacon.8.trust.n_base=5");  // configured, but without samples
  Feeder feeder(false, config);
  const auto ask = [&](std::uint64_t from) {
    return feeder.requests.answer(request(all_beacons, {{"trust.sigma_m", "0.5"}}, from)).details;
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
  CHECK(feeder.requests.answer(request(7, {{"trust.sigma_m", "0.5"}})).details.empty());
}

SCENARIO("a warning of an engine that does not read a setting knows the engine of each beacon, live too") {
  GIVEN("beacon 7 with the documented engine, beacon 9 with the Kalman engine") {
    Feeder feeder(false, {});
    feeder.push_all(walk(7, 1.0));
    feeder.push_all(walk(9, 1.0));
    const auto to_documented = feeder.requests.answer(request(7, {{"fusion.engine", "documented"}}));
    THEN("the answer states that the estimate starts again") {
      CHECK(to_documented.accepted);
      CHECK_THAT(to_documented.reason, Contains("the estimate starts again and reset_counter rises"));
    }
    THEN("a gain for all is no reason for a warning, because beacon 7 reads it") {
      CHECK(feeder.requests.answer(request(all_beacons, {{"trust.sigma_m", "0.2"}})).reason.empty());
    }
    THEN("a gain that beacon 7 does not read names it") {
      CHECK_THAT(feeder.requests.answer(request(all_beacons, {{"delay.estimate", "true"}})).reason,
                 Contains("beacon 7: delay.estimate has no effect"));
    }
    THEN("a gain for beacon 9 has no effect") {
      CHECK_THAT(feeder.requests.answer(request(9, {{"trust.sigma_m", "0.2"}})).reason,
                 Contains("trust.sigma_m has no effect"));
    }
  }
}

}  // namespace settings_answers_test
