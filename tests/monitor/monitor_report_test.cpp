#include "monitor/monitor_report.hpp"

#include "observation/bus/views_json.hpp"
#include "observation/status_words.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

namespace monitor_report_test {

using namespace sonopose;
using namespace sonopose::monitor;
using namespace sonopose::observation;
using Catch::Contains;
using Catch::StartsWith;
using observation::bus::json_of;

constexpr TimeNs now_ns = 1'700'000'000'123'456'789;

/// A beacon with a good pose, turned 90° to the left; all values are known.
BeaconView good_view() {
  BeaconView view;
  view.address = 7;
  view.window_s = 1.0;
  view.poses = 100;
  view.pose_rate_hz = 100.0;
  view.latency = {0.00012, 0.00034};
  view.pose.position_world_m = {1.5, -2.25, 0.75};
  view.pose.velocity_world_mps = {3.0, 4.0, 0.0};
  view.pose.q_body_to_world = Quaterniond(std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5));
  view.pose.since_valid_fix_s = 0.05;
  view.pose.time_ns = now_ns - 1'000'000;
  view.pose.reset_counter = 2;
  view.bridge.emplace();
  view.bridge->battery_v = 3.9;
  view.bridge->imu_rate_hz = 99.5;
  view.bridge->fix_rate_hz = 12.0;
  view.bridge->crc_errors = 4;
  view.bridge->other_bridges = 1;
  view.fusion.emplace();
  view.fusion->fixes_used = 110;
  view.fusion->fixes_down_weighted = 9;
  view.fusion->fixes_rejected = 6;
  view.fusion->fixes_late = 2;
  view.fusion->events_lost = 17;
  view.fusion->imu_deadlines_missed = 3;
  view.fusions = {*view.fusion};
  view.deadlines_missed = 8;
  view.losses = 2;
  view.predicted = 5;
  view.segments = {{{0.001, 0.002}, {0.00005, 0.00011}, {0.00001, 0.00002}, {0.00006, 0.00021}}};
  view.worst = PoseTrace{.sequence = 812,
                         .sensor_ns = now_ns - 3'000'000,
                         .bridge_ns = now_ns - 2'000'000,
                         .fusion_in_ns = now_ns - 1'500'000,
                         .fusion_out_ns = now_ns - 1'250'000,
                         .here_ns = now_ns};
  view.position_error_rms_m = 0.021;
  view.position_error_max_m = 0.055;
  return view;
}

/// What a fusion that estimates all but the delay has found.
Estimate estimate() {
  Estimate estimate;
  estimate.gyro_bias_body_radps = {Vector3d(0.001, -0.002, 0.0305), Vector3d::Constant(0.0004)};
  estimate.accelerometer_bias_body_mps2 = {Vector3d(0.05, 0, 0), Vector3d::Constant(0.01)};
  estimate.lever_arm_body_m = {Vector3d(0.1, 0.02, -12.5), Vector3d(0.003, 10.25, 0.003)};
  estimate.fix_noise_m = {0.021, -1.0};
  estimate.heading_noise_rad = {0.0174532925199433, 0.00174532925199433};
  return estimate;
}

/// A beacon of which only the address is known.
BeaconView silent_view() {
  BeaconView view;
  view.address = 21;
  view.latency = percentiles_of({});
  view.segments.fill(percentiles_of({}));
  view.pose.since_valid_fix_s = std::numeric_limits<double>::infinity();
  return view;
}

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST_CASE("every status bit has its own name") {
  CHECK(observation::status_words(0) == "ok");
  CHECK(observation::status_words(status_stale | status_frozen_track) == "stale, frozen track");
  std::set<std::string> words;
  for (std::uint32_t bit = status_initialising; bit <= status_overloaded; bit <<= 1U) {
    const std::string word = observation::status_words(bit);
    CHECK(!word.empty());
    CHECK(word != "ok");
    words.insert(word);
  }
  CHECK(words.size() == 12);
}

SCENARIO("the JSON object has the documented keys") {
  GIVEN("a beacon with poses and a silent one") {
    const std::string text = json_of({good_view(), silent_view()}, {}, now_ns);
    const auto json = nlohmann::json::parse(text);
    REQUIRE(json["beacons"].size() == 2);
    const auto& good = json["beacons"][0];
    const auto& silent = json["beacons"][1];
    THEN("it is one line with a timestamp") {
      CHECK(lines_in(text) == 0);
      CHECK(json["time_ns"] == now_ns);
    }
    THEN("the first has rates, pose and latency in SI units") {
      CHECK(good["address"] == 7);
      CHECK(good["pose_rate_hz"] == 100.0);
      CHECK(good["latency_p50_s"] == 0.00012);
      CHECK(good["latency_p99_s"] == 0.00034);
      CHECK(good["position_m"] == nlohmann::json({1.5, -2.25, 0.75}));
      CHECK(good["heading_deg"].get<double>() == Approx(90.0));
      CHECK(good["speed_mps"].get<double>() == Approx(5.0));
      CHECK(good["status_words"] == "ok");
      CHECK(good["reset_counter"] == 2);
      CHECK(good["pose_time_ns"] == now_ns - 1'000'000);
      CHECK(good["pose_deadlines_missed"] == 8);
      CHECK(good["pose_losses"] == 2);
      CHECK(good["predicted"] == 5);
      CHECK(good["latency_segments"]["fusion_to_here"]["p99_s"] == 0.00021);
      CHECK(good["worst"]["event_sequence"] == 812);
      CHECK(good["worst"]["latency_s"].get<double>() == Approx(0.002));
      CHECK(good["position_error_max_m"] == 0.055);
    }
    THEN("it has the statuses of bridge and fusion") {
      CHECK(good["bridge"]["imu_rate_hz"] == 99.5);
      CHECK(good["bridge"]["battery_v"] == 3.9);
      CHECK(good["bridge"]["rssi_dbm"].is_null());
      CHECK(good["bridge"]["crc_errors"] == 4);
      CHECK(good["bridge"]["other_bridges"] == 1);
      CHECK(good["fusion"]["fixes_used"] == 110);
      CHECK(good["fusion"]["events_lost"] == 17);
      CHECK(good["fusion"]["imu_deadlines_missed"] == 3);
      CHECK(good["fusions"].size() == 1);
    }
    THEN("it has what the fusion has estimated, with null for what it does not") {
      BeaconView view = good_view();
      CHECK_FALSE(good.contains("estimate"));
      view.estimate = estimate();
      const auto estimated = nlohmann::json::parse(json_of({view}, {}, now_ns))["beacons"][0]["estimate"];
      CHECK(estimated["gyro_bias_radps"]["value"] == nlohmann::json({0.001, -0.002, 0.0305}));
      CHECK(estimated["gyro_bias_radps"]["std"] == nlohmann::json({0.0004, 0.0004, 0.0004}));
      CHECK(estimated["accelerometer_bias_mps2"]["value"][0] == 0.05);
      CHECK(estimated["lever_arm_m"]["std"][1] == 10.25);
      CHECK(estimated["fix_noise_m"]["value"] == 0.021);
      CHECK(estimated["fix_noise_m"]["std"].is_null());
      CHECK(estimated["heading_noise_rad"]["value"] == 0.0174532925199433);
      CHECK(estimated["delay_s"].is_null());
      CHECK(estimated["heading_offset_rad"].is_null());
    }
    THEN("unknown values of the silent one are null or absent") {
      CHECK(silent["address"] == 21);
      CHECK(silent["latency_p50_s"].is_null());
      CHECK(silent["position_error_rms_m"].is_null());
      CHECK(silent["since_valid_fix_s"].is_null());
      CHECK(silent["worst"].is_null());
      CHECK(silent["latency_segments"]["in_fusion"]["p50_s"].is_null());
      CHECK_FALSE(silent.contains("bridge"));
      CHECK_FALSE(silent.contains("fusion"));
    }
  }
  GIVEN("no beacon") {
    THEN("the list is empty") {
      CHECK(nlohmann::json::parse(json_of({}, {}, now_ns))["beacons"] == nlohmann::json::array());
    }
  }
}

SCENARIO("the table has a row for each beacon") {
  GIVEN("a beacon with poses and a silent one") {
    const std::string table = table_of({good_view(), silent_view()});
    THEN("a row has rates, position, heading, speed, latency in milliseconds, losses and status") {
      CHECK(lines_in(table) >= 3);
      const std::string row = table.substr(table.find('\n') + 1, table.find('\n', table.find('\n') + 1));
      for (const char* part : {"7", "100.0", "99.5", "12.0", "1.500", "-2.250", "0.750", "90.0°", "5.00",
                               "0.12", "0.34", "17", "ok"}) {
        CHECK_THAT(row, Contains(part));
      }
      CHECK_THAT(table, Contains("    21  ") && Contains("silent"));
    }
    THEN("what is not known of the silent one is marked, not zero") {
      const std::string row = table.substr(table.find("    21  "));
      CHECK_THAT(
          row.substr(0, row.find('\n')),
          StartsWith("    21    0.0/    –/   –        –       –       –       –°") && !Contains("0.00"));
    }
    THEN("the latency segments and the slowest pose follow, in milliseconds") {
      CHECK_THAT(table, Contains("1.00/2.00") && Contains("0.05/0.11") && Contains("0.01/0.02") &&
                            Contains("0.06/0.21") && Contains("2.00 = 0.50 + 0.25 + 1.25 (event 812)"));
    }
    THEN("the problem counters of each process follow, without processes that counted none") {
      CHECK_THAT(table,
                 Contains("7  bridge: 4 damaged frames, 1 other bridges\n") &&
                     Contains("7  fusion: 2 fixes too late, 3 IMU deadlines missed, 17 events lost\n") &&
                     Contains("7  here: 8 pose deadlines missed, 2 pose stream losses\n") &&
                     !Contains("21  here"));
    }
  }
  GIVEN("a beacon whose fusion estimates the sensors") {
    BeaconView view = good_view();
    view.estimate = estimate();
    const std::string table = table_of({view, silent_view()});
    THEN("each value has its unit and standard deviation, and what is not estimated is listed") {
      CHECK_THAT(table,
                 Contains("beacon  estimated                        x               y               z\n"
                          "     7  gyro bias            0.0010±0.0004  -0.0020±0.0004   0.0305±0.0004 rad/s\n"
                          "     7  accelerometer bias   0.0500±0.0100   0.0000±0.0100   0.0000±0.0100 m/s²\n"
                          "     7  lever arm            0.1000±0.0030  0.0200±10.2500 -12.5000±0.0030 m\n"
                          "     7  fix noise                   0.0210 m\n"
                          "     7  heading noise        1.0000±0.1000 deg\n"
                          "     7  not estimated: delay, heading offset\n"));
    }
    THEN("no line of it is longer than 80 columns, even without any value") {
      view.estimate = Estimate{};
      const std::string nothing = table_of({view});
      for (const std::string& text : {table, nothing}) {
        std::istringstream lines(text.substr(text.find("beacon  estimated")));
        for (std::string line; std::getline(lines, line) && !line.empty();) {
          CAPTURE(line);
          const auto is_first_byte = [](char byte) {
            return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
          };
          CHECK(std::count_if(line.begin(), line.end(), is_first_byte) <= 80);
        }
      }
      CHECK_THAT(nothing, Contains("     7  not estimated: gyro bias, accelerometer bias, lever arm, delay,\n"
                                   "          fix noise, heading noise, heading offset\n"));
    }
  }
  GIVEN("a beacon without a pose writer, and one with a silent IMU") {
    BeaconView lost = good_view();
    lost.lost = true;
    BeaconView silent = good_view();
    silent.fusion->imu_silent = true;
    THEN("the status column shows it") {
      CHECK_THAT(table_of({lost}), Contains("17  lost\n"));
      CHECK_THAT(table_of({silent}), Contains("IMU silent"));
    }
  }
  GIVEN("a beacon with a standby") {
    BeaconView view = good_view();
    view.fusions.front().role = FusionRole::serving;
    view.fusions.front().strength = 200;
    FusionStatus standby;
    standby.role = FusionRole::serving;
    standby.strength = 100;
    standby.imu_gaps = 1;
    view.fusions.push_back(standby);
    THEN("the counters of each fusion are listed with its strength") {
      CHECK_THAT(table_of({view}), Contains("fusion of strength 200 (serving): 2 fixes too late, 3 IMU") &&
                                       Contains("fusion of strength 100 (serving): 1 IMU gaps"));
    }
  }
}

SCENARIO("the summary describes a run") {
  THEN("a run with a beacon: rates, latency, error, fixes and losses") {
    const std::string summary = summary_of({good_view()});
    CHECK_THAT(summary, Contains("beacon 7") && Contains("100.0 Hz") && Contains("p50 0.12 ms") &&
                            Contains("p99 0.34 ms") && Contains("2.1 cm RMS") && Contains("5.5 cm at most") &&
                            Contains("110 used, 9 of them down-weighted, 6 rejected (2 too late)") &&
                            Contains("17 events") && Contains("8 pose deadlines"));
  }
  THEN("a beacon without ground truth: no error") {
    CHECK_THAT(summary_of({silent_view()}), Contains("beacon 21") && !Contains("error"));
  }
  THEN("a run without a beacon") {
    CHECK(summary_of({}) == "no pose received\n");
  }
}

}  // namespace monitor_report_test
