#include "web/live/live_state.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <limits>

namespace live_state_test {

using namespace sonopose;
using namespace sonopose::web::live;
using nlohmann::json;

constexpr TimeNs now_ns = 1'700'000'000'500'000'000;

FusedPose pose_of(BeaconAddress address) {
  FusedPose pose;
  pose.address = address;
  pose.time_ns = now_ns - 20'000'000;
  pose.position_world_m = {1.5, -2.25, 0.75};
  pose.q_body_to_world = geometry::rotation_about_z(0.5);
  pose.velocity_world_mps = {0.1, 0.2, 0.3};
  pose.trust = 0.9;
  pose.status = status_low_trust;
  pose.since_valid_fix_s = 0.05;
  return pose;
}

FixReport report_of(BeaconAddress address) {
  FixReport report;
  report.address = address;
  return report;
}

json frame_of(LiveState& state) {
  const std::string text = state.take_frame(now_ns);
  return text.empty() ? json() : json::parse(text);
}

SCENARIO("a frame has the latest pose of each beacon, once") {
  LiveState state;
  CHECK(state.take_frame(now_ns).empty());
  FusedPose pose = pose_of(7);
  state.on(pose);
  pose.position_world_m.x() = 1.75;
  state.on(pose);
  state.on(pose_of(9));
  const json frame = frame_of(state);
  CHECK(frame["op"] == "frame");
  CHECK(frame["t"].get<double>() == Approx(1'700'000'000.5).margin(1e-3));
  REQUIRE(frame["beacons"].size() == 2);
  const json& beacon = frame["beacons"][0];
  CHECK(beacon["a"] == 7);
  REQUIRE(beacon["pose"].size() == 18);
  CHECK(beacon["pose"][0].get<double>() == Approx(1'700'000'000.48).margin(1e-3));
  CHECK(beacon["pose"][1].get<double>() == 1.75);
  CHECK(beacon["pose"][2].get<double>() == -2.25);
  CHECK(beacon["pose"][6].get<double>() == Approx(0.5).margin(1e-4));
  CHECK(beacon["pose"][15].get<double>() == 0.9);
  CHECK(beacon["pose"][16] == status_low_trust);
  CHECK_FALSE(beacon.contains("truth"));
  CHECK_FALSE(beacon.contains("fixes"));
  CHECK(frame_of(state).is_null());
}

SCENARIO("a beacon that is initialised has no position yet") {
  LiveState state;
  FusedPose pose = pose_of(7);
  pose.status = status_initialising;
  state.on(pose);
  const json values = frame_of(state)["beacons"][0]["pose"];
  for (std::size_t i = 1; i <= 3; ++i) CHECK(values[i].is_null());
  CHECK_FALSE(values[4].is_null());  // the tilt is known
}

SCENARIO("what is unknown is null in a frame") {
  LiveState state;
  FusedPose pose = pose_of(7);  // its covariance is unknown
  pose.since_valid_fix_s = std::numeric_limits<double>::infinity();
  state.on(pose);
  state.on(report_of(7));
  const json frame = frame_of(state);
  const json& values = frame["beacons"][0]["pose"];
  for (const std::size_t i : {10U, 11U, 12U, 13U, 14U, 17U}) {
    CAPTURE(i);
    CHECK(values[i].is_null());
  }
  CHECK(frame["beacons"][0]["fixes"][0][8].is_null());  // test ratio
}

SCENARIO("a frame has the truth and every fix of the main hypothesis") {
  LiveState state;
  TruthSample truth;
  truth.address = 7;
  truth.time_ns = now_ns;
  truth.position_world_m = {1, 2, 3};
  state.on(truth);
  FixReport report = report_of(7);
  report.applied_time_ns = now_ns;
  report.position_world_m = {1.1, 2, 3};
  report.innovation_world_m = {0.1, 0, 0};
  report.flags = fix_used;
  state.on(report);
  report.hypothesis = 1;
  state.on(report);
  report.hypothesis = 0;
  report.flags = fix_outlier;
  report.test_ratio = 2.5;
  state.on(report);
  const json beacon = frame_of(state)["beacons"][0];
  CHECK_FALSE(beacon.contains("pose"));
  CHECK(beacon["truth"][3].get<double>() == 3);
  REQUIRE(beacon["fixes"].size() == 2);
  CHECK(beacon["fixes"][0][2].get<double>() == 1.1);
  CHECK(beacon["fixes"][0][10] == fix_used);
  CHECK(beacon["fixes"][1][8].get<double>() == 2.5);
}

SCENARIO("without a viewer, the newest fixes are kept") {
  LiveState state;
  FixReport report = report_of(7);
  for (int i = 0; i < 10'000; ++i) {
    report.position_world_m.x() = i;
    state.on(report);
  }
  const json fixes = frame_of(state)["beacons"][0]["fixes"];
  CHECK(fixes.size() <= 32);
  CHECK(fixes.back()[2].get<double>() == 9999);
}

SCENARIO("a new page gets the latest pose of a beacon that has stopped") {
  LiveState state;
  CHECK(state.latest(now_ns).empty());
  state.on(pose_of(7));
  frame_of(state);  // earlier pages' frame
  for (int i = 0; i < 2; ++i) {
    const json frame = json::parse(state.latest(now_ns));
    CHECK(frame["op"] == "frame");
    CHECK(frame["beacons"][0]["pose"][1].get<double>() == 1.5);
    CHECK_FALSE(frame["beacons"][0].contains("truth"));
  }
}

SCENARIO("a fix comes with what was done with it") {
  LiveState state;
  FixReport report = report_of(7);
  report.flags = fix_low_quality;  // its innovation was not computed
  state.on(report);
  report.flags = fix_used;
  report.weight = 0.4;
  report.innovation_world_m = {0.1, 0, 0};
  state.on(report);
  report.innovation_covariance_m2.emplace();  // as from an engine with gates
  state.on(report);
  const json fixes = frame_of(state)["beacons"][0]["fixes"];
  REQUIRE(fixes[0].size() == 12);
  CHECK(fixes[0][5].is_null());
  CHECK(fixes[0][11] == static_cast<int>(FixVerdict::rejected));
  CHECK(fixes[1][5].get<double>() == 0.1);
  CHECK(fixes[1][11] == static_cast<int>(FixVerdict::used));
  CHECK(fixes[2][11] == static_cast<int>(FixVerdict::down_weighted));
}

}  // namespace live_state_test
