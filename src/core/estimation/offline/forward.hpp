#pragma once
// A single forward Kalman filter over a segment, and the linear operations for the way back.

#include <sonopose/estimation/kalman/filter.hpp>
#include <sonopose/estimation/offline/judgement.hpp>
#include <sonopose/estimation/offline/smoother.hpp>

#include <cstddef>
#include <variant>
#include <vector>

namespace sonopose::estimation::offline {

using kalman::StateCovariance;
using kalman::StateVector;

/// Use of a measurement; a scalar one has zeros in the other rows.
struct Correction {
  kalman::FixJacobian jacobian = kalman::FixJacobian::Zero();  ///< H
  Vector3d weighted_innovation = Vector3d::Zero();             ///< S⁻¹ ν
  kalman::Matrix3d information = kalman::Matrix3d::Zero();     ///< S⁻¹
  kalman::StateColumns gain = kalman::StateColumns::Zero();    ///< K = P Hᵀ S⁻¹
};

/// Operation on the error of the state: multiplication by Φ, or a correction.
using Operation = std::variant<StateCovariance, Correction>;

/// State between two IMU samples. It is a plain value: a copy continues from here.
struct ForwardState {
  kalman::Filter filter;
  TimeNs time_ns = 0;        ///< time of the filter: the latest sample
  std::size_t next_imu = 0;  ///< indices into the segment's lists
  std::size_t next_fix = 0;
  std::size_t next_heading = 0;
  std::size_t next_state = 0;
  std::size_t next_dropped = 0;
  double log_likelihood = 0;  ///< log-likelihood of the fixes' innovations
};

class Forward {
public:
  /// The segment must outlive this object.
  Forward(const settings::Settings& settings, const Segment& segment, const Noise& noise);

  /// True if the segment has an IMU sample and a used fix.
  [[nodiscard]] static bool can_start(const Segment& segment);

  /// State before the first sample of a segment that can start.
  [[nodiscard]] static ForwardState start(const Segment& segment);

  /// Moves to the next sample and uses the measurements from then until the one that follows. Appends the
  /// operations. Without a list, the covariance is propagated only if needed.
  void step(ForwardState& state, std::vector<Operation>* operations) const;

private:
  void move(ForwardState& state, std::vector<Operation>* operations) const;
  void propagate(ForwardState& state, std::vector<Operation>* operations) const;
  void use(ForwardState& state, const StateMeasurement& measured, std::vector<Operation>* operations) const;
  void use(ForwardState& state, const JudgedFix& fix, std::vector<Operation>* operations) const;
  void use(ForwardState& state, const JudgedHeading& heading, std::vector<Operation>* operations) const;
  void use_until(ForwardState& state, TimeNs end_ns, std::vector<Operation>* operations) const;

  const Segment& segment_;
  Noise noise_;
  TimeNs imu_gap_ns_;
  double mount_rad_;
};

}  // namespace sonopose::estimation::offline
