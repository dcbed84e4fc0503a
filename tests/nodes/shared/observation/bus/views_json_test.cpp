#include "observation/bus/views_json.hpp"

#include "observation/stream_state.hpp"
#include "observation/views.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace views_json_test {

using namespace sonopose;
using namespace sonopose::observation;
using namespace sonopose::test;
using observation::bus::json_of;

SCENARIO("the JSON object has the documented keys") {
  GIVEN("a beacon with poses and a silent one") {
    const std::string text = json_of({good_view(), silent_view()}, {}, views_now_ns);
    const auto json = nlohmann::json::parse(text);
    REQUIRE(json["beacons"].size() == 2);
    const auto& good = json["beacons"][0];
    const auto& silent = json["beacons"][1];
    THEN("it is one line with a timestamp") {
      CHECK(text.find('\n') == std::string::npos);
      CHECK(json["time_ns"] == views_now_ns);
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
      CHECK(good["stream"] == "ok");
      CHECK(good["severity"] == 0);
      CHECK(good["reset_counter"] == 2);
      CHECK(good["pose_time_ns"] == views_now_ns - 1'000'000);
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
      CHECK(good["bridge"]["other_bridges"] == 0);
      CHECK(good["fusion"]["fixes_used"] == 110);
      CHECK(good["fusion"]["events_lost"] == 17);
      CHECK(good["fusion"]["imu_deadlines_missed"] == 3);
      CHECK(good["fusions"].size() == 1);
    }
    THEN("it has what the fusion has estimated, with null for what it does not") {
      BeaconView view = good_view();
      CHECK_FALSE(good.contains("estimate"));
      view.estimate = estimate();
      const auto estimated =
          nlohmann::json::parse(json_of({view}, {}, views_now_ns))["beacons"][0]["estimate"];
      CHECK(estimated["gyro_bias_radps"]["value"] == nlohmann::json({0.001, -0.002, 0.0305}));
      CHECK(estimated["gyro_bias_radps"]["std"] == nlohmann::json({0.0004, 0.0004, 0.0004}));
      CHECK(estimated["accelerometer_bias_mps2"]["value"][0] == 0.05);
      CHECK(estimated["lever_arm_m"]["std"][1] == 10.25);
      CHECK(estimated["fix_noise_m"]["value"] == 0.021);
      CHECK(estimated["fix_noise_m"]["std"].is_null());
      CHECK(estimated["heading_noise_rad"]["value"] == 0.0174532925199433);
      CHECK(estimated["delay_s"].is_null());
    }
    THEN("unknown values of the silent one are null or absent") {
      CHECK(silent["address"] == 21);
      CHECK(silent["stream"] == "silent");
      CHECK(silent["severity"] > bad_severity);
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
      CHECK(nlohmann::json::parse(json_of({}, {}, views_now_ns))["beacons"] == nlohmann::json::array());
    }
  }
}

SCENARIO("a text of the bus that is not UTF-8 is replaced") {
  const auto json = nlohmann::json::parse(json_of({}, {"bridge \xff"}, views_now_ns));
  CHECK(json["warnings"][0] == "bridge \ufffd");
}

}  // namespace views_json_test
