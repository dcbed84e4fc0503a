#include "system/car_run.hpp"

#include "recording/log_folder.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/recordings.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/statistics/quantile.hpp>

#include <algorithm>
#include <cmath>
#include <variant>

namespace sonopose::test {
namespace {

namespace topics = dds::topics;

/// Consumers of a run, created before it starts.
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

Distance distance_of(std::vector<double> differences) {
  double squares = 0.0;
  for (double& difference : differences) {
    difference = std::abs(difference);
    squares += difference * difference;
  }
  return {statistics::quantile(differences, 0.5),
          std::sqrt(squares / static_cast<double>(differences.size())),
          *std::max_element(differences.begin(), differences.end())};
}

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

CarPart part_of_car(std::size_t first_imu_sample, std::size_t imu_samples) {
  const auto cut = [&](auto& items, std::size_t last_imu_sample, const auto& is_imu) {
    std::size_t count = 0;
    std::erase_if(items, [&](const auto& item) {
      if (is_imu(item)) ++count;
      return count <= first_imu_sample || count > last_imu_sample;
    });
  };
  const std::size_t last = first_imu_sample + imu_samples;
  CarPart part{recording::read_sensor_log(car_folder).events,
               timed_frames(read_bytes(car_folder / "stream.bin"))};
  cut(part.events, last, [](const Event& event) { return std::holds_alternative<ImuSample>(event); });
  constexpr std::uint8_t imu_packet = 3;
  cut(part.frames, last + 10, [](const TimedFrame& frame) { return frame.bytes[2] == imu_packet; });
  const TimeNs begin_ns = part.frames.front().sent_after_ns;
  for (TimedFrame& frame : part.frames) frame.sent_after_ns -= begin_ns;
  return part;
}

LiveRun play_over_serial_line(const CarPart& part, const std::string& engine) {
  const Bus bus;
  Consumer<sonopose_FusedPose> poses(bus, topics::pose);
  Consumer<sonopose_ImuSample> imu(bus, topics::imu);
  Consumer<sonopose_UltrasonicFix> fixes(bus, topics::fix);
  Arguments settings = settings_of(engine);
  settings.emplace_back("--lossless");
  const auto fusion = bus.fusion(settings);
  const PseudoTerminal line;
  const auto bridge = bus.bridge({"--source", "serial", "--device", line.device()});
  REQUIRE(bridge->wait_for_line(Stream::error, "reading"));
  REQUIRE(imu.wait_for_writers());
  REQUIRE(fixes.wait_for_writers());
  REQUIRE(poses.wait_for_writers());
  send_in_time(part.frames, [&](std::span<const std::uint8_t> bytes) {
    line.send(bytes);
    poses.take();
    imu.take();
    fixes.take();
  });
  std::size_t imu_count = 0;
  std::size_t fix_count = 0;
  for (const Event& event : part.events) {
    if (std::holds_alternative<ImuSample>(event)) ++imu_count;
    if (std::holds_alternative<UltrasonicFix>(event)) ++fix_count;
  }
  REQUIRE(poses.wait_for_count(imu_count));
  REQUIRE(imu.wait_for_count(imu_count));
  REQUIRE(fixes.wait_for_count(fix_count));
  poses.samples.resize(imu_count);
  imu.samples.resize(imu_count);
  fixes.samples.resize(fix_count);
  return {std::move(poses.samples), std::move(imu.samples), std::move(fixes.samples)};
}

RunDistance distance_between(const std::vector<FusedPose>& run, const std::vector<FusedPose>& other) {
  std::vector<double> position_m;
  std::vector<double> velocity_mps;
  std::vector<double> yaw_rad;
  for (std::size_t k = 0; k < std::min(run.size(), other.size()); ++k) {
    position_m.push_back((run[k].position_world_m - other[k].position_world_m).norm());
    velocity_mps.push_back((run[k].velocity_world_mps - other[k].velocity_world_mps).norm());
    yaw_rad.push_back(geometry::wrap_angle(geometry::yaw_of(run[k].q_body_to_world) -
                                           geometry::yaw_of(other[k].q_body_to_world)));
  }
  REQUIRE_FALSE(position_m.empty());
  return {distance_of(position_m), distance_of(velocity_mps), distance_of(yaw_rad)};
}

bool car_is_here() {
  return is_here(car_folder / "stream.bin");
}

}  // namespace sonopose::test
