/// Settings of a running fusion: sonopose-settings, and the effective settings for consumers.

#include "config/fusion_config.hpp"
#include "faults/stall_watch.hpp"
#include "support/bus.hpp"
#include "support/pose_tap.hpp"
#include "support/temporary_folder.hpp"
#include "support/wait_until.hpp"
#include <sonopose/settings/settings_table.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <iostream>
#include <map>
#include <thread>
#include <utility>

namespace sonopose::settings_test {

using namespace sonopose::test;
using Catch::Contains;
namespace topics = dds::topics;

std::string value_in(const EffectiveSettings& settings, const std::string& key) {
  const auto found = std::find_if(settings.values.begin(), settings.values.end(),
                                  [&key](const auto& entry) { return entry.key == key; });
  return found == settings.values.end() ? "not there" : found->value;
}

/// Predicate for settings of `address` in which `key` is `value`.
auto has(BeaconAddress address, const std::string& key, const std::string& value) {
  return [=](const EffectiveSettings& settings) {
    return settings.address == address && value_in(settings, key) == value;
  };
}

auto of(BeaconAddress address) {
  return [=](const auto& sample) { return sample.address == address; };
}

/// Effective settings that a late-joining consumer receives.
EffectiveSettings as_late_consumer(const Bus& bus, BeaconAddress address) {
  Consumer<sonopose_EffectiveSettings> late(bus, topics::settings, dds::topics::Delivery::live);
  REQUIRE(late.wait_for(of(address)));
  return *std::find_if(late.samples.begin(), late.samples.end(), of(address));
}

/// A live fusion that receives beacons 7 and 8.
struct LiveSystem {
  explicit LiveSystem(const Arguments& fusion_arguments = {}) : fusion(bus.fusion(fusion_arguments)) {
    seven = bus.bridge({"--scenario", "rest", "--address", "7"});
    eight = bus.bridge({"--scenario", "rest", "--address", "8"});
    REQUIRE(settings.wait_for(of(7)));
    REQUIRE(settings.wait_for(of(8)));
  }

  Bus bus;
  Consumer<sonopose_EffectiveSettings> settings{bus, topics::settings, dds::topics::Delivery::live};
  std::unique_ptr<Process> fusion;
  std::unique_ptr<Process> seven;
  std::unique_ptr<Process> eight;
};

SCENARIO("settings are changed at run time, and late consumers receive the effective ones") {
  GIVEN("beacons 7 and 8, and an override for 8") {
    LiveSystem live({"--set", "beacon.8.documented.trust.sigma_m=0.8"});
    const Bus& bus = live.bus;
    WHEN("settings of all beacons are changed") {
      const Result set = bus.settings({"set", "documented.trust.sigma_m=0.25", "documented.trust.n_base=9"});
      CAPTURE(set.error);
      REQUIRE(set.code == 0);
      CHECK_THAT(set.output, Contains("accepted"));
      THEN("both use them, except for the override of 8; late consumers receive this") {
        REQUIRE(live.settings.wait_for(has(7, "documented.trust.n_base", "9")));
        REQUIRE(live.settings.wait_for(has(8, "documented.trust.n_base", "9")));
        CHECK(value_in(as_late_consumer(bus, 7), "documented.trust.sigma_m") == "0.25");
        CHECK(value_in(as_late_consumer(bus, 8), "documented.trust.sigma_m") == "0.8");
        CHECK(as_late_consumer(bus, 7).values.size() == settings::setting_table().size());
        const Result get = bus.settings({"get", "documented.trust.sigma_m", "--json"});
        REQUIRE(get.code == 0);
        const auto list = nlohmann::json::parse(get.output);
        REQUIRE(list.size() == 3);
        CHECK(list[0]["beacon"] == "all");
        CHECK(list[0]["settings"]["documented.trust.sigma_m"] == 0.25);
        CHECK(list[1]["settings"]["documented.trust.sigma_m"] == 0.25);
        CHECK(list[2]["settings"]["documented.trust.sigma_m"] == 0.8);
        CHECK_THAT(bus.settings({"get", "documented.trust", "--beacon", "8"}).output,
                   Contains("[beacon.8]") && Contains("documented.trust.sigma_m = 0.8\n") &&
                       Contains("documented.trust.n_base = 9\n") && !Contains("documented.drift."));
      }
    }
    WHEN("a request contains one invalid value") {
      const Result set = bus.settings(
          {"set", "documented.trust.n_base=9", "documented.drift.jump_alpha=2", "--beacon", "7"});
      THEN("it is refused with key, value and limits, and nothing changes") {
        CHECK(set.code == 1);
        CHECK(set.output.empty());
        CHECK_THAT(set.error,
                   Contains("refused") && Contains("documented.drift.jump_alpha = 2") && Contains("0 … 1"));
        REQUIRE(bus.settings({"set", "documented.trust.n_min=3", "--beacon", "7"}).code == 0);
        REQUIRE(live.settings.wait_for(has(7, "documented.trust.n_min", "3")));
        CHECK(value_in(as_late_consumer(bus, 7), "documented.trust.n_base") ==
              std::to_string(settings::TrustSettings{}.n_base));
      }
    }
    WHEN("a setting that a preset replaces is set") {
      const Result set = bus.settings({"set", "fusion.engine=documented", "documented.drift.jump_alpha=0.9"});
      THEN("it is accepted with a warning") {
        CHECK(set.code == 0);
        CHECK_THAT(set.error,
                   Contains("warning") && Contains("documented.drift.jump_alpha") && Contains("user"));
      }
    }
    WHEN("a key of get is misspelt, or an argument of set is not an assignment") {
      THEN("it is named") {
        const Result get = bus.settings({"get", "trust.sigma"});
        CHECK(get.code == 1);
        CHECK_THAT(get.error, Contains("'trust.sigma'"));
        const Result set = bus.settings({"set", "documented.trust.sigma_m"});
        CHECK(set.code == 1);
        CHECK_THAT(set.error, Contains("documented.trust.sigma_m") && Contains("KEY=VALUE"));
      }
    }
  }
}

SCENARIO("a fusion without a beacon reports the settings that it will use") {
  GIVEN("a fusion alone, started with a changed setting") {
    const Bus bus;
    const auto fusion = bus.fusion({"--set", "documented.trust.n_min=3"});
    THEN("get prints that setting, and reports that a beacon has not been received") {
      const Result get = bus.settings({"get", "documented.trust"});
      CAPTURE(get.error);
      CHECK(get.code == 0);
      CHECK_THAT(get.output, Contains("documented.trust.n_min = 3\n") && !Contains("[beacon"));
      const Result seven = bus.settings({"get", "--beacon", "7"});
      CHECK(seven.code == 1);
      CHECK_THAT(seven.error, Contains("received nothing from beacon 7"));
    }
    WHEN("the value is changed for all beacons") {
      REQUIRE(bus.settings({"set", "documented.trust.n_base=9"}).code == 0);
      THEN("get prints it at once") {
        CHECK_THAT(bus.settings({"get", "documented.trust"}).output,
                   Contains("documented.trust.n_min = 3\n") && Contains("documented.trust.n_base = 9\n"));
      }
    }
  }
}

SCENARIO("saved settings are those of the next fusion, and later changes for all still apply") {
  const TemporaryFolder folder;
  const std::string tuned = (folder / "tuned.toml").string();
  GIVEN("a fusion with a setting from its start, whose settings were changed and saved") {
    {
      const LiveSystem live({"--set", "beacon.8.heading.mount_offset_deg=90"});
      for (const Arguments& change :
           {Arguments{"admission.min_quality_percent=55"}, {"frozen.moved_m=0.4", "--beacon", "11"}}) {
        Arguments set{"set"};
        set.insert(set.end(), change.begin(), change.end());
        REQUIRE(live.bus.settings(set).code == 0);
      }
      const Result saved = live.bus.settings({"save", tuned});
      CAPTURE(saved.error);
      REQUIRE(saved.code == 0);
      CHECK_THAT(saved.error, Contains("3 settings that differ"));
    }
    THEN("the file has these three, also that of beacon 11, which was never received") {
      const auto config = config::FusionConfig::load(tuned);
      CHECK(config.beacons() == std::vector<BeaconAddress>{8, 11});
      CHECK(config.for_beacon(7).admission.min_quality_percent == 55);
      CHECK(config.for_beacon(8).heading.mount_offset_deg == 90);
      CHECK(config.for_beacon(11).frozen.moved_m == 0.4);
    }
    WHEN("another fusion loads the file, and a setting is changed for all") {
      LiveSystem live({"--config", tuned});
      REQUIRE(live.settings.wait_for(has(8, "heading.mount_offset_deg", "90")));
      const Result set = live.bus.settings({"set", "admission.min_quality_percent=60"});
      THEN("it applies to all beacons, without a word about their own") {
        CHECK(set.code == 0);
        CHECK(set.error.empty());
        CHECK(live.settings.wait_for(has(7, "admission.min_quality_percent", "60")));
        CHECK(live.settings.wait_for(has(8, "admission.min_quality_percent", "60")));
      }
    }
  }
}

SCENARIO("a change for all that every beacon's own value prevents is not a success") {
  GIVEN("beacons 7 and 8, each with a value of its own") {
    LiveSystem live({"--set", "beacon.7.admission.min_quality_percent=50", "--set",
                     "beacon.8.admission.min_quality_percent=50"});
    WHEN("all are given another") {
      const Result set = live.bus.settings({"set", "admission.min_quality_percent=60"});
      THEN("the exit code says that none has changed, and the text which") {
        CHECK(set.code == 1);
        CHECK_THAT(set.output, Contains("only for beacons that appear later") && Contains("unchanged: 7, 8"));
        CHECK_THAT(set.error, Contains("admission.min_quality_percent") && Contains("beacon 7 (50), 8 (50)"));
      }
      THEN("a file with all of this is saved") {
        const TemporaryFolder folder;
        REQUIRE(live.bus.settings({"save", (folder / "tuned.toml").string()}).code == 0);
        const auto config = config::FusionConfig::load(folder / "tuned.toml");
        CHECK(config.for_beacon(7).admission.min_quality_percent == 50);
        CHECK(config.for_beacon(9).admission.min_quality_percent == 60);
      }
    }
  }
}

SCENARIO("settings of two fusions are saved together unless they differ") {
  const TemporaryFolder folder;
  const std::string tuned = (folder / "tuned.toml").string();
  const Bus bus;
  const auto first = bus.fusion(
      {"--addresses", "7", "--set", "frozen.moved_m=0.4", "--set", "beacon.7.heading.mount_offset_deg=90"});
  GIVEN("another fusion with the same settings for all, for other beacons") {
    const auto second = bus.fusion(
        {"--addresses", "8", "--set", "frozen.moved_m=0.4", "--set", "beacon.8.heading.mount_offset_deg=45"});
    THEN("the file has those of both") {
      config::FusionConfig config;
      CHECK(wait_until([&] {  // on a busy machine, the second fusion may be discovered late
        REQUIRE(bus.settings({"save", tuned}).code == 0);
        config = config::FusionConfig::load(tuned);
        return config.beacons().size() == 2;
      }));
      CHECK(config.for_beacon(7).heading.mount_offset_deg == 90);
      CHECK(config.for_beacon(8).heading.mount_offset_deg == 45);
      CHECK(config.for_beacon(9).frozen.moved_m == 0.4);
    }
  }
  GIVEN("another fusion with other settings for all") {
    const auto second = bus.fusion({"--addresses", "8"});
    THEN("that is an error") {
      Result saved;
      CHECK(wait_until([&] {
        saved = bus.settings({"save", tuned});
        return saved.code == 1;
      }));
      CHECK_THAT(saved.error, Contains("different settings"));
    }
  }
}

SCENARIO("a misspelt key is refused at once, with and without a running fusion") {
  const Bus bus;
  const Result get = bus.settings({"get", "trust.sigma", "--timeout", "1000"});
  CHECK(get.code == 1);
  CHECK_THAT(get.error, Contains("'trust.sigma'") && Contains("'documented.trust.sigma_m'"));
}

SCENARIO("a change from an event that never comes is refused") {
  const Result set = Bus().settings({"set", "frozen.moved_m=0.4", "--from-event", "-1"});
  CHECK(set.code == 105);
  CHECK_THAT(set.error, Contains("--from-event") && Contains("range"));
}

SCENARIO("watch prints changes as they happen") {
  LiveSystem live;
  const auto lines = live.bus.settings_watch({"--beacon", "7"});
  REQUIRE(lines->wait_for_line(Stream::error, "watching beacon 7"));
  REQUIRE(live.bus.settings({"set", "documented.trust.n_base=9", "--beacon", "8"}).code == 0);
  REQUIRE(live.bus.settings({"set", "documented.imu_weight=low"}).code == 0);
  REQUIRE(lines->wait_for_line(Stream::output, "beacon.7.documented.imu_weight = \"low\"  # was \"medium\""));
  REQUIRE(lines->wait_for_line(Stream::output,
                               "beacon.7.documented.velocity.blend_weight"));  // set by the preset
  CHECK(lines->end_by(SIGINT).code == 0);
  CHECK_THAT(lines->text(Stream::output), !Contains("beacon.8") && !Contains("trust"));
}

SCENARIO("the reset command waits for its result") {
  LiveSystem live;
  Consumer<sonopose_FusionStatus> statuses(live.bus, topics::fusion_status, dds::topics::Delivery::live);
  const Result reset = live.bus.settings({"reset", "--beacon", "7"});
  CAPTURE(reset.error);
  CHECK(reset.code == 0);
  CHECK_THAT(reset.output, Contains("beacon 7") && !Contains("beacon 8"));
  CHECK(
      statuses.wait_for([](const auto& status) { return status.address == 7 && status.reset_counter == 1; }));
  REQUIRE(statuses.wait_for(of(8), statuses.samples.size()));
  CHECK_FALSE(std::any_of(statuses.samples.begin(), statuses.samples.end(), [](const auto& status) {
    return status.address == 8 && status.reset_counter > 0;
  }));
  CHECK_THAT(live.bus.settings({"reset"}).output, Contains("beacon 7") && Contains("beacon 8"));
}

SCENARIO("a missing fusion is reported") {
  const Bus bus;
  for (const Arguments& command : {Arguments{"get"}, Arguments{"set", "documented.trust.n_base=9"},
                                   Arguments{"save", "/dev/null"}, Arguments{"reset"}}) {
    Arguments arguments = command;
    arguments.insert(arguments.end(), {"--timeout", "0.3"});
    const Result result = bus.settings(arguments);
    CAPTURE(command);
    CHECK(result.code == 1);
    CHECK_THAT(result.error, Contains("0.3 s") && Contains("sonopose-fusion"));
  }
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int beacon_count = 3;  // more overload a fusion that a sanitizer slows down
#else
constexpr int beacon_count = 10;
#endif
constexpr BeaconAddress first_beacon = 7;
constexpr BeaconAddress another_beacon = first_beacon + beacon_count - 1;  ///< the last beacon

/// Sends requests of all kinds, up to 1,600 per second, and resets of one beacon.
class RequestFlood {
public:
  explicit RequestFlood(const Bus& bus)
      : participant_(dds::ext::participant({.domain_id = bus.domain_id()})),
        writer_(dds::topics::make_writer(participant_, dds::qos::Provider(), topics::settings_request)),
        resets_(dds::topics::make_writer(participant_, dds::qos::Provider(), topics::reset)),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}

  [[nodiscard]] std::uint64_t sent() const { return sent_; }

private:
  void run(const std::stop_token& stop) {
    const auto begin = std::chrono::steady_clock::now();
    while (!stop.stop_requested()) {
      SettingsRequest request{.address = first_beacon, .request_id = ++sent_, .assignments = {}};
      if (sent_ % 3 == 0) request.address = all_beacons;
      request.from_sequence = sent_ % 5 == 0 ? 1'000'000 + sent_ : 0;  // waits for its event
      if (sent_ % 2 == 0) {
        request.assignments.assign(sonopose_MAX_ASSIGNMENTS, {std::string(sonopose_MAX_SETTING_KEY, 'x'),
                                                              std::string(sonopose_MAX_SETTING_VALUE, '9')});
      } else {
        request.assignments = {{"documented.trust.n_base", std::to_string(5 + sent_ % 20)},
                               {"documented.trust.sigma_m", "0.3"}};
      }
      writer_.write(dds::topics::to_idl(request).sample());
      if (sent_ % 16 == 0) resets_.write({.address = another_beacon, .request_id = sent_});
      std::this_thread::sleep_until(begin + std::chrono::microseconds(625 * sent_.load()));
    }
  }

  dds::domain::DomainParticipant participant_;
  dds::pub::DataWriter<sonopose_SettingsRequest> writer_;
  dds::pub::DataWriter<sonopose_ResetCommand> resets_;
  std::atomic<std::uint64_t> sent_ = 0;
  std::jthread thread_;
};

/// Sorted waits for each beacon's next pose, minus the time in the disjoint `stalls` and the delays of the
/// bridge. On a busy machine the bridge publishes samples further apart than their period.
std::vector<double> unexplained_waits_ms(const std::vector<TappedPose>& poses,
                                         const std::vector<faults::Interval>& stalls) {
  constexpr TimeNs period_ns = 10'000'000;
  std::map<BeaconAddress, TappedPose> latest;
  std::vector<double> waits_ms;
  for (const TappedPose& tapped : poses) {
    if (tapped.pose.address == another_beacon) continue;  // this beacon is reset
    const auto [entry, is_first] = latest.try_emplace(tapped.pose.address, tapped);
    const TappedPose before = std::exchange(entry->second, tapped);
    if (is_first) continue;
    TimeNs wait_ns = tapped.received - before.received;
    wait_ns -=
        std::max<TimeNs>(0, tapped.pose.imu_bridge_time_ns - before.pose.imu_bridge_time_ns - period_ns);
    wait_ns -= faults::covered_ns(stalls, before.received, tapped.received);
    waits_ms.push_back(1e-6 * static_cast<double>(wait_ns));
  }
  std::sort(waits_ms.begin(), waits_ms.end());
  return waits_ms;
}

/// A fusion that serves its beacons at 100 Hz, in a domain of its own.
struct Serving {
  Serving() { REQUIRE(tap.wait_for_count(0, poses_a_second).size() >= poses_a_second); }

  static constexpr std::size_t poses_a_second = std::size_t{100} * beacon_count;
  const Bus bus;
  const std::unique_ptr<Process> fusion = bus.fusion();
  const std::unique_ptr<Process> bridge =
      bus.bridge({"--scenario", "rest", "--address", std::to_string(first_beacon), "--beacons",
                  std::to_string(beacon_count)});
  const PoseTap tap{bus};
};

SCENARIO("a flood of requests delays no pose") {
  GIVEN("two fusions") {
    const Serving flooded;
    const Serving undisturbed;
    WHEN("1,600 requests and 100 resets a second arrive at one of them for two seconds") {
      const RequestFlood flood(flooded.bus);
      const auto longer_ms = [&] {
        const faults::StallWatch stalls;
        const std::size_t flooded_from = flooded.tap.count();
        const std::size_t undisturbed_from = undisturbed.tap.count();
        const auto flooded_poses = flooded.tap.wait_for_count(flooded_from, 2 * Serving::poses_a_second);
        const auto other_poses =
            undisturbed.tap.wait_for_count(undisturbed_from, 2 * Serving::poses_a_second);
        REQUIRE(flooded_poses.size() >= 2 * Serving::poses_a_second);
        REQUIRE(other_poses.size() >= 2 * Serving::poses_a_second);
        const auto busy = faults::merged(stalls.stalls());
        const auto nearly_longest_ms = [&busy](const std::vector<TappedPose>& poses) {
          const auto waits_ms = unexplained_waits_ms(poses, busy);
          return waits_ms[waits_ms.size() * 99 / 100];
        };
        const double flooded_ms = nearly_longest_ms(flooded_poses);
        const double undisturbed_ms = nearly_longest_ms(other_poses);
        std::cout << fmt::format("{} requests: waits for a pose {:.1f} ms, undisturbed {:.1f} ms\n",
                                 flood.sent(), flooded_ms, undisturbed_ms);
        return flooded_ms - 2 * std::max(0.0, undisturbed_ms);
      };
      THEN("99 of 100 waits for its poses are at most 30 ms longer than twice those of the other") {
        double least_ms = longer_ms();
        // Other work of the machine may delay one fusion alone, but not each time.
        for (int i = 0; i < 4 && least_ms > 30; ++i) least_ms = std::min(least_ms, longer_ms());
        CHECK(least_ms <= 30);
      }
    }
  }
}

}  // namespace sonopose::settings_test
