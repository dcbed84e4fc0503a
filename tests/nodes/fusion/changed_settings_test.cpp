/// Settings for a configuration file, while they change.

#include "fusion/changed_settings.hpp"

#include "fusion/estimators_feeder.hpp"

#include <catch2/catch.hpp>

#include <string>

namespace changed_settings_test {

using namespace sonopose;
using namespace sonopose::fusion;
using namespace sonopose::fusion::test;
using Values = std::vector<SettingAssignment>;

constexpr const char* quality = "admission.min_quality_percent";
constexpr const char* mount = "heading.mount_offset_deg";

/// Updates as pairs of address and values, in their order.
std::vector<std::pair<BeaconAddress, Values>> pairs_of(const std::vector<EffectiveSettings>& updates) {
  std::vector<std::pair<BeaconAddress, Values>> pairs;
  for (const EffectiveSettings& update : updates) pairs.emplace_back(update.address, update.values);
  return pairs;
}

using Updates = std::vector<std::pair<BeaconAddress, Values>>;

SCENARIO("differences from the defaults are needed, and all values that are a beacon's own") {
  GIVEN("a fusion with all settings at their defaults") {
    Feeder feeder(false, {});
    const presence::AddressSet addresses;
    ChangedSettings changed(feeder.estimators, addresses);
    CHECK(pairs_of(changed.update(all_beacons)) == Updates{{all_beacons, {}}});
    CHECK(changed.update(all_beacons).empty());
    WHEN("a beacon is received, and one that was not gets a value that waits for its event") {
      feeder.push_all(walk(7, 1.0));
      feeder.requests.answer(request(11, {{mount, "90"}}, 5000));
      THEN("that value is needed; all beacons come last") {
        CHECK(pairs_of(changed.update(11)) == Updates{{11, {{mount, "90"}}}, {all_beacons, {}}});
        CHECK(changed.update(11).empty());
      }
    }
    WHEN("a beacon gets the value of all as its own, and then all get another") {
      feeder.requests.answer(request(7, {{quality, "50"}}));
      THEN("its own one is needed, although it is the default") {
        CHECK(pairs_of(changed.update(7)) == Updates{{7, {{quality, "50"}}}, {all_beacons, {}}});
        feeder.requests.answer(request(all_beacons, {{quality, "60"}}));
        CHECK(pairs_of(changed.update(all_beacons)) == Updates{{all_beacons, {{quality, "60"}}}});
      }
    }
  }
  GIVEN("a configuration that gives a beacon a value as its own that is also that for all") {
    config::FusionConfig config;
    for (const char* const beacon : {"", "beacon.8."}) {
      config.assign(std::string(beacon) + "admission.min_quality_percent=60");
    }
    Feeder feeder(false, config);
    THEN("both are needed: that for all may change") {
      const presence::AddressSet addresses;
      ChangedSettings changed(feeder.estimators, addresses);
      CHECK(pairs_of(changed.update(all_beacons)) ==
            Updates{{8, {{quality, "60"}}}, {all_beacons, {{quality, "60"}}}});
    }
    THEN("a fusion that serves only the other beacon leaves that to the one that serves it") {
      const auto addresses = presence::AddressSet::parse("7");
      ChangedSettings changed(feeder.estimators, addresses);
      CHECK(pairs_of(changed.update(all_beacons)) == Updates{{all_beacons, {{quality, "60"}}}});
    }
  }
}

}  // namespace changed_settings_test
