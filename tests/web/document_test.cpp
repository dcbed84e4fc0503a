#include "web/recording/document.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <array>
#include <limits>

namespace document_test {

using namespace sonopose;
using namespace sonopose::web::recording;
using nlohmann::json;

constexpr TimeNs begin_ns = 1'700'000'000'000'000'000;

SCENARIO("columns leave out rows that are too close together") {
  Columns columns({"x"}, begin_ns, 100'000'000);
  for (int i = 0; i < 10; ++i)
    columns.add(begin_ns + TimeNs{i} * 40'000'000, std::array{static_cast<double>(i)});
  const json read = json::parse(columns.json(100));
  CHECK(read["t"] == json({0.0, 0.12, 0.24, 0.36}));
  CHECK(read["x"] == json({0.0, 3.0, 6.0, 9.0}));
  CHECK(columns.size() == 4);
  CHECK(json::parse(columns.json(2))["x"] == json({0.0, 6.0}));
  CHECK(json::parse(columns.json(3))["t"].size() <= 3);
}

SCENARIO("columns have null for what is unknown") {
  Columns columns({"x", "y"}, begin_ns, 0);
  columns.add(begin_ns, std::array{std::numeric_limits<double>::quiet_NaN(), 2.5});
  CHECK(json::parse(columns.json(100)) == json({{"t", {0.0}}, {"x", {nullptr}}, {"y", {2.5}}}));
}

SCENARIO("a document has each beacon's samples, in seconds since the first") {
  Document document(10.0);
  CHECK_FALSE(document.has_poses());
  TruthSample truth;
  truth.address = 7;
  truth.time_ns = begin_ns;
  truth.position_world_m = {1, 2, 3};
  truth.q_body_to_world = geometry::rotation_about_z(0.25);
  document.add(truth);
  FusedPose pose;
  pose.address = 12;
  pose.time_ns = begin_ns + 500'000'000;
  pose.position_world_m = {4, 5, 6};
  document.add(pose);
  FixReport report;
  report.address = 12;
  report.applied_time_ns = begin_ns + 700'000'000;
  report.emission_time_ns = begin_ns + 600'000'000;
  report.position_world_m = {7, 8, 9};
  document.add(report);
  report.hypothesis = 1;  // of the second hypothesis, which made no pose
  report.applied_time_ns += 100'000'000;
  document.add(report);
  document.add(StationaryBeacon{.address = 3, .position_world_m = Vector3d(0, 1, 2)});
  document.add(StationaryBeacon{.address = 4, .position_world_m = {}});
  CHECK(document.has_poses());
  const json read = json::parse(document.json());
  CHECK(read["begin"].get<double>() == Approx(1.7e9).margin(1e-3));
  CHECK(read["duration"].get<double>() == Approx(0.7));
  CHECK(read["stationary"] == json::array({{{"a", 3}, {"x", 0.0}, {"y", 1.0}, {"z", 2.0}}}));
  REQUIRE(read["beacons"].size() == 2);
  CHECK(read["beacons"][0]["address"] == 7);
  CHECK(read["beacons"][0]["truth"]["yaw"][0].get<double>() == Approx(0.25));
  CHECK(read["beacons"][0]["poses"]["t"].empty());
  const json& beacon = read["beacons"][1];
  CHECK(beacon["address"] == 12);
  CHECK(beacon["poses"]["t"] == json({0.5}));
  CHECK(beacon["poses"]["z"] == json({6.0}));
  CHECK(beacon["fixes"]["t"] == json({0.7}));
  CHECK(beacon["fixes"]["t_emission"] == json({0.6}));
  CHECK(beacon["fixes"]["y"] == json({8.0}));
  CHECK(beacon["rows"] == 1);
}

SCENARIO("many beacons share the rows of a document") {
  constexpr int beacons = 40;
  constexpr int poses = 6000;
  Document document(240.0);
  FusedPose pose;
  for (int i = 0; i < poses; ++i) {
    pose.time_ns = begin_ns + TimeNs{i} * 40'000'000;
    for (int k = 1; k <= beacons; ++k) {
      pose.address = static_cast<BeaconAddress>(k);
      document.add(pose);
    }
  }
  const json read = json::parse(document.json());
  for (const json& beacon : read["beacons"]) {
    const std::size_t rows = beacon["poses"]["t"].size();
    CHECK(rows <= 5000);
    CHECK(rows >= 2500);
    CHECK(beacon["rows"].get<std::size_t>() >= rows);
  }
}

SCENARIO("a document has the changes of state as events") {
  Document document(10.0);
  FusedPose pose;
  pose.address = 7;
  for (int i = 0; i < 400; ++i) {
    pose.time_ns = begin_ns + TimeNs{i} * 10'000'000;
    pose.status = i < 100 ? status_initialising : 0U;
    if (i >= 200) pose.status = status_stale;
    document.add(pose);
  }
  const json read = json::parse(document.json());
  REQUIRE(read["events"].size() >= 2);
  bool has_stale = false;
  for (const json& event : read["events"]) {
    const double since_begin_s = event["t"].get<double>() - 1e-9 * static_cast<double>(begin_ns);
    CHECK(since_begin_s >= 0.0);
    CHECK(since_begin_s <= 4.0);
    const bool is_warning = event["level"] == "warning";
    has_stale = has_stale || (is_warning && since_begin_s == Approx(2.0).margin(0.5));
  }
  CHECK(has_stale);
}

}  // namespace document_test
