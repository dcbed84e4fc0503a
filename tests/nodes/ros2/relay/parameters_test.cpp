#include "ros2/relay/parameters.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace parameters_test {

using namespace sonopose;
using namespace sonopose::ros2::relay;

using Texts = std::vector<std::string>;

/// Two settings, each for all beacons and for beacon 7.
SettingsByBeacon effective_settings() {
  const std::vector<SettingAssignment> values{{"documented.drift.jump_alpha", "0.5"},
                                              {"documented.trust.n_min", "3"}};
  SettingsByBeacon effective;
  for (const BeaconAddress address : {BeaconAddress{7}, all_beacons}) {
    effective[address] = {.address = address, .values = values};
  }
  return effective;
}

TEST_CASE("A parameter names a setting of all beacons or of one") {
  CHECK(setting_named("documented.drift.jump_alpha") ==
        SettingName{all_beacons, "documented.drift.jump_alpha"});
  CHECK(setting_named("beacon_7.documented.drift.jump_alpha") ==
        SettingName{7, "documented.drift.jump_alpha"});
  CHECK(setting_named("beacon_0.documented.attitude.mahony.kp") ==
        SettingName{0, "documented.attitude.mahony.kp"});
  for (const char* const name :
       {"", "drift", "documented.drift.jump", "beacon_7", "beacon_7.", "beacon_.documented.trust.n_min",
        "beacon_07.documented.trust.n_min", "beacon_-1.documented.trust.n_min",
        "beacon_65535.documented.trust.n_min", "beacon_70000.documented.trust.n_min",
        "beacon_7.beacon_7.documented.trust.n_min"}) {
    CAPTURE(name);
    CHECK(setting_named(name) == std::nullopt);
  }
  for (const char* const name : {"documented.trust.n_min", "beacon_7.documented.trust.n_min"}) {
    CHECK(parameter_name(setting_named(name).value()) == name);
  }
}

TEST_CASE("An old name of a parameter is answered by the new one") {
  CHECK(why_unknown("trust.sigma_m") == "'trust.sigma_m' is now called 'documented.trust.sigma_m'");
  CHECK(why_unknown("beacon_7.trust.sigma_m") == "'trust.sigma_m' is now called 'documented.trust.sigma_m'");
  CHECK_THAT(why_unknown("delay.procesing_s"), Catch::Contains("'delay.processing_s'"));
  CHECK_THAT(why_unknown("beacon_65535.fusion.engine"), Catch::Contains("address"));
}

TEST_CASE("Parameters are listed as rclcpp lists them") {
  const auto effective = effective_settings();
  const ParameterList all = list_parameters(effective, {}, 0);
  CHECK(all.names == Texts{"beacon_7.documented.drift.jump_alpha", "beacon_7.documented.trust.n_min",
                           "documented.drift.jump_alpha", "documented.trust.n_min"});
  CHECK(all.prefixes == Texts{"beacon_7.documented.drift", "beacon_7.documented.trust", "documented.drift",
                              "documented.trust"});
  CHECK(list_parameters(effective, {}, 3).names ==
        Texts{"documented.drift.jump_alpha", "documented.trust.n_min"});
  CHECK(list_parameters(effective, {}, 2).names.empty());
  CHECK(list_parameters(effective, {"beacon_7"}, 0).names ==
        Texts{"beacon_7.documented.drift.jump_alpha", "beacon_7.documented.trust.n_min"});
  CHECK(list_parameters(effective, {"beacon_7"}, 1).names.empty());
  CHECK(list_parameters(effective, {"documented.trust", "documented.drift.jump_alpha"}, 1).names ==
        Texts{"documented.drift.jump_alpha", "documented.trust.n_min"});
  CHECK(list_parameters(effective, {"tru"}, 0).names.empty());
  CHECK(list_parameters({}, {}, 0).names.empty());
  const OptionParameters options{{"map_frame", settings::SettingValue(std::string("map"))}};
  CHECK(list_parameters({}, {}, 1, options).names == Texts{"map_frame"});
  CHECK(list_parameters({}, {"beacon_7"}, 0, options).names.empty());
}

TEST_CASE("A parameter has the effective value, with the type of its setting") {
  const auto effective = effective_settings();
  CHECK(parameter_value(effective, "documented.drift.jump_alpha") == settings::SettingValue(0.5));
  CHECK(parameter_value(effective, "beacon_7.documented.trust.n_min") == settings::SettingValue(3));
  CHECK(parameter_value(effective, "beacon_8.documented.trust.n_min") == std::nullopt);
  CHECK(parameter_value(effective, "documented.trust.n_max") == std::nullopt);
  CHECK(parameter_value(effective, "no.such") == std::nullopt);
}

}  // namespace parameters_test
