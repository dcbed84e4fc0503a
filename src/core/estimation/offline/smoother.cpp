#include "estimation/offline/forward.hpp"
#include <sonopose/estimation/offline/smoother.hpp>

#include <algorithm>

namespace sonopose::estimation::offline {
namespace {

/// Information of the measurements after a moment about the error of the state then, in the form of Bryson
/// and Frazier: the error is P λ, and its covariance P − P Λ P.
struct Adjoint {
  StateVector error = StateVector::Zero();                ///< λ
  StateCovariance information = StateCovariance::Zero();  ///< Λ

  /// Goes back over operations, last one first.
  void step_back(const std::vector<Operation>& operations) {
    for (std::size_t i = operations.size(); i-- > 0;) step_back(operations[i]);
  }

  /// Goes back over one operation.
  void step_back(const Operation& operation) {
    if (const auto* transition = std::get_if<StateCovariance>(&operation)) {
      error = transition->transpose() * error;
      multiply_by(*transition);
    } else {
      step_back(*std::get_if<Correction>(&operation));
    }
  }

  /// Goes back over a correction: λ ← Hᵀ S⁻¹ ν + (I − K H)ᵀ λ,  Λ ← Hᵀ S⁻¹ H + (I − K H)ᵀ Λ (I − K H).
  void step_back(const Correction& correction) {
    const kalman::FixJacobian& h = correction.jacobian;
    error += h.transpose() * (correction.weighted_innovation - correction.gain.transpose() * error);
    StateCovariance remaining = StateCovariance::Identity();
    remaining -= correction.gain * h;
    multiply_by(remaining);
    information += h.transpose() * correction.information * h;
  }

private:
  /// Λ ← Aᵀ Λ A, exactly symmetric: any asymmetry would grow.
  void multiply_by(const StateCovariance& a) {
    const StateCovariance product = a.transpose() * information * a;
    information = 0.5 * (product + product.transpose());
  }
};

SmoothedPose smoothed_pose(const kalman::Filter& filter, const Adjoint& adjoint, TimeNs time_ns) {
  kalman::Filter after = filter;
  const StateVector error = filter.covariance * adjoint.error;
  after.inject(error);
  after.angular_velocity_body_radps -= error.segment<3>(kalman::at_gyro_bias);
  after.covariance -= filter.covariance * adjoint.information * filter.covariance;
  return {.time_ns = time_ns,
          .position_world_m = after.tracked_position_world_m(),
          .velocity_world_mps = after.tracked_velocity_world_mps(),
          .q_body_to_world = after.q_body_to_world,
          .gyro_bias_body_radps = after.gyro_bias_body_radps,
          .accel_bias_body_mps2 = after.accel_bias_body_mps2,
          .pose_covariance = after.pose_covariance(),
          .velocity_covariance = after.velocity_covariance()};
}

/// State after one sample, and the operations that led to it from the one before.
struct Node {
  kalman::Filter filter;
  std::vector<Operation> operations;
};

constexpr std::size_t block_size = 64;  // number of samples between two stored states

/// States before each block. The blocks are computed again on the way back, so that the memory does not grow
/// with the covariances of a whole recording.
std::vector<ForwardState> block_starts(const Forward& forward, const Segment& segment) {
  std::vector<ForwardState> starts;
  std::vector<Operation> unused;
  ForwardState state = Forward::start(segment);
  for (std::size_t i = 0; i < segment.imu.size(); ++i) {
    if (i % block_size == 0) starts.push_back(state);
    unused.clear();
    forward.step(state, &unused);
  }
  return starts;
}

}  // namespace

std::vector<SmoothedPose> smoothed(const settings::Settings& settings, const Segment& segment,
                                   const Noise& noise) {
  if (!Forward::can_start(segment)) return {};
  const Forward forward(settings, segment, noise);
  const std::vector<ForwardState> starts = block_starts(forward, segment);
  std::vector<SmoothedPose> poses(segment.imu.size());
  std::vector<Node> nodes(block_size);
  Adjoint adjoint;
  for (std::size_t block = starts.size(); block-- > 0;) {
    ForwardState state = starts[block];
    const std::size_t first = block * block_size;
    const std::size_t count = std::min(block_size, segment.imu.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      nodes[i].operations.clear();
      forward.step(state, &nodes[i].operations);
      nodes[i].filter = state.filter;
    }
    for (std::size_t i = count; i-- > 0;) {
      poses[first + i] = smoothed_pose(nodes[i].filter, adjoint, segment.imu[first + i].time_ns);
      adjoint.step_back(nodes[i].operations);
    }
  }
  return poses;
}

}  // namespace sonopose::estimation::offline
