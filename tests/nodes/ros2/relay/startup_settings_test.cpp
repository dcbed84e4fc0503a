#include "ros2/relay/startup_settings.hpp"

#include <catch2/catch.hpp>

#include <vector>

namespace startup_settings_test {

using namespace sonopose;
using namespace sonopose::ros2::relay;

TEST_CASE("Settings are checked by name, type and range") {
  CHECK_NOTHROW(check(StartupSetting{"delay.processing_s", "0.07"}));
  CHECK_NOTHROW(check(StartupSetting{"beacon_7.fusion.engine", "documented"}));
  CHECK_THROWS_WITH(check(StartupSetting{"delay.procesing_s", "1"}), Catch::Contains("unknown parameter"));
  CHECK_THROWS_WITH(check(StartupSetting{"delay.processing_s", "fast"}),
                    Catch::Contains("delay.processing_s"));
  CHECK_THROWS_WITH(check(StartupSetting{"delay.processing_s", "-1"}), Catch::Contains("delay.processing_s"));
}

TEST_CASE("The settings of all beacons are requested before those of one, and the last value counts") {
  const auto requests = requests_of({{"beacon_7.documented.trust.n_min", "3"},
                                     {"documented.trust.n_min", "4"},
                                     {"documented.trust.n_min", "5"},
                                     {"documented.trust.sigma_m", "0.2"}});
  REQUIRE(requests.size() == 2);
  CHECK(requests[0].address == all_beacons);
  CHECK(requests[0].assignments ==
        std::vector<SettingAssignment>{{"documented.trust.n_min", "5"}, {"documented.trust.sigma_m", "0.2"}});
  CHECK(requests[1].address == 7);
  CHECK(requests[1].assignments == std::vector<SettingAssignment>{{"documented.trust.n_min", "3"}});
  CHECK(requests_of({}).empty());
}

}  // namespace startup_settings_test
