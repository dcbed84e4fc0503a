/// The real recording: 112 s of a car with a pair of beacons, through the real programs.

#include "support/poses_of.hpp"
#include "system/car_run.hpp"
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <string>

namespace car_test {

using namespace sonopose;
using namespace sonopose::test;

constexpr TimeNs drives_from_ns = car_epoch_ns + 45'000'000'000;
constexpr TimeNs drives_until_ns = car_epoch_ns + 94'000'000'000;
constexpr TimeNs freezes_ns = car_epoch_ns + 94'400'000'000;

bool is_driving(TimeNs time_ns) {
  return time_ns >= drives_from_ns && time_ns <= drives_until_ns;
}

/// Recorded wheel speed over time, interpolated linearly.
class WheelSpeed {
public:
  WheelSpeed() {
    std::ifstream file(car_folder / "wheel_speed.csv");
    for (std::string line; std::getline(file, line);) {
      if (line.empty() || line.front() == '#') continue;
      samples_.emplace_back(std::stoll(line), std::stod(line.substr(line.find(',') + 1)));
    }
  }

  [[nodiscard]] double at(TimeNs time_ns) const {
    const auto after = std::lower_bound(samples_.begin() + 1, samples_.end() - 1, time_ns,
                                        [](const auto& sample, TimeNs time) { return sample.first < time; });
    const auto before = std::prev(after);
    const double share =
        seconds_between(before->first, time_ns) / seconds_between(before->first, after->first);
    return before->second + share * (after->second - before->second);
  }

private:
  std::vector<std::pair<TimeNs, double>> samples_;
};

struct SpeedCheck {
  double difference_rms_mps = 0;
  double fastest_mps = 0;
};

SpeedCheck compare_with_wheels(const std::vector<FusedPose>& poses) {
  const WheelSpeed wheels;
  double squares = 0;
  double count = 0;
  double fastest_mps = 0;
  for (const FusedPose& pose : poses) {
    if (!is_driving(pose.time_ns)) continue;
    const double speed_mps = pose.velocity_world_mps.norm();
    const double difference_mps = speed_mps - wheels.at(pose.time_ns);
    squares += difference_mps * difference_mps;
    fastest_mps = std::max(fastest_mps, speed_mps);
    ++count;
  }
  return {std::sqrt(squares / count), fastest_mps};
}

/// RMS distance between each used fix, extrapolated to the engine's time, and the pose before its correction.
double distance_to_fixes_m(const CarRun& run) {
  double squares = 0;
  double count = 0;
  for (const FixReport& report : run.reports) {
    if (!is_driving(report.applied_time_ns) || (report.flags & fix_used) == 0U) continue;
    const auto after =
        std::upper_bound(run.poses.begin(), run.poses.end(), report.applied_time_ns,
                         [](TimeNs time, const FusedPose& pose) { return time < pose.time_ns; });
    squares += (std::prev(after)->position_world_m - report.shifted_position_world_m).squaredNorm();
    ++count;
  }
  REQUIRE(count > 0.8 * 49 * 10);  // ten fixes per second, few rejected
  return std::sqrt(squares / count);
}

/// Checks the effect of the protocol's resolution on a pose. Stamps are truncated to 1 ms: 1.5 mm at the
/// car's 1.5 m/s. Fixes have steps of 1 mm. Headings have steps of 0.1°: half a step is 0.9 mrad, which turns
/// the velocity by 1.4 mm/s. The gyro's 0.0175 deg/s contributes less. Accelerations have steps of 1 mg: over
/// the half second between corrections, half a step is 2.5 mm/s and 0.6 mm. One millisecond can also change
/// the earlier fix from which the velocity is measured. The total is about 4 mm, 4 mm/s and 1 mrad. Single
/// poses, in turns or where a fix moves past an IMU sample, differ five times as much.
void check_wire_steps(const RunDistance& distance) {
  CHECK(distance.position_m.rms <= 0.005);
  CHECK(distance.position_m.max <= 0.025);
  CHECK(distance.velocity_mps.rms <= 0.005);
  CHECK(distance.velocity_mps.max <= 0.025);
  CHECK(distance.yaw_rad.rms <= 0.001);
  CHECK(distance.yaw_rad.max <= 0.005);
}

void print(const char* what, const RunDistance& distance) {
  std::cout << what << ": position " << distance.position_m.rms << " m RMS, " << distance.position_m.max
            << " m at most; velocity " << distance.velocity_mps.rms << ", " << distance.velocity_mps.max
            << " m/s; yaw " << distance.yaw_rad.rms << ", " << distance.yaw_rad.max << " rad\n";
}

SCENARIO("the fused pose of the recorded car agrees with its wheel speed") {
  if (!car_is_here()) return;
  GIVEN("the recording, played as fast as possible to either engine") {
    const std::string engine = GENERATE("documented", "kalman");
    CAPTURE(engine);
    static std::map<std::string, CarRun> runs;
    if (!runs.contains(engine)) runs[engine] = play_car("log", engine);
    const CarRun& run = runs[engine];
    REQUIRE(run.poses.size() == car_imu_samples);
    THEN("the fused speed follows the wheel speed between 45 s and 94 s") {
      const SpeedCheck speed = compare_with_wheels(run.poses);
      std::cout << engine << ": speed against the wheels: " << speed.difference_rms_mps
                << " m/s RMS, fastest " << speed.fastest_mps << " m/s\n";
      CHECK(speed.difference_rms_mps <= 0.17);
      CHECK(speed.fastest_mps <= 2.5);
    }
    THEN("the pose stays near the delay-compensated fixes") {
      const double distance_m = distance_to_fixes_m(run);
      std::cout << engine << ": pose against the shifted fixes: " << distance_m << " m RMS\n";
      CHECK(distance_m <= 0.10);
    }
    THEN("after the fixes freeze, the pose stays finite and bounded, and the status reports it") {
      const Vector3d spot_world_m = run.reports.back().position_world_m;
      TimeNs reported_ns = 0;  // start of the uninterrupted report
      double farthest_m = 0;
      double fastest_mps = 0;
      for (const FusedPose& pose : run.poses) {
        REQUIRE(pose.position_world_m.allFinite());
        REQUIRE(pose.velocity_world_mps.allFinite());
        REQUIRE(pose.q_body_to_world.coeffs().allFinite());
        if (pose.time_ns < freezes_ns) continue;
        const bool is_frozen = (pose.status & status_frozen_track) != 0U;
        if (!is_frozen) reported_ns = 0;
        if (is_frozen && reported_ns == 0) reported_ns = pose.time_ns;
        farthest_m = std::max(farthest_m, (pose.position_world_m - spot_world_m).norm());
        fastest_mps = std::max(fastest_mps, pose.velocity_world_mps.norm());
      }
      std::cout << engine << ": after the freeze at most " << farthest_m << " m from the spot and "
                << fastest_mps << " m/s\n";
      REQUIRE(reported_ns != 0);
      CHECK(seconds_between(freezes_ns, reported_ns) < 3.0);
      CHECK(farthest_m <= 5.0);
      if (engine == "kalman") CHECK(fastest_mps <= 1.3);  // the wheels turn at up to 1.06 m/s
    }
  }
}

SCENARIO("the car's raw bytes give the poses of its log, up to the resolution of the protocol") {
  if (!car_is_here()) return;
  GIVEN("the log and the raw bytes, played as fast as possible to the documented engine") {
    const CarRun log = play_car("log", "documented");
    const CarRun stream = play_car("stream", "documented");
    THEN("the poses are equal up to the resolution of the protocol") {
      REQUIRE(log.poses.size() == car_imu_samples);
      REQUIRE(stream.poses.size() == car_imu_samples);
      const RunDistance distance = distance_between(stream.poses, log.poses);
      print("stream against log", distance);
      check_wire_steps(distance);
    }
  }
}

/// Poses of an engine in this process.
std::vector<FusedPose> poses_of_log(const std::vector<Event>& events) {
  settings::Settings settings;
  settings::set(settings, "fusion.engine", "documented");
  settings::set(settings, "heading.mount_offset_deg", 86.0);
  estimation::AnyEstimator engine{settings};
  return poses_of(engine, events);
}

/// Range of the differences of two series of times, from index `first`.
double spread_ms(const std::vector<TimeNs>& a, const std::vector<TimeNs>& b, std::size_t first) {
  std::vector<double> differences_ms;
  for (std::size_t k = first; k < a.size(); ++k)
    differences_ms.push_back(1e-6 * static_cast<double>(a[k] - b[k]));
  const auto [least, most] = std::minmax_element(differences_ms.begin(), differences_ms.end());
  return *most - *least;
}

SCENARIO("the car's raw bytes over a serial line, in real time, give the poses of its log") {
  if (!car_is_here()) return;
  GIVEN("a pseudo-terminal that carries 10 s of the recorded bytes at the original rate: the car starts") {
    const CarPart part = part_of_car(4'050, 1'000);
    const std::vector<FusedPose> log = poses_of_log(part.events);
    const LiveRun live = play_over_serial_line(part, "documented");
    THEN("the poses are equal up to the resolution of the protocol, despite the arrival jitter") {
      REQUIRE(log.size() == 1'000);
      REQUIRE(live.poses.size() == log.size());
      REQUIRE(live.imu.size() == log.size());
      std::vector<TimeNs> measured_ns;
      double latest_ms = 0;  // largest additional delay of a fix compared with the log
      auto live_fix = live.fixes.begin();
      const auto delay_ns = [](const UltrasonicFix& fix) {
        return fix.received_time_ns - fix.emission_time_ns;
      };
      for (const Event& event : part.events) {
        if (const auto* imu = std::get_if<ImuSample>(&event)) measured_ns.push_back(imu->sensor_time_ns);
        if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
          const TimeNs late_ns = delay_ns(*live_fix++) - delay_ns(*fix);
          latest_ms = std::max(latest_ms, 1e-6 * static_cast<double>(late_ns));
        }
      }
      std::vector<TimeNs> stamped_ns;
      std::vector<TimeNs> published_ns;
      for (const ImuSample& sample : live.imu) {
        stamped_ns.push_back(sample.sensor_time_ns);
        published_ns.push_back(sample.bridge_time_ns);
      }
      constexpr std::size_t settled = 100;  // the first samples wait for the beacon's clock
      const double jitter_ms = spread_ms(published_ns, measured_ns, settled);
      const double error_ms = spread_ms(stamped_ns, measured_ns, 0);
      std::cout << "jitter " << jitter_ms << " ms, latest fix " << latest_ms << " ms, error of the stamps "
                << error_ms << " ms\n";
      const RunDistance distance = distance_between(live.poses, log);
      print("serial line against log", distance);
      // The beacon's clock is fitted to the fastest arrivals, so a late one has little effect.
      CHECK(spread_ms(stamped_ns, measured_ns, settled) <= 1.0 + jitter_ms);
      // An event that a busy machine delays changes the subsequent poses, but not most of them.
      const double times = 1.0 + error_ms + 0.1 * latest_ms;
      CHECK(distance.position_m.median <= times * 0.005);
      CHECK(distance.velocity_mps.median <= times * 0.005);
      CHECK(distance.yaw_rad.median <= times * 0.002);  // headings have steps of 0.1°
    }
  }
}

}  // namespace car_test
