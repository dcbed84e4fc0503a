/// Settings requests: the event and the beacons that they apply to, and refusals without effect.

#include "fusion/estimators_feeder.hpp"

#include <catch2/catch.hpp>

namespace live_settings_test {

using namespace sonopose;
using namespace sonopose::fusion;
using namespace sonopose::fusion::test;
using Catch::Contains;

const std::vector<SettingAssignment> user_balance{{"documented.imu_weight", "user"},
                                                  {"documented.drift.jump_alpha", "0.9"},
                                                  {"documented.velocity.blend_weight", "0.05"}};

settings::Settings with_user_balance() {
  settings::Settings settings = documented();
  settings.preset.imu_weight = settings::ImuWeight::user;
  settings.drift.jump_alpha = 0.9;
  settings.velocity.blend_weight = 0.05;
  return settings;
}

/// Pushes the events with numbers in [first, last].
void push_range(Feeder& feeder, const std::vector<Event>& events, std::uint64_t first, std::uint64_t last) {
  for (const Event& event : events) {
    if (sequence_of(event) >= first && sequence_of(event) <= last) feeder.push(event);
  }
}

constexpr std::uint64_t to_the_end = UINT64_MAX;

SCENARIO("a change applies exactly from the requested event on") {
  const bool lossless = GENERATE(false, true);
  const auto events = walk(7, 10.0);
  const std::uint64_t from = 700;
  const auto expected = poses_of_estimator(events, with_user_balance(), from);
  REQUIRE_FALSE(same(expected, poses_of_estimator(events, with_user_balance(), from + 50)));
  GIVEN("a fusion without samples") {
    Feeder feeder(lossless);
    WHEN("the request comes before the beacon does") {
      const auto reply = feeder.requests.answer(request(7, user_balance, from, 42));
      feeder.push_all(events);
      THEN("it is accepted under its name, and the poses are those of an engine configured there") {
        CHECK(reply == SettingsReply{7, 42, true, "", from});
        CHECK(same(feeder.poses, expected));
      }
      THEN("the settings are reported at the first event and at that one") {
        REQUIRE(feeder.changes.size() == 2);
        CHECK(feeder.changes[0].address == 7);
        CHECK(feeder.changes[0].from_sequence == 1);
        CHECK(feeder.changes[0].settings.drift.jump_alpha == settings::DriftSettings{}.jump_alpha);
        CHECK(feeder.changes[1].from_sequence == from);
        CHECK(feeder.changes[1].settings.drift.jump_alpha == 0.9);
      }
    }
    WHEN("it comes while the beacon sends, well before its event") {
      push_range(feeder, events, 1, 300);
      const auto reply = feeder.requests.answer(request(7, user_balance, from));
      push_range(feeder, events, 301, to_the_end);
      THEN("it is the same") {
        CHECK(reply.from_sequence == from);
        CHECK(same(feeder.poses, expected));
      }
    }
    WHEN("it names no event, or one that is past, just before that event") {
      push_range(feeder, events, 1, from - 1);
      const auto reply = feeder.requests.answer(request(7, user_balance, GENERATE(0U, 1U, 400U, 699U)));
      push_range(feeder, events, from, to_the_end);
      THEN("it applies from the next one on, which the reply names") {
        CHECK(reply.accepted);
        CHECK(reply.from_sequence == from);
        CHECK(same(feeder.poses, expected));
        CHECK(feeder.changes.back().from_sequence == from);
      }
    }
    WHEN("it is for all beacons") {
      push_range(feeder, events, 1, 300);
      const auto reply = feeder.requests.answer(request(all_beacons, user_balance, from, 9));
      push_range(feeder, events, 301, to_the_end);
      THEN("the same") {
        CHECK(reply == SettingsReply{all_beacons, 9, true, "", from, "7: event 700"});
        CHECK(same(feeder.poses, expected));
      }
    }
  }
}

SCENARIO("the event counts in the order of the numbers, not of the arrivals") {
  const auto events = walk(7, 10.0);
  const std::uint64_t from = 700;
  Feeder feeder(false);
  feeder.requests.answer(request(7, user_balance, from));
  push_range(feeder, events, 1, from - 3);
  // 698 arrives last of these six.
  for (const std::uint64_t number : {699U, 700U, 701U, 702U, 703U, 698U}) {
    feeder.push(events[number - 1], SteadyTime{begin_ns});
  }
  push_range(feeder, events, 704, to_the_end);
  CHECK(feeder.status(7)->events_lost == 0);
  CHECK(same(feeder.poses, poses_of_estimator(events, with_user_balance(), from)));
}

SCENARIO("a change keeps what the engine knows") {
  Feeder feeder(false);
  feeder.push_all(walk(7, 5.0));
  feeder.requests.answer(request(7, {{"documented.trust.sigma_m", "0.3"}}));
  const FusedPose before = feeder.poses.back();
  const std::size_t count = feeder.poses.size();
  auto rest = walk(7, 6.0);
  push_range(feeder, rest, walk(7, 5.0).size() + 1, to_the_end);
  REQUIRE(feeder.poses.size() > count);
  CHECK(feeder.poses[count].reset_counter == 0);
  CHECK((feeder.poses[count].status & status_initialising) == 0U);
  CHECK((feeder.poses[count].position_world_m - before.position_world_m).norm() < 0.2);
}

SCENARIO("a request that cannot be carried out changes nothing") {
  const auto events = walk(7, 5.0);
  Feeder feeder(false);
  push_range(feeder, events, 1, 300);
  const auto refused = [&feeder](const SettingsRequest& wrong) {
    const SettingsReply reply = feeder.requests.answer(wrong);
    CHECK_FALSE(reply.accepted);
    CHECK(reply.from_sequence == 0);
    CHECK(reply.request_id == wrong.request_id);
    CHECK(reply.address == wrong.address);
    return reply.reason;
  };
  const BeaconAddress address = GENERATE(BeaconAddress{7}, BeaconAddress{8}, all_beacons);
  const std::uint64_t from = GENERATE(0U, 500U);
  CHECK_THAT(
      refused(request(address, {{"documented.trust.sigma_m", "0.5"}, {"documented.drift.jump_alpha", "2"}},
                      from, 1)),
      Contains("documented.drift.jump_alpha = 2") && Contains("0 … 1") && !Contains("sigma_m"));
  CHECK_THAT(refused(request(address, {{"drift.jump", "0.5"}, {"documented.trust.sigma_m", "0.5"}}, from, 2)),
             Contains("'drift.jump'") && Contains("'documented.drift.jump_alpha'"));
  CHECK_THAT(refused(request(address, {}, from, 3)), Contains("no assignments"));
  push_range(feeder, events, 301, to_the_end);
  feeder.push_all(walk(8, 1.0));
  CHECK(same(feeder.poses_of(7), poses_of_estimator(events)));
  CHECK(feeder.changes_of(7).size() == 1);  // the one reported at its first event
  CHECK(feeder.changes_of(8).size() == 1);
}

SCENARIO("a request for all beacons leaves a beacon's own settings alone") {
  GIVEN("beacon 7 with a value of its own from the start, 8 with one by request, 9 with none") {
    config::FusionConfig config;
    config.assign("beacon.7.documented.trust.sigma_m=0.7");
    Feeder feeder(false, config);
    for (const BeaconAddress address : std::initializer_list<BeaconAddress>{7, 8, 9}) {
      feeder.push_all(walk(address, 1.0));
    }
    REQUIRE(feeder.requests.answer(request(8, {{"documented.trust.sigma_m", "0.8"}})).accepted);
    WHEN("all are given another") {
      const auto reply = feeder.requests.answer(
          request(all_beacons, {{"documented.trust.sigma_m", "0.5"}, {"documented.trust.n_base", "9"}}));
      CHECK(reply.accepted);
      CHECK(reply.from_sequence == 0);
      for (const BeaconAddress address : std::initializer_list<BeaconAddress>{7, 8, 9}) {
        push_range(feeder, walk(address, 2.0), walk(address, 1.0).size() + 1, to_the_end);
      }
      const auto effective = [&feeder](BeaconAddress address) {
        const auto changes = feeder.changes_of(address);
        REQUIRE(changes.size() == 2);
        CHECK(changes[1].from_sequence == walk(address, 1.0).size() + 1);
        CHECK(changes[1].settings.trust.n_base == 9);
        return changes[1].settings.trust.sigma_m;
      };
      THEN("7 and 8 keep their own and take the rest") {
        CHECK(effective(7) == 0.7);
        CHECK(effective(8) == 0.8);
        CHECK(effective(9) == 0.5);
      }
    }
  }
}

SCENARIO("requests apply to beacons that appear later") {
  config::FusionConfig config;
  config.assign("beacon.12.documented.trust.sigma_m=0.7");
  Feeder feeder(false, config);
  const auto settings_of = [&feeder](BeaconAddress address, std::size_t count = 1) {
    const auto changes = feeder.changes_of(address);
    REQUIRE(changes.size() == count);
    return changes.back().settings.trust;
  };
  GIVEN("requests for all, and for one without samples") {
    feeder.push_all(walk(7, 1.0));
    feeder.requests.answer(request(all_beacons, {{"documented.trust.sigma_m", "0.5"}}));
    const auto reply = feeder.requests.answer(request(11, {{"documented.trust.sigma_m", "0.6"}}));
    CHECK(reply.accepted);
    CHECK(reply.from_sequence == 0);
    feeder.requests.answer(request(all_beacons, {{"documented.trust.n_base", "9"}}));
    WHEN("beacons come") {
      for (const BeaconAddress address : std::initializer_list<BeaconAddress>{10, 11, 12}) {
        feeder.push_all(walk(address, 1.0));
      }
      THEN("they begin with what was asked for all, and with their own above it") {
        CHECK(settings_of(10).sigma_m == 0.5);
        CHECK(settings_of(10).n_base == 9);
        CHECK(settings_of(11).sigma_m == 0.6);
        CHECK(settings_of(11).n_base == 9);
        CHECK(settings_of(12).sigma_m == 0.7);
        CHECK(settings_of(12).n_base == 9);
        CHECK(feeder.changes_of(10).front().from_sequence == 1);
      }
    }
  }
  GIVEN("a request for all from an event on that the one beacon there has passed already") {
    feeder.push_all(walk(7, 1.0));
    feeder.requests.answer(request(all_beacons, {{"documented.trust.sigma_m", "0.5"}}, 50));
    WHEN("another beacon comes") {
      feeder.push_all(walk(10, 1.0));
      THEN("it applies to that one from its event of this number on") {
        CHECK(settings_of(10, 2).sigma_m == 0.5);
        CHECK(feeder.changes_of(10).back().from_sequence == 50);
      }
    }
  }
}

SCENARIO("a repeated request gets the same reply and has no further effect") {
  Feeder feeder(false);
  feeder.push_all(walk(7, 1.0));
  const auto first = request(7, {{"documented.trust.sigma_m", "0.5"}}, 0, 1);
  const SettingsReply reply = feeder.requests.answer(first);
  const auto second = request(7, {{"documented.trust.sigma_m", "0.6"}}, 0, 2);
  feeder.requests.answer(second);
  WHEN("the first comes again behind the second") {
    push_range(feeder, walk(7, 2.0), walk(7, 1.0).size() + 1, to_the_end);
    CHECK(feeder.requests.answer(first) == reply);
    push_range(feeder, walk(7, 3.0), walk(7, 2.0).size() + 1, to_the_end);
    THEN("the second still applies") {
      CHECK(feeder.changes.back().settings.trust.sigma_m == 0.6);
      CHECK(feeder.changes.size() == 2);
    }
  }
  WHEN("one with the same id is for another beacon, or its id is 0") {
    THEN("it is another request") {
      CHECK(feeder.requests.answer(request(8, {{"documented.trust.sigma_m", "5"}}, 77, 1)).from_sequence ==
            77);
      CHECK(feeder.requests.answer(request(8, {{"documented.trust.sigma_m", "5"}}, 78, 0)).from_sequence ==
            78);
      CHECK(feeder.requests.answer(request(8, {{"documented.trust.sigma_m", "5"}}, 79, 0)).from_sequence ==
            79);
    }
  }
}

SCENARIO("more changes than the capacity are refused, and the waiting ones still apply") {
  Feeder feeder(false);
  feeder.push_all(walk(7, 1.0));
  for (std::uint64_t i = 0; i < SettingsTimeline::capacity; ++i) {
    REQUIRE(feeder.requests.answer(request(7, {{"documented.trust.n_base", "9"}}, 100'000 + i)).accepted);
  }
  for (const BeaconAddress address : {BeaconAddress{7}, all_beacons}) {
    const auto reply = feeder.requests.answer(request(address, {{"documented.trust.n_base", "9"}}, 200'000));
    CHECK_FALSE(reply.accepted);
    CHECK_THAT(reply.reason, Contains("beacon 7") && Contains(std::to_string(SettingsTimeline::capacity)));
    CHECK(feeder.requests.answer(request(address, {{"documented.trust.n_base", "8"}}, 100'000)).accepted);
  }
  CHECK(feeder.requests.answer(request(8, {{"documented.trust.n_base", "9"}}, 200'000)).accepted);
}

SCENARIO("a reset keeps the settings") {
  Feeder feeder(false);
  feeder.push_all(walk(7, 1.0));
  feeder.requests.answer(request(7, {{"documented.trust.sigma_m", "0.5"}}));
  push_range(feeder, walk(7, 2.0), walk(7, 1.0).size() + 1, to_the_end);
  feeder.reset(7);
  push_range(feeder, walk(7, 3.0), walk(7, 2.0).size() + 1, to_the_end);
  CHECK(feeder.poses.back().reset_counter == 1);
  CHECK(feeder.changes.size() == 2);
  CHECK(feeder.changes.back().settings.trust.sigma_m == 0.5);
}

}  // namespace live_settings_test
