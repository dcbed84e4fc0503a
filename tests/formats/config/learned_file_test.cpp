/// The file of what a fusion has learned of the sensors.

#include "config/learned_file.hpp"

#include "config/fusion_config.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace learned_file_test {

using namespace sonopose;
using Catch::Matchers::Contains;

Estimate estimate_of(BeaconAddress address) {
  Estimate estimate;
  estimate.address = address;
  estimate.time_ns = 1'790'000'000'123'456'789;
  estimate.gyro_bias_body_radps = VectorEstimate{.value = {0.1, -1e-9, 2.0 / 3.0}, .std = {1e-3, 2e-3, 1.0}};
  estimate.accelerometer_bias_body_mps2 = VectorEstimate{.value = {0, 1, -2}, .std = {0.25, 0.5, 0.125}};
  estimate.lever_arm_body_m = VectorEstimate{.value = {0.01, 0.02, 0.03}, .std = {0.001, 0.001, 0.001}};
  estimate.fix_noise_m = ScalarEstimate{.value = 0.0213, .std = -1.0};
  return estimate;
}

SCENARIO("what a fusion has learned is read as it was written") {
  const test::TemporaryFolder folder;
  GIVEN("two beacons in a file") {
    const config::LearnedSensors written{
        {7, {estimate_of(7), {}}},
        {131, {estimate_of(131), {"heading.mount_offset_deg=90", "calibration.axes=+y-x+z"}}}};
    test::write_text(folder / "learned.toml", config::learned_toml(written));
    THEN("every value is the same") {
      CHECK(config::read_learned(folder / "learned.toml") == written);
    }
  }
  GIVEN("no file") {
    THEN("nothing is known") {
      CHECK(config::read_learned(folder / "learned.toml").empty());
    }
  }
}

SCENARIO("the mounting is what of the settings says where a sensor is") {
  settings::Settings settings;
  settings.outage.stale_after_s = 2.0;
  CHECK(config::mounting_of(settings).empty());
  settings.calibration.gyroscope.sensitivity_z = 1.02;
  settings.heading.mount_offset_deg = -90.0;
  CHECK(config::mounting_of(settings) ==
        std::vector<std::string>{"heading.mount_offset_deg=-90", "calibration.gyroscope.sensitivity_z=1.02"});
}

SCENARIO("a beacon without its mounting is refused") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "learned.toml", "[beacon.7]\nfix_std_m = 0.1\n");
  CHECK_THROWS_WITH(config::read_learned(folder / "learned.toml"), Contains("beacon.7.mounting is missing"));
}

SCENARIO("a broken file names its line") {
  struct Mistake {
    const char* line;
    const char* reason;
  };
  const auto mistake = GENERATE(values<Mistake>({
      {"gyro_bias_body_radps = [1.0, 2.0]", "three numbers"},
      {"gyro_bias_body_radps = [1.0, 2.0, \"x\"]", "three numbers"},
      {"fix_std_m = \"small\"", "a number"},
      {"mounting = [1]", "KEY=VALUE"},
      {"mounting = \"none\"", "KEY=VALUE"},
      {"time_ns = 1.5", "an integer"},
      {"colour = 3", "a key of this file"},
      {"fix_std_m = ", ""},
  }));
  const test::TemporaryFolder folder;
  GIVEN(std::string("the line ") + mistake.line) {
    test::write_text(folder / "learned.toml", std::string("[beacon.7]\n") + mistake.line + "\n");
    THEN("the error names file, line and what was expected") {
      CHECK_THROWS_WITH(config::read_learned(folder / "learned.toml"),
                        Contains("learned.toml:2") && Contains(mistake.reason));
    }
  }
  GIVEN("a table that is not of a beacon") {
    test::write_text(folder / "learned.toml", "[bacon.7]\nfix_std_m = 0.1\n");
    THEN("the error says what was expected") {
      CHECK_THROWS_WITH(config::read_learned(folder / "learned.toml"), Contains("beacon.ADDRESS.KEY"));
    }
  }
}

}  // namespace learned_file_test
