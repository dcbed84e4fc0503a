/// Assignments at run time: parsing, refusals and precedence.

#include "config/fusion_config.hpp"

#include <catch2/catch.hpp>

namespace beacon_settings_test {

using namespace sonopose;
using namespace sonopose::config;
using Catch::Matchers::Contains;

constexpr double default_sigma_m = settings::TrustSettings{}.sigma_m;

/// Message of the error that refuses these assignments.
std::string refusal(const std::vector<SettingAssignment>& texts) {
  try {
    parsed(texts);
  } catch (const settings::SettingError& error) {
    return error.what();
  }
  FAIL("accepted");
  return {};
}

TEST_CASE("typed values are read in the kind of their keys") {
  const Assignments values = parsed({{"documented.drift.jump_alpha", "0.5"},
                                     {"documented.trust.n_base", "9"},
                                     {"documented.trust.enabled", "false"},
                                     {"documented.imu_weight", "high"}});
  CHECK(values == Assignments{{"documented.drift.jump_alpha", 0.5},
                              {"documented.trust.n_base", 9},
                              {"documented.trust.enabled", false},
                              {"documented.imu_weight", std::string("high")}});
  CHECK(parsed({}).empty());
}

TEST_CASE("a list with faults is refused with every one of them: key, value and what is allowed") {
  const std::string said = refusal({{"documented.drift.jump_alpha", "2"},
                                    {"documented.trust.n_base", "9"},
                                    {"trust.sigma", "0.1"},
                                    {"documented.trust.enabled", "1"},
                                    {"documented.imu_weight", "heavy"},
                                    {"documented.trust.sigma_m", "nan"}});
  CHECK_THAT(said, Contains("documented.drift.jump_alpha = 2") && Contains("0 … 1"));
  CHECK_THAT(said, Contains("'trust.sigma'") && Contains("'documented.trust.sigma_m'"));
  CHECK_THAT(said, Contains("documented.trust.enabled = 1") && Contains("true or false"));
  CHECK_THAT(said, Contains("documented.imu_weight = heavy") && Contains("low, medium, high or user"));
  CHECK_THAT(said, Contains("documented.trust.sigma_m = nan") && Contains("0.001 … 10 m"));
  CHECK_THAT(said, !Contains("n_base"));
}

TEST_CASE("a key that occurs twice is refused as ambiguous") {
  CHECK_THAT(refusal({{"documented.trust.n_base", "9"}, {"documented.trust.n_base", "10"}}),
             Contains("documented.trust.n_base") && Contains("twice"));
}

TEST_CASE("every setting's text reads back to the same bits") {
  settings::Settings settings;
  settings.drift.jump_alpha = 0.1 + 0.2;  // 0.30000000000000004
  settings.trust.sigma_m = 1.0 / 3.0;
  settings.trust.enabled = false;
  settings.preset.imu_weight = settings::ImuWeight::user;
  const auto texts = texts_of(settings);
  CHECK(texts.size() == settings::setting_table().size());
  settings::Settings again;
  for (const auto& [key, value] : parsed(texts)) settings::set(again, key, value);
  for (const auto& row : settings::setting_table()) {
    INFO(row.key);
    CHECK(settings::get(again, row.key) == settings::get(settings, row.key));
  }
}

TEST_CASE("a change for all leaves a beacon's own values alone, whichever came first") {
  BeaconSettings beacon{settings::Settings{}};
  SECTION("own first") {
    beacon.assign_own({{"documented.trust.sigma_m", 0.5}});
    beacon.assign_for_all({{"documented.trust.sigma_m", 0.25}, {"documented.trust.n_base", 7}});
  }
  SECTION("own last") {
    beacon.assign_for_all({{"documented.trust.sigma_m", 0.25}, {"documented.trust.n_base", 7}});
    beacon.assign_own({{"documented.trust.sigma_m", 0.5}});
  }
  CHECK(beacon.settings().trust.sigma_m == 0.5);
  CHECK(beacon.settings().trust.n_base == 7);
}

TEST_CASE("a beacon's own value stays its own when it equals everybody's, and follows its own changes") {
  BeaconSettings beacon{settings::Settings{}};
  beacon.assign_own({{"documented.trust.sigma_m", default_sigma_m}});
  beacon.assign_for_all({{"documented.trust.sigma_m", 0.25}});
  CHECK(beacon.settings().trust.sigma_m == default_sigma_m);
  beacon.assign_own({{"documented.trust.sigma_m", 0.75}});
  CHECK(beacon.settings().trust.sigma_m == 0.75);
}

TEST_CASE("what a configuration gives one beacon is the beacon's own") {
  FusionConfig config;
  config.assign("beacon.7.documented.trust.sigma_m=0.5");
  config.assign("documented.trust.n_base=9");
  CHECK(config.beacons() == std::vector<BeaconAddress>{7});
  for (const BeaconAddress address : std::initializer_list<BeaconAddress>{7, 8, all_beacons}) {
    CAPTURE(address);
    BeaconSettings beacon = config.beacon(address);
    CHECK(beacon.settings().trust.n_base == 9);
    beacon.assign_for_all({{"documented.trust.sigma_m", 0.25}, {"documented.trust.n_base", 5}});
    CHECK(beacon.settings().trust.sigma_m == (address == 7 ? 0.5 : 0.25));
    CHECK(beacon.settings().trust.n_base == 5);  // configured for all beacons, so no beacon's own
  }
}

TEST_CASE("item 1: keys that a preset replaces are warned of") {
  settings::Settings settings;
  settings.preset.imu_weight = settings::ImuWeight::high;
  const Assignments given{{"documented.drift.jump_alpha", 0.5}, {"documented.trust.n_base", 9}};
  const auto warnings = preset_warnings(settings, given, "beacon.7.");
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0],
             Contains("beacon.7.documented.drift.jump_alpha") && Contains("high") && Contains("user"));
  settings.preset.imu_weight = settings::ImuWeight::user;
  CHECK(preset_warnings(settings, given).empty());
}

TEST_CASE("settings of an attitude filter that is not chosen are warned of, unless they are as ever") {
  settings::Settings settings;
  settings.attitude.selection.filter = attitude::FilterKind::ahrs;
  settings.attitude.mahony.kp = 0.5;
  settings.attitude.ahrs.gain = 0.7;
  const Assignments given{
      {"documented.attitude.mahony.kp", 0.5},
      {"documented.attitude.ahrs.gain", 0.7},
      {"documented.attitude.magnetic.late_share", attitude::MagneticSettings{}.late_share},
      {"documented.trust.n_base", 9}};
  const auto warnings = idle_filter_warnings(settings, given, "beacon.7.");
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], Contains("beacon.7.documented.attitude.mahony.kp = 0.5") && Contains("ahrs"));
  settings.attitude.selection.filter = attitude::FilterKind::mahony;
  REQUIRE(idle_filter_warnings(settings, given).size() == 1);
  CHECK_THAT(idle_filter_warnings(settings, given)[0], Contains("documented.attitude.ahrs.gain"));
}

TEST_CASE("settings of the other engine are warned of in one line, unless they are as ever") {
  settings::Settings settings;
  REQUIRE(settings.engine.engine == settings::EngineKind::kalman);
  settings.trust.sigma_m = 0.5;
  settings.trust.n_base = 9;
  const Assignments given{{"documented.trust.sigma_m", 0.5},
                          {"documented.trust.n_base", 9},
                          {"documented.trust.n_max", settings.trust.n_max}};
  const auto warnings = warnings_for(settings, given, "beacon.7.");
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], Contains("beacon.7.documented.trust.sigma_m") &&
                              Contains("beacon.7.documented.trust.n_base") && !Contains("n_max") &&
                              Contains("fusion.engine is kalman"));
  settings.engine.engine = settings::EngineKind::documented;
  CHECK(warnings_for(settings, given, "beacon.7.").empty());
}

TEST_CASE("settings for all that only a beacon with the other engine reads are not warned of") {
  settings::Settings common;
  common.trust.sigma_m = 0.7;
  common.trust.n_base = 9;
  const Assignments given{{"documented.trust.sigma_m", 0.7}, {"documented.trust.n_base", 9}};
  settings::Settings documented = common;
  documented.engine.engine = settings::EngineKind::documented;
  CHECK(warnings_for_all(common, given, {{8, common}}).size() == 1);
  CHECK(warnings_for_all(common, given, {{7, documented}, {8, common}}).empty());
  documented.trust.n_base = 8;  // its own
  const auto warnings = warnings_for_all(common, given, {{7, documented}, {8, common}});
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], Contains("documented.trust.n_base has no effect") && !Contains("sigma_m"));
}

TEST_CASE("settings of the other engine are no mistake where a program chooses the engine") {
  settings::Settings settings;
  settings.trust.sigma_m = 0.7;
  const Assignments given{{"documented.trust.sigma_m", 0.7}};
  REQUIRE(warnings_for(settings, given).size() == 1);
  CHECK(warnings_for(settings, given, "", OtherEngine::ignored).empty());
  CHECK(warnings_for_all(settings, given, {{8, settings}}, OtherEngine::ignored).empty());
}

TEST_CASE("settings of a magnetometer that is not used are warned of") {
  settings::Settings settings;
  settings.attitude.selection.north_deg = 30.0;
  const Assignments given{{"documented.attitude.north_deg", 30.0}};
  REQUIRE(idle_filter_warnings(settings, given).size() == 1);
  CHECK_THAT(idle_filter_warnings(settings, given)[0], Contains("documented.attitude.magnetometer is false"));
  settings.attitude.selection.magnetometer = true;
  CHECK(idle_filter_warnings(settings, given).empty());
}

}  // namespace beacon_settings_test
