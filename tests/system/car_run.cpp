#include "system/car_run.hpp"

#include "support/beacon_bytes.hpp"
#include "support/pose_tap.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/recordings.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::test {
namespace {

namespace topics = dds::topics;

/// The consumers of a run, created before it starts.
struct Listeners {
  explicit Listeners(const Bus& bus) : poses(bus, topics::pose), reports(bus, topics::report) {}

  /// Waits for all samples of the recording.
  CarRun finish() {
    const bool all_poses = poses.wait_for_count(car_imu_samples);
    const bool all_reports = reports.wait_for_count(car_fixes);
    CHECK(all_poses);
    CHECK(all_reports);
    return {std::move(poses.samples), std::move(reports.samples)};
  }

  Consumer<sonopose_FusedPose> poses;
  Consumer<sonopose_FixReport> reports;
};

class Accumulator {
public:
  void add(double difference) {
    sum_ += difference * difference;
    max_ = std::max(max_, std::abs(difference));
    ++count_;
  }
  [[nodiscard]] Distance distance() const { return {std::sqrt(sum_ / static_cast<double>(count_)), max_}; }

private:
  double sum_ = 0;
  double max_ = 0;
  std::size_t count_ = 0;
};

Arguments settings_of(const std::string& engine) {
  Arguments settings = car_settings;
  settings.insert(settings.end(), {"--set", "fusion.engine=" + engine});
  return settings;
}

}  // namespace

CarRun play_car(const std::string& source, const std::string& engine, const Arguments& more) {
  const Bus bus;
  Listeners listeners(bus);
  Arguments settings = settings_of(engine);
  settings.insert(settings.end(), more.begin(), more.end());
  settings.emplace_back("--lossless");
  const auto fusion = bus.fusion(settings);
  REQUIRE(listeners.poses.wait_for_writers());
  REQUIRE(listeners.reports.wait_for_writers());
  const auto input = source == "log" ? car_folder : car_folder / "stream.bin";
  const auto bridge = bus.bridge({"--source", source, "--input", input.string(), "--rate", "0"});
  CarRun run = listeners.finish();
  CHECK(bridge->wait_for_exit() == 0);
  return run;
}

std::vector<FusedPose> play_car_over_serial_line(const std::string& engine, std::uint64_t until_sequence) {
  const Bus bus;
  const PoseTap poses(bus);
  const auto fusion = bus.fusion(settings_of(engine));
  const auto frames = timed_frames(read_bytes(car_folder / "stream.bin"));
  const PseudoTerminal line;
  Consumer<sonopose_ImuSample> imu(bus, topics::imu);
  const auto bridge = bus.bridge({"--source", "serial", "--device", line.device()});
  REQUIRE(bridge->wait_for_line(Stream::error, "reading"));
  REQUIRE(imu.wait_for_writers());
  send_in_time(frames, [&](std::span<const std::uint8_t> bytes) { line.send(bytes); });
  CHECK(poses.wait_for(
      [until_sequence](const TappedPose& tapped) { return tapped.pose.sequence >= until_sequence; }, 0));
  std::vector<FusedPose> live;
  for (const TappedPose& tapped : poses.since(0)) live.push_back(tapped.pose);
  return live;
}

std::vector<FusedPose> counterparts(const std::vector<FusedPose>& live, const CarRun& stream,
                                    const CarRun& log) {
  std::vector<FusedPose> counterparts;
  auto next = live.begin();
  for (std::size_t k = 0; k < stream.poses.size() && next != live.end(); ++k) {
    if (stream.poses[k].sequence != next->sequence) continue;
    counterparts.push_back(log.poses[k]);
    ++next;
  }
  return counterparts;
}

RunDistance distance_between(const std::vector<FusedPose>& run, const std::vector<FusedPose>& other) {
  Accumulator position;
  Accumulator velocity;
  Accumulator yaw;
  for (std::size_t k = 0; k < std::min(run.size(), other.size()); ++k) {
    position.add((run[k].position_world_m - other[k].position_world_m).norm());
    velocity.add((run[k].velocity_world_mps - other[k].velocity_world_mps).norm());
    yaw.add(geometry::wrap_angle(geometry::yaw_of(run[k].q_body_to_world) -
                                 geometry::yaw_of(other[k].q_body_to_world)));
  }
  return {position.distance(), velocity.distance(), yaw.distance()};
}

bool car_is_here() {
  return is_here(car_folder / "stream.bin");
}

}  // namespace sonopose::test
