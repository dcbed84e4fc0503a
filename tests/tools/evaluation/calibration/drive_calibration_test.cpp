/// Output of a calibration from a drive.

#include "evaluation/calibration/drive_calibration.hpp"

#include "config/fusion_config.hpp"
#include "evaluation/calibration/calibration.hpp"
#include "files/error.hpp"
#include "files/replacement.hpp"
#include "recording/log_writer.hpp"
#include "sim/simulator.hpp"
#include "support/temporary_folder.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace drive_calibration_test {

using namespace sonopose;
using namespace sonopose::test;
using calibration::drive::MountMethod;
using calibration::drive::Quantity;
using Catch::Contains;
using evaluation::DriveCalibration;

constexpr double degree = geometry::radians_per_degree;

/// A mount of 84.5° ± 0.2°, a delay of −12 ms ± 1 ms, and no lever arm.
DriveCalibration sample_result() {
  DriveCalibration result;
  result.logs = {"runs/first", "runs/second"};
  result.wanted = {Quantity::mount, Quantity::delay, Quantity::lever_arm_x, Quantity::fix_horizontal};
  result.duration_s = 240.0;
  result.fit[Quantity::mount] = {84.5 * degree, 84.3 * degree, 84.7 * degree, {}};
  result.fit[Quantity::delay] = {-0.012, -0.013, -0.011, {}};
  result.fit[Quantity::lever_arm_x] = {0.03, -0.05, 0.11, "turn more"};
  result.fit[Quantity::fix_horizontal] = {0.02, 0.019, 0.021, {}};
  result.fit.fixes = 2400;
  result.fit.fixes_used = 2390;
  result.fit.stamped_delay_s = 0.070;
  return result;
}

SCENARIO("the text has each value with its interval, or the motion that is missing") {
  GIVEN("a calibration without a lever arm") {
    DriveCalibration result = sample_result();
    const std::string text = evaluation::drive_text(result);
    THEN("values are in the units of the settings, and the delay of a fix is explained") {
      CHECK_THAT(text, Contains("runs/first") && Contains("runs/second") && Contains("2390 of 2400 fixes"));
      CHECK_THAT(text, Contains("84.5 deg, between 84.3 and 84.7"));
      CHECK_THAT(text, Contains("-12 ms, between -13 and -11"));
      CHECK_THAT(text, Contains("58.0 ms old when it is received; its stamp says 70.0 ms"));
      CHECK_THAT(text, Contains("unknown (between -50 and 110): turn more"));
    }
    AND_WHEN("the IMU was silent") {
      result.fit.imu_silences = 2;
      result.fit.used_s = 231.0;
      CHECK_THAT(evaluation::drive_text(result),
                 Contains("cut at 2 silences of the IMU") && Contains("231 s"));
    }
    AND_WHEN("fixes seem to be received before they are measured") {
      result.fit[Quantity::delay] = {-0.079, -0.080, -0.078, {}};
      THEN("the clock of the IMU is the cause") {
        CHECK_THAT(evaluation::drive_text(result), Contains("-79 ms, between -80 and -78") &&
                                                       Contains("stamps of the IMU are ahead, by 79.0 ms"));
      }
    }
    AND_WHEN("the mount is that of the course") {
      result.fit.mount_method = MountMethod::course;
      result.fit.why_course = "the IMU slips";
      CHECK_THAT(evaluation::drive_text(result),
                 Contains("from the direction of travel") && Contains("the IMU slips"));
    }
  }
}

SCENARIO("the JSON is in SI units and has null for what is not known") {
  const auto json = nlohmann::json::parse(evaluation::drive_json(sample_result()));
  CHECK(json["logs"].size() == 2);
  CHECK(json["mount_method"] == "likelihood");
  const auto& quantities = json["quantities"];
  CHECK(quantities.size() == 4);
  CHECK(quantities["mount"]["value"].get<double>() == Approx(84.5 * degree));
  CHECK(quantities["mount"]["unit"] == "rad");
  CHECK(quantities["delay"]["low"].get<double>() == Approx(-0.013));
  CHECK(quantities["lever_arm_x"]["value"].is_null());
  CHECK(quantities["lever_arm_x"]["high"].get<double>() == Approx(0.11));
  CHECK(quantities["lever_arm_x"]["missing"] == "turn more");
  CHECK_FALSE(quantities["mount"].contains("missing"));
}

SCENARIO("the settings are those of the fusion, for all beacons or for one") {
  const TemporaryFolder folder;
  const auto file = folder / "fusion.toml";
  GIVEN("a calibration with mount and delay") {
    DriveCalibration result = sample_result();
    WHEN("it is written as a file") {
      files::write_whole(file, evaluation::drive_toml(result, std::nullopt));
      THEN("the fusion reads it, and takes the delay that the fixes carry") {
        const settings::Settings settings = config::FusionConfig::load(file).for_beacon(7);
        CHECK(settings.heading.mount_offset_deg == Approx(84.5));
        CHECK(settings.delay.correction_s == Approx(-0.012));
        CHECK(settings.delay.source == settings::Settings{}.delay.source);
      }
      THEN("the report is a comment, and each value has its interval") {
        CHECK_THAT(read_text(file), Contains("# mount") && Contains("84.5  # +- 0.2 deg, 95 %"));
      }
    }
    WHEN("the settings that were used ignore the delay that fixes carry") {
      result.has_fixed_delay = true;
      files::write_whole(file, evaluation::drive_toml(result, std::nullopt));
      THEN("the correction comes with the source that it corrects") {
        const settings::Settings settings = config::FusionConfig::load(file).for_beacon(7);
        CHECK(settings.delay.source == settings::DelaySource::measured);
      }
    }
    WHEN("the mount is some millionths of a degree below zero") {
      result.fit[Quantity::mount].value = -4e-6 * degree;
      THEN("it is zero, without a sign") {
        CHECK_THAT(evaluation::drive_toml(result, std::nullopt), Contains("mount_offset_deg = 0.0"));
      }
    }
    WHEN("it is written for one beacon") {
      files::write_whole(file, evaluation::drive_toml(result, BeaconAddress{9}));
      THEN("it applies to that one alone") {
        const config::FusionConfig config = config::FusionConfig::load(file);
        CHECK(config.for_beacon(9).heading.mount_offset_deg == Approx(84.5));
        CHECK(config.for_beacon(7).heading.mount_offset_deg == settings::Settings{}.heading.mount_offset_deg);
      }
    }
    WHEN("the fusion cannot correct the delay") {
      result.fit.clock_fault = "the IMU is ahead";
      THEN("it is no setting, and the report says why") {
        const auto settings = evaluation::drive_settings(result, std::nullopt);
        REQUIRE(settings.size() == 1);
        CHECK(settings.front().name == "mount_offset_deg");
        CHECK_THAT(evaluation::drive_text(result), Contains("no setting can correct it: the IMU is ahead"));
      }
    }
    WHEN("the mount is not known") {
      result.fit[Quantity::mount].missing = "accelerate";
      THEN("it is no setting") {
        const auto settings = evaluation::drive_settings(result, std::nullopt);
        REQUIRE(settings.size() == 1);
        CHECK(settings.front().name == "correction_s");
      }
    }
  }
}

SCENARIO("values of a single beacon that override the calibrated ones are found") {
  const TemporaryFolder folder;
  const auto file = folder / "fusion.toml";
  GIVEN("a file in which beacon 9 has a mount of its own, and beacon 7 another setting") {
    write_text(file,
               "[heading]\nmount_offset_deg = 1.0\n[beacon.9.heading]\nmount_offset_deg = 90.0\n"
               "[beacon.7.delay]\nprocessing_s = 0.07\n");
    const DriveCalibration result = sample_result();
    THEN("settings of all beacons are overridden for that one") {
      const auto found = evaluation::overriding(file, evaluation::drive_settings(result, std::nullopt));
      REQUIRE(found.size() == 1);
      CHECK(found.front().key == "beacon.9.heading.mount_offset_deg");
      CHECK(found.front().line == 4);
    }
    THEN("settings of one beacon are not") {
      CHECK(evaluation::overriding(file, evaluation::drive_settings(result, BeaconAddress{9})).empty());
    }
  }
}

SCENARIO("logs that show nothing of what is wanted are an error that names them") {
  const TemporaryFolder folder;
  recording::SensorLogWriter writer(folder / "rest");
  for (const Event& event : sim::record(sim::find_scenario("rest"), {.duration_s = 15.0}).events)
    writer.write(event);
  writer.flush();
  evaluation::DriveRequest request;
  request.logs = {folder / "rest"};
  request.wanted = {Quantity::mount};
  CHECK_THROWS_WITH(evaluation::calibrate_drive(request),
                    Contains("rest: not observable") && Contains("accelerate"));
  recording::SensorLogWriter ahead_writer(folder / "ahead");
  for (Event& event : sim::record(sim::find_scenario("drone"), {.duration_s = 40.0}).events) {
    if (auto* imu = std::get_if<ImuSample>(&event)) imu->sensor_time_ns += 1'000'000'000;
    ahead_writer.write(event);
  }
  ahead_writer.flush();
  request.logs = {folder / "ahead"};
  request.wanted = {Quantity::delay};
  CHECK_THROWS_WITH(evaluation::calibrate_drive(request),
                    Contains("ahead: no setting can correct it; delay: the stamps of the IMU are ") &&
                        Contains(" ms ahead of"));
  request.logs = {folder / "none"};
  CHECK_THROWS_AS(evaluation::calibrate_drive(request), files::IoError);
}

}  // namespace drive_calibration_test
