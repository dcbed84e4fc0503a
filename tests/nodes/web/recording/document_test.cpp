#include "web/recording/document.hpp"

#include "web/live/event_json.hpp"
#include "web/status_samples.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string>

namespace document_test {

using namespace sonopose;
using namespace sonopose::test;
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

SCENARIO("the delay of a fix is known to 0.1 ms after hours") {
  Columns columns({"t_emission"}, begin_ns, 0);
  columns.add(begin_ns + 20'000'080'300'000, std::array{20'000.0});
  const json read = json::parse(columns.json(100));
  CHECK(read["t"][0].get<double>() - read["t_emission"][0].get<double>() == Approx(0.0803).margin(1e-5));
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
  report.hypothesis = 1;  // the second hypothesis, which made no pose
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
  const std::string text = document.json();
  int found = 0;
  for (auto at = text.find("\"rows\":"); at != std::string::npos;
       at = text.find("\"rows\":", at + 1), ++found) {
    const auto begin =
        text.begin() + static_cast<std::ptrdiff_t>(text.find("\"t\":[", at) + 5);  // times of the poses
    const auto rows =
        1 + std::count(begin, std::find(begin, text.end(), ']'), ',');  // parsing would take seconds
    CHECK(rows <= 5000);
    CHECK(rows >= 2500);
    CHECK(std::stol(text.substr(at + 7, 10)) >= rows);
  }
  CHECK(found == beacons);
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

constexpr TimeNs second_ns = 1'000'000'000;

/// A pose that took 1 ms to the bridge, 2 ms to the fusion and 3 ms in it.
FusedPose traced_pose(TimeNs sensor_ns) {
  FusedPose pose;
  pose.address = 7;
  pose.time_ns = sensor_ns;
  pose.imu_sensor_time_ns = sensor_ns;
  pose.imu_bridge_time_ns = sensor_ns + 1'000'000;
  pose.fusion_in_time_ns = sensor_ns + 3'000'000;
  pose.fusion_out_time_ns = sensor_ns + 6'000'000;
  return pose;
}

SCENARIO("a document has one row a second of latencies, delay and battery") {
  Document document(10.0);
  FusionStatus serving{.address = 7, .fusion_id = 2, .time_ns = begin_ns, .role = FusionRole::serving};
  FusionStatus standby{.address = 7, .fusion_id = 1, .time_ns = begin_ns, .role = FusionRole::warming};
  constexpr TimeNs to_recorder_ns = 4'000'000;
  for (TimeNs time_ns = begin_ns; time_ns < begin_ns + 5 * second_ns; time_ns += 10'000'000) {
    document.advance(time_ns + 6'000'000 + to_recorder_ns);
    if ((time_ns - begin_ns) % second_ns == 0) {
      document.add(serving);
      document.add(standby);
      document.add(delay_estimate(7, 1, time_ns, 0.5));
      document.add(delay_estimate(7, 2, time_ns, 0.08));
      document.add(battery_status(7, time_ns, 3.9));
    }
    document.add(traced_pose(time_ns), time_ns + 6'000'000 + to_recorder_ns);
  }
  const json read = json::parse(document.json());
  REQUIRE(read["beacons"].size() == 1);
  const json& status = read["beacons"][0]["status"];
  REQUIRE(status["t"].size() == 5);
  CHECK(status["t"][1].get<double>() - status["t"][0].get<double>() == Approx(1.0).margin(0.02));
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(status["battery"][i].get<double>() == Approx(3.9));
    CHECK(status["delay"][i].get<double>() == Approx(0.08));  // delay of the serving fusion
    CHECK(status["sensor_to_bridge"][i].get<double>() == Approx(0.001));
    CHECK(status["bridge_to_fusion"][i].get<double>() == Approx(0.002));
    CHECK(status["in_fusion"][i].get<double>() == Approx(0.003));
    CHECK(status["fusion_to_here"][i].get<double>() == Approx(0.004));
  }
}

SCENARIO("a document has no row of a second without a pose, and null for what is not known") {
  Document document(10.0);
  document.advance(begin_ns);
  document.add(traced_pose(begin_ns));  // not received, so it has no latency
  document.add(
      battery_status(7, begin_ns - 1'000'000 * second_ns, 3.9));  // like the status of a replayed log
  document.add(battery_status(12, begin_ns, 3.9));                // a beacon without a pose
  document.advance(begin_ns + 8 * second_ns);                     // nothing was recorded in between
  document.add(traced_pose(begin_ns + 8 * second_ns));
  const json read = json::parse(document.json());
  CHECK(read["beacons"].size() == 1);
  CHECK(read["begin"].get<double>() == Approx(1e-9 * static_cast<double>(begin_ns)));
  CHECK(read["duration"].get<double>() == Approx(8.0));
  const json& status = read["beacons"][0]["status"];
  CHECK(status["t"] == json({0.0, 8.0}));
  CHECK(status["battery"] == json({3.9, 3.9}));
  CHECK(status["delay"] == json({nullptr, nullptr}));
  CHECK(status["in_fusion"] == json({nullptr, nullptr}));
}

SCENARIO("long recordings have a bounded number of status rows") {
  constexpr int hours = 12;
  Document document(hours * 3600.0);
  for (int i = 0; i < hours * 3600; ++i) {
    document.advance(begin_ns + i * second_ns);
    document.add(battery_status(7, begin_ns + i * second_ns, 3.9));
    document.add(traced_pose(begin_ns + i * second_ns));
  }
  const json read = json::parse(document.json());
  const std::size_t rows = read["beacons"][0]["status"]["t"].size();
  CHECK(rows <= 20'000);
  CHECK(rows >= 10'000);
}

/// Adds a beacon that becomes stale, which is an event.
void add_stale_beacon(Document& document) {
  FusedPose pose;
  pose.address = 7;
  for (int i = 0; i < 400; ++i) {
    pose.time_ns = begin_ns + TimeNs{i} * 10'000'000;
    pose.status = i < 200 ? 0U : status_stale;
    document.add(pose);
  }
}

bool is_stale(const json& event) {
  return event["text"].get<std::string>().starts_with("beacon 7: stale");
}

LogLine fusion_line(std::uint64_t number, TimeNs time_ns, const std::string& text) {
  return {.host = "robot",
          .process_id = 42,
          .number = number,
          .time_ns = time_ns,
          .program = "sonopose-fusion",
          .text = text};
}

bool is_derived(const json& event) {
  return !event.contains("program");
}

SCENARIO("lines of logs are events, and a change that the fusion logs is not derived from its poses") {
  Document document(10.0);
  add_stale_beacon(document);
  const auto events_now = [&] { return json::parse(document.json())["events"]; };
  WHEN("a bridge has logged, and the fusion its end") {
    LogLine line = fusion_line(1, begin_ns + 5 * second_ns, "no \xFF bytes");
    line.level = LogLevel::failure;
    document.add(line);
    line.program = "sonopose-bridge";
    line.level = LogLevel::warning;
    line.time_ns += second_ns;
    line.number = 2;
    document.add(line);
    const json events = events_now();
    THEN("the changes in the poses are events too, by their time") {
      CHECK(is_derived(events.front()));
      CHECK(events.back()["program"] == "sonopose-bridge");
      CHECK(events.back()["level"] == "warning");
      CHECK(events.back()["t"].get<double>() == Approx(1e-9 * static_cast<double>(line.time_ns)));
    }
  }
  WHEN("the fusion has logged the change, a moment later and with another figure") {
    const json before = events_now();
    REQUIRE(std::count_if(before.begin(), before.end(), is_stale) == 1);
    document.add(fusion_line(1, begin_ns + 3 * second_ns, "beacon 7: stale: no valid fix for 9.9 s"));
    const json events = events_now();
    THEN("it is not repeated") {
      CHECK(std::count_if(events.begin(), events.end(), is_stale) == 1);
      CHECK(std::none_of(events.begin(), events.end(),
                         [](const json& event) { return is_derived(event) && is_stale(event); }));
    }
  }
  WHEN("it has logged the same change a minute later") {
    document.add(fusion_line(1, begin_ns + 60 * second_ns, "beacon 7: stale: no valid fix for 1.0 s"));
    const json events = events_now();
    THEN("that is another one") {
      CHECK(std::count_if(events.begin(), events.end(), is_stale) == 2);
    }
  }
  WHEN("more lines were logged than a page shows") {
    for (int i = 0; i < 1000; ++i) {
      document.add(
          fusion_line(static_cast<std::uint64_t>(i) + 1, begin_ns + 10 * second_ns + i, std::to_string(i)));
    }
    const json events = events_now();
    THEN("the latest are shown, and the others counted") {
      REQUIRE(events.size() == web::live::max_events);
      CHECK(events.back()["text"] == "999");
      CHECK(events[1]["text"] ==
            std::to_string(1000 - (web::live::max_events - 1)));  // one event counts the others
      const json& former = events.front();
      CHECK(former["text"].get<std::string>().find("earlier events are not shown") != std::string::npos);
      CHECK(std::stoi(former["text"].get<std::string>()) >= 501);  // includes the changes of the poses
      CHECK_FALSE(events[1].contains("missing"));
    }
  }
  WHEN("lines are missing in the recording") {
    document.add(fusion_line(3, begin_ns + 10 * second_ns, "a"));
    document.add(fusion_line(7, begin_ns + 11 * second_ns, "b"));
    const json events = events_now();
    THEN("they are counted") {
      CHECK(events[events.size() - 2]["missing"] == 2);
      CHECK(events.back()["missing"] == 3);
    }
  }
}

SCENARIO("a document has no more events than the page shows lines, of which lost ones are one") {
  Document document(10.0);
  for (std::uint64_t i = 1; i <= 300; ++i) document.add(fusion_line(2 * i, begin_ns, "x"));
  const json events = json::parse(document.json())["events"];
  CHECK(events.size() == 1 + (web::live::max_events - 1) / 2);
  CHECK(events[0]["text"] == "51 earlier events are not shown");
}

SCENARIO("a document of one beacon has no lines about others") {
  Document document(10.0, BeaconAddress{7});
  document.add(fusion_line(1, begin_ns, "serving"));
  document.add(fusion_line(2, begin_ns, "beacon 12: found"));
  document.add(fusion_line(3, begin_ns, "beacon 7: found"));
  document.add(fusion_line(4, begin_ns, "beacon 7 has the transforms now, because beacon 12 is gone"));
  document.add(fusion_line(5, begin_ns, "beacon 72: found"));
  const json events = json::parse(document.json())["events"];
  REQUIRE(events.size() == 3);
  CHECK(events[0]["text"] == "serving");
  CHECK(events[1]["text"] == "beacon 7: found");
  CHECK_FALSE(events[1].contains("missing"));
}

}  // namespace document_test
