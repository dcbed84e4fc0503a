#pragma once
/// \file
/// The strapdown document ("State Estimation Using IMU Data"): position, velocity and orientation from the
/// IMU alone, integrated from a known start. The error grows without bound. It is a baseline that shows the
/// worth of an IMU without fixes.

#include <sonopose/samples/estimator_counters.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <optional>

namespace sonopose::evaluation::strapdown {

/// Position, velocity and orientation at one moment: the document's p, v and q.
struct State {
  TimeNs time_ns = 0;  ///< time of the state; 0: that of the first IMU sample
  Vector3d position_world_m = Vector3d::Zero();
  Vector3d velocity_world_mps = Vector3d::Zero();
  Quaterniond q_body_to_world = Quaterniond::Identity();
};

/// Values that are constant over a step from sample k−1 to sample k.
enum class Rule : std::uint8_t {
  previous,  ///< rate and specific force of sample k−1, as in the document: first order in the step
  mean       ///< mean of both samples, each force rotated by its own attitude: second order
};

/// Integrates IMU samples. Uses the settings groups admission and outage.
class Integrator {
public:
  /// Starts from a known state (section 2) and normalises its quaternion.
  Integrator(const settings::Settings& settings, State start, Rule rule);

  /// One step to the sample's time:
  ///   p ← p + Δt·v + ½Δt²·(R(q)·a + g)   (1)
  ///   v ← v + Δt·(R(q)·a + g)            (2)
  ///   q ← q ⊗ exp(ω·Δt)                  (3, 4)
  /// The values are those of step k−1. The document writes the increment on the left of q; body rates and a
  /// body-to-world quaternion require the right. g is standard gravity, which the document rounds to 9.81.
  /// Returns nothing for a sample that admission refuses, and for one before the start, which only serves as
  /// sample k−1 of the first step. Without one, the first step uses the first sample for both.
  std::optional<FusedPose> predict(const ImuSample& imu);

  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] const EstimatorCounters& counters() const { return counters_; }

private:
  void integrate(const ImuSample& imu);
  [[nodiscard]] FusedPose pose_at(const ImuSample& imu) const;

  settings::Settings settings_;
  Rule rule_;
  State state_;
  EstimatorCounters counters_;
  std::optional<ImuSample> last_imu_;
};

}  // namespace sonopose::evaluation::strapdown
