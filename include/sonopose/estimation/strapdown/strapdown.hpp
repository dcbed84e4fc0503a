#pragma once
/// \file
/// The strapdown document ("State Estimation Using IMU Data"): position, velocity and orientation from the
/// IMU alone, integrated from a known start. Nothing corrects it, so it drifts without bound: it shows what
/// an IMU is worth without fixes.

#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <optional>

namespace sonopose::estimation {

/// Position, velocity and orientation at one moment: the document's p, v and q.
struct StrapdownState {
  TimeNs time_ns = 0;
  Vector3d position_world_m = Vector3d::Zero();
  Vector3d velocity_world_mps = Vector3d::Zero();
  Quaterniond q_body_to_world = Quaterniond::Identity();
};

/// What is held constant over a step from sample k−1 to sample k.
enum class StrapdownRule : std::uint8_t {
  previous,  ///< rate and specific force of sample k−1, as the document writes it: of first order in the step
  mean       ///< the mean of both samples, each force turned into the world at its own end: of second order
};

class Strapdown {
public:
  /// Starts from a true state (section 2); its quaternion is normalised here.
  Strapdown(const StrapdownState& start, StrapdownRule rule);

  /// One step to the sample's time:
  ///   p ← p + Δt·v + ½Δt²·(R(q)·a + g)   (1)
  ///   v ← v + Δt·(R(q)·a + g)            (2)
  ///   q ← q ⊗ exp(ω·Δt)                  (3, 4)
  /// with the values of step k−1. The document writes the increment on the left of q; body rates and a
  /// body-to-world quaternion demand the right. g is the one standard gravity of the project, where the
  /// document rounds to 9.81.
  /// A sample at or before the state's time moves nothing and is only remembered as the one before. The step
  /// from the start to the first sample after it uses the last sample before it, else that sample itself. The
  /// sample's numbers must be finite.
  void on(const ImuSample& imu);

  [[nodiscard]] const StrapdownState& state() const { return state_; }

private:
  StrapdownState state_;
  StrapdownRule rule_;
  std::optional<ImuSample> previous_;
};

}  // namespace sonopose::estimation
