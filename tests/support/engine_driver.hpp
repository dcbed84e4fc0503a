#pragma once
/// \file
/// Drives an Engine through a known motion: an ideal or simply disturbed IMU, fixes at their receipt, and the
/// truth for every pose.

#include <sonopose/estimation/documented/engine.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace sonopose::test {

/// Same as the engine's; the tests do not depend on its value.
inline constexpr double gravity_mps2 = standard_gravity_mps2;
inline constexpr TimeNs epoch_ns = 1'700'000'000'000'000'000;

/// A level body at one instant.
struct Truth {
  Vector3d position_world_m = Vector3d::Zero();
  Vector3d velocity_world_mps = Vector3d::Zero();
  Vector3d acceleration_world_mps2 = Vector3d::Zero();
  double yaw_rad = 0;
  double yaw_rate_radps = 0;
};

/// The truth at a time in seconds.
using Motion = std::function<Truth(double)>;

inline Motion at_rest(const Vector3d& position_world_m = Vector3d::Zero()) {
  return [position_world_m](double) {
    Truth truth;
    truth.position_world_m = position_world_m;
    return truth;
  };
}

/// Constant velocity along world X, also before the start.
inline Motion constant_velocity(double speed_mps) {
  return [speed_mps](double time_s) {
    Truth truth;
    truth.position_world_m.x() = speed_mps * time_s;
    truth.velocity_world_mps.x() = speed_mps;
    return truth;
  };
}

/// Motion along a straight line or (curvature ≠ 0) a circle, facing forwards: rests until `start_s`,
/// accelerates smoothly within `ramp_s`, then keeps its speed.
inline Motion departure(double speed_mps, double curvature_per_m = 0.0, double start_s = 2.0,
                        double ramp_s = 1.0) {
  return [=](double time_s) {
    const double tau_s = std::clamp(time_s - start_s, 0.0, ramp_s);
    const double omega = std::numbers::pi / ramp_s;
    const double after_s = std::max(0.0, time_s - start_s - ramp_s);
    const double path_m = 0.5 * speed_mps * (tau_s - std::sin(omega * tau_s) / omega) + speed_mps * after_s;
    const double v = 0.5 * speed_mps * (1.0 - std::cos(omega * tau_s));
    const double a = 0.5 * speed_mps * omega * std::sin(omega * tau_s);
    Truth truth;
    truth.yaw_rad = curvature_per_m * path_m;
    truth.yaw_rate_radps = curvature_per_m * v;
    const Vector3d ahead(std::cos(truth.yaw_rad), std::sin(truth.yaw_rad), 0.0);
    const Vector3d left(-ahead.y(), ahead.x(), 0.0);
    truth.velocity_world_mps = v * ahead;
    truth.acceleration_world_mps2 = a * ahead + v * v * curvature_per_m * left;
    if (curvature_per_m == 0.0) {
      truth.position_world_m = path_m * ahead;
    } else {
      truth.position_world_m =
          Vector3d(std::sin(truth.yaw_rad), 1.0 - std::cos(truth.yaw_rad), 0.0) / curvature_per_m;
    }
    return truth;
  };
}

/// A horizontal figure eight of 4 m × 2 m at about 1 m/s, facing forwards, already moving before the start.
inline Motion eight(double turn_rate_radps = 0.5) {
  return [w = turn_rate_radps](double time_s) {
    const double u = w * time_s;
    Truth truth;
    truth.position_world_m = {2.0 * std::sin(u), std::sin(2.0 * u), 0.0};
    const Vector3d v(2.0 * w * std::cos(u), 2.0 * w * std::cos(2.0 * u), 0.0);
    const Vector3d a(-2.0 * w * w * std::sin(u), -4.0 * w * w * std::sin(2.0 * u), 0.0);
    truth.velocity_world_mps = v;
    truth.acceleration_world_mps2 = a;
    truth.yaw_rad = std::atan2(v.y(), v.x());
    truth.yaw_rate_radps = (v.x() * a.y() - v.y() * a.x()) / v.squaredNorm();
    return truth;
  };
}

struct Sensors {
  double imu_rate_hz = 100.0;
  double fix_rate_hz = 12.5;
  double delay_s = 0.068;
  double noise_m = 0.0;  ///< standard deviation of a fix, per axis
  double heading_noise_rad = 0.0;
  bool headings = false;  ///< one per fix, of a pair along body X
  Vector3d gyro_offset_body_radps = Vector3d::Zero();
  Vector3d accel_offset_body_mps2 = Vector3d::Zero();
};

/// A paired beacon.
inline Sensors with_headings(double noise_m = 0.0) {
  Sensors sensors;
  sensors.headings = true;
  sensors.noise_m = noise_m;
  return sensors;
}

inline bool is_finite(const FusedPose& pose) {
  return pose.position_world_m.allFinite() && pose.velocity_world_mps.allFinite() &&
         pose.q_body_to_world.coeffs().allFinite() && pose.acceleration_world_mps2.allFinite() &&
         pose.gyro_bias_body_radps.allFinite() && position_std_m(pose).allFinite();
}

inline ImuSample imu_on(const Truth& truth, TimeNs time_ns) {
  ImuSample imu;
  imu.address = 7;
  imu.sensor_time_ns = time_ns;
  imu.angular_velocity_body_radps.z() = truth.yaw_rate_radps;
  imu.specific_force_body_mps2 = geometry::rotation_about_z(-truth.yaw_rad) *
                                 (truth.acceleration_world_mps2 + Vector3d(0, 0, gravity_mps2));
  return imu;
}

/// Pose and truth at one IMU sample.
struct Moment {
  double time_s = 0;
  FusedPose pose;
  Truth truth;

  [[nodiscard]] double position_error_m() const {
    return (pose.position_world_m - truth.position_world_m).norm();
  }
  [[nodiscard]] bool has(PoseStatus bit) const { return (pose.status & bit) != 0; }
};

class EngineDriver {
public:
  EngineDriver(const settings::Settings& settings, Motion motion, Sensors sensors = {})
      : engine{settings}, sensors_{std::move(sensors)}, motion_{std::move(motion)} {}

  estimation::documented::Engine engine;
  bool fixes_on = true;  ///< false stops the fixes
  bool imu_on_air = true;
  std::function<void(UltrasonicFix&, double time_s)> alter_fix;  ///< called with the emission time
  std::function<void(ImuSample&, double time_s)> alter_imu;
  std::vector<Moment> moments;  ///< one per pose
  std::vector<FixReport> reports;

  /// Runs for this long; returns the latest moment.
  Moment run(double seconds) {
    const auto steps = static_cast<int>(std::lround(seconds * sensors_.imu_rate_hz));
    for (int i = 0; i < steps; ++i) step();
    return moments.back();
  }

  [[nodiscard]] double time_s() const { return static_cast<double>(samples_) / sensors_.imu_rate_hz; }

  static TimeNs stamp(double time_s) { return epoch_ns + to_ns(time_s); }

private:
  void step() {
    const double now_s = time_s();
    while (fix_time_s() <= now_s) emit();
    while (!in_flight_.empty() && in_flight_.front().received_time_ns <= stamp(now_s)) receive();
    if (imu_on_air) {
      const Truth truth = motion_(now_s);
      ImuSample imu = imu_on(truth, stamp(now_s));
      imu.sequence = ++sequence_;
      imu.angular_velocity_body_radps += sensors_.gyro_offset_body_radps;
      imu.specific_force_body_mps2 += sensors_.accel_offset_body_mps2;
      if (alter_imu) alter_imu(imu, now_s);
      if (const auto pose = engine.predict(imu)) moments.push_back({now_s, *pose, truth});
    }
    ++samples_;
  }

  /// Time of the next emission, between IMU samples as on real hardware.
  [[nodiscard]] double fix_time_s() const {
    return (static_cast<double>(emissions_) + 0.37) / sensors_.fix_rate_hz;
  }

  void emit() {
    const double time_s = fix_time_s();
    ++emissions_;
    const Truth truth = motion_(time_s);
    UltrasonicFix fix;
    fix.address = 7;
    fix.sequence = ++sequence_;
    fix.emission_time_ns = stamp(time_s);
    fix.received_time_ns = stamp(time_s + sensors_.delay_s);
    fix.position_world_m = truth.position_world_m + sensors_.noise_m * normal_vector();
    fix.quality_percent = 90.0;
    fix.measured_delay_s = sensors_.delay_s;
    if (alter_fix) alter_fix(fix, time_s);
    const double heading_rad = truth.yaw_rad + sensors_.heading_noise_rad * normal_(random_);
    if (!fixes_on) return;
    in_flight_.push_back(fix);
    if (sensors_.headings)
      headings_.push_back({7, ++sequence_, fix.emission_time_ns, fix.received_time_ns,
                           geometry::wrap_angle(heading_rad), true});
  }

  void receive() {
    reports.push_back(engine.correct(in_flight_.front()));
    in_flight_.pop_front();
    if (headings_.empty()) return;
    engine.correct(headings_.front());
    headings_.pop_front();
  }

  Vector3d normal_vector() { return {normal_(random_), normal_(random_), normal_(random_)}; }

  Sensors sensors_;
  Motion motion_;
  std::uint64_t samples_ = 0;
  std::uint64_t emissions_ = 0;
  std::uint64_t sequence_ = 0;
  std::deque<UltrasonicFix> in_flight_;
  std::deque<PairHeading> headings_;
  std::mt19937 random_{20240501};  // NOLINT(bugprone-random-generator-seed): the same run every time
  std::normal_distribution<double> normal_;
};

/// Largest position error of the moments from `from_s` on.
inline double worst_error_m(const std::vector<Moment>& moments, double from_s) {
  double worst_m = 0.0;
  for (const Moment& moment : moments) {
    if (moment.time_s >= from_s) worst_m = std::max(worst_m, moment.position_error_m());
  }
  return worst_m;
}

/// A body that has moved at this velocity during the second before `now_ns`, with an IMU at 100 Hz.
inline estimation::documented::Kinematics moving_body(const Vector3d& velocity_world_mps,
                                                      TimeNs now_ns = epoch_ns, double yaw_rad = 0.0) {
  estimation::documented::Kinematics body;
  body.time_ns = now_ns;
  body.velocity_world_mps = velocity_world_mps;
  for (int i = 0; i <= 100; ++i) {
    const double past_s = 0.01 * i;
    body.displacement_world_m = velocity_world_mps * past_s;
    body.history.push({now_ns - to_ns(1.0 - past_s), body.displacement_world_m, yaw_rad});
  }
  return body;
}

}  // namespace sonopose::test
