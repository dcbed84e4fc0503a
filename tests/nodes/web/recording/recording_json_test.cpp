#include "web/recording/recording_json.hpp"

#include "bus_log/recorded.hpp"
#include "sim/simulator.hpp"
#include "support/temporary_folder.hpp"
#include "web/status_samples.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::recording_json_test {

using namespace sonopose::test;
using namespace sonopose::web::recording;
using Catch::Contains;
using nlohmann::json;

constexpr BeaconAddress beacon = 7;

sim::Recording walk() {
  sim::Recording recording = sim::record(sim::find_scenario("walk"), {.duration_s = 20.0});
  for (Event& event : recording.events) {
    std::visit([](auto& sample) { sample.address = beacon; }, event);
  }
  for (TruthSample& truth : recording.truth) truth.address = beacon;
  return recording;
}

std::uint64_t log_time(TimeNs time_ns) {
  return static_cast<std::uint64_t>(time_ns);
}

void write_inputs(BusRecording& file, const sim::Recording& recording) {
  for (const Event& event : recording.events) file.write(event, log_time(available_at_ns(event)));
  for (const TruthSample& truth : recording.truth) {
    file.write(dds::topics::truth, dds::topics::to_idl(truth), log_time(truth.time_ns));
  }
}

SCENARIO("a recording without poses shows what the fusion makes of it") {
  const TemporaryFolder folder;
  const auto file = folder / "inputs.mcap";
  {
    BusRecording recording(file);
    write_inputs(recording, walk());
  }
  const json read = json::parse(recording_json({file}));
  REQUIRE(read["beacons"].size() == 1);
  const json& shown = read["beacons"][0];
  CHECK(read["duration"].get<double>() == Approx(20.0).margin(0.5));
  THEN("the poses are near the truth") {
    const json& poses = shown["poses"];
    const json& truth = shown["truth"];
    const double end_x = poses["x"].back().get<double>() - truth["x"].back().get<double>();
    const double end_y = poses["y"].back().get<double>() - truth["y"].back().get<double>();
    CHECK(std::hypot(end_x, end_y) < 0.1);
    CHECK(shown["fixes"]["t"].size() > 50);
  }
  THEN("nothing is known of latency, delay and battery") {
    CHECK(shown["status"]["t"].empty());
  }
  THEN("another beacon's address is refused") {
    CHECK_THROWS_WITH(recording_json({file}, 99), Contains("99"));
  }
}

SCENARIO("a recording with poses shows those, of all beacons or one") {
  const TemporaryFolder folder;
  const auto file = folder / GENERATE("run.mcap", "run.mcap.part");  // .part: from a killed recorder
  {
    BusRecording recording(file);
    FusedPose pose;
    for (int i = 0; i < 100; ++i) {
      pose.time_ns = 1'700'000'000'000'000'000 + TimeNs{i} * 50'000'000;
      for (const BeaconAddress address : {BeaconAddress{7}, BeaconAddress{12}}) {
        pose.address = address;
        pose.position_world_m = {0.01 * i, address * 1.0, 0.5};
        recording.write(dds::topics::pose, dds::topics::to_idl(pose), log_time(pose.time_ns));
      }
    }
  }
  const json all = json::parse(recording_json({file}));
  REQUIRE(all["beacons"].size() == 2);
  CHECK(all["beacons"][1]["poses"]["y"].back() == 12.0);
  CHECK(all["beacons"][1]["poses"]["x"].size() == 100);
  const json one = json::parse(recording_json({file}, 12));
  REQUIRE(one["beacons"].size() == 1);
  CHECK(one["beacons"][0]["address"] == 12);
}

/// Writes three seconds of poses, and every second the statuses and a log line of bridge and fusion.
void write_statuses(BusRecording& recording, BeaconAddress address) {
  namespace topics = dds::topics;
  constexpr TimeNs begin_ns = 1'700'000'000'000'000'000;
  for (int i = 0; i < 60; ++i) {
    FusedPose pose;
    pose.address = address;
    pose.time_ns = begin_ns + TimeNs{i} * 50'000'000;
    pose.imu_sensor_time_ns = pose.time_ns;
    pose.imu_bridge_time_ns = pose.time_ns + 2'000'000;
    pose.fusion_in_time_ns = pose.time_ns + 3'000'000;
    pose.fusion_out_time_ns = pose.time_ns + 3'500'000;
    const std::uint64_t at = log_time(pose.time_ns + 4'000'000);
    recording.write(topics::pose, topics::to_idl(pose), at);
    if (i % 20 != 0) continue;
    recording.write(topics::beacon_status, topics::to_idl(battery_status(address, pose.time_ns, 3.7)), at);
    recording.write(topics::fusion_status,
                    topics::to_idl(FusionStatus{.address = address, .fusion_id = 5, .time_ns = pose.time_ns}),
                    at);
    recording.write(topics::estimate, topics::to_idl(delay_estimate(address, 5, pose.time_ns, 0.09)), at);
    recording.write(topics::log,
                    topics::to_idl(LogLine{.host = "robot",
                                           .process_id = 1,
                                           .time_ns = pose.time_ns,
                                           .program = "sonopose-bridge",
                                           .text = "second " + std::to_string(i / 20)}),
                    at);
  }
}

SCENARIO("a recording with statuses shows latency, delay, battery and the lines of the logs") {
  const TemporaryFolder folder;
  const auto file = folder / "run.mcap";
  {
    BusRecording recording(file);
    write_statuses(recording, beacon);
  }
  const json read = json::parse(recording_json({file}));
  const json& status = read["beacons"][0]["status"];
  REQUIRE(status["t"].size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(status["battery"][i].get<double>() == Approx(3.7));
    CHECK(status["delay"][i].get<double>() == Approx(0.09));
    CHECK(status["sensor_to_bridge"][i].get<double>() == Approx(0.002));
    CHECK(status["bridge_to_fusion"][i].get<double>() == Approx(0.001));
    CHECK(status["in_fusion"][i].get<double>() == Approx(0.0005));
    CHECK(status["fusion_to_here"][i].get<double>() == Approx(0.0005));
  }
  const json& events = read["events"];
  const auto lines = std::count_if(events.begin(), events.end(), [](const json& event) {
    return event.value("program", "") == "sonopose-bridge" &&
           event["text"].get<std::string>().starts_with("second");
  });
  CHECK(lines == 3);
}

SCENARIO("statuses of another type are left out, and the poses are shown") {
  const TemporaryFolder folder;
  const auto file = folder / "run.mcap";
  {
    BusRecording recording(file);
    const auto schema = recording.writer().add_schema(
        "sonopose::BeaconStatus", "omgidl", "module sonopose { struct BeaconStatus { long a; }; };");
    const auto channel = recording.writer().add_channel(schema, "sonopose/beacon_status", "cdr");
    write_statuses(recording, beacon);
    recording.writer().write({channel, 1, log_time(1'700'000'000'000'000'000), 0, {}});
  }
  const json read = json::parse(recording_json({file}));
  CHECK(read["beacons"][0]["poses"]["t"].size() > 50);
  const json& status = read["beacons"][0]["status"];
  CHECK(status["battery"] == json({3.7, 3.7, 3.7}));  // statuses of our type only
  CHECK_THAT(status["delay"].dump(), Contains("0.09"));
}

SCENARIO("poses of another type are refused") {
  const TemporaryFolder folder;
  const auto file = folder / "run.mcap";
  {
    BusRecording recording(file);
    const auto schema = recording.writer().add_schema("sonopose::FusedPose", "omgidl",
                                                      "module sonopose { struct FusedPose { long a; }; };");
    recording.writer().add_channel(schema, "sonopose/pose", "cdr");
    recording.write(dds::topics::reset, {.address = 7, .request_id = 1}, 5);
  }
  CHECK_THROWS_WITH(recording_json({file}), Contains("topic sonopose/pose has another type"));
}

SCENARIO("a file that is no recording is refused with its name") {
  const TemporaryFolder folder;
  const auto file = folder / "broken.mcap";
  write_text(file, "no recording at all");
  CHECK_THROWS_WITH(recording_json({file}), Contains("broken.mcap"));
  CHECK_THROWS_WITH(recording_json({folder / "absent"}), Contains("absent"));
  const auto empty = folder / "empty.mcap";
  { BusRecording(empty).close(); }
  CHECK_THROWS_WITH(recording_json({empty}), Contains("empty.mcap"));
}

}  // namespace sonopose::recording_json_test
