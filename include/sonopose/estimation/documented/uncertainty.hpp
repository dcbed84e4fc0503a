#pragma once
/// \file
/// Standard deviations of the pose. They follow the applied corrections and the weights of the fixes, and
/// grow without fixes. Nothing else in the engine depends on them.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <numbers>

namespace sonopose::estimation::documented {

using settings::UncertaintySettings;

/// Standard deviations, per world axis.
struct UncertaintyState {
  double position_std_m = unknown_m;
  double velocity_std_mps = unknown_mps;
  double yaw_std_rad = unknown_yaw_rad;

  /// Values for unknown, usable in a covariance.
  static constexpr double unknown_m = 1e3;
  static constexpr double unknown_mps = 1e2;
  static constexpr double unknown_yaw_rad =
      std::numbers::pi / std::numbers::sqrt3;  // uniform over the circle

  bool operator==(const UncertaintyState&) const = default;
};

namespace uncertainty {

/// Grows over one IMU step: velocity by the error of the acceleration, position by that of the velocity.
void grow(const UncertaintySettings& settings, UncertaintyState& state, double dt_s);

/// Applies a fix of weight w that corrected the share `position_share` of the position error and the share
/// `velocity_share` of the velocity error (measured over `interval_s`; 0: none).
void correct(const UncertaintySettings& settings, UncertaintyState& state, double weight,
             double position_share, double velocity_share, double interval_s);

/// Applies one IMU step of the correction to a heading, which removes this share of the yaw error.
void correct_yaw(const UncertaintySettings& settings, UncertaintyState& state, double share);

/// Applies a correction of yaw by alignment in motion. It removes this share of the yaw error, measured with
/// this standard deviation.
void align_yaw(UncertaintyState& state, double share, double measurement_std_rad);

/// Restarts the uncertainty of the position: the first fix of a run sets it.
void reset_position(const UncertaintySettings& settings, UncertaintyState& state);

/// Covariance of position and yaw; tilt is not estimated and unknown. `share` is the share of each axis of
/// the fixes that counts. An axis of which a quarter counts has four times the variance, as have fixes with
/// sixteen times the variance averaged over four times the time.
[[nodiscard]] Covariance<6> pose_covariance(const UncertaintyState& state,
                                            const Vector3d& share = Vector3d::Ones());

[[nodiscard]] Covariance<3> velocity_covariance(const UncertaintyState& state,
                                                const Vector3d& share = Vector3d::Ones());

}  // namespace uncertainty
}  // namespace sonopose::estimation::documented
