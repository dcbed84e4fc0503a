#pragma once
/// \file
/// The standard deviations of the pose. They follow the applied corrections and the weights of the fixes, and
/// grow without fixes. Nothing in the engine depends on them.

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

  /// Unknown, as numbers that are usable in a covariance.
  static constexpr double unknown_m = 1e3;
  static constexpr double unknown_mps = 1e2;
  static constexpr double unknown_yaw_rad =
      std::numbers::pi / std::numbers::sqrt3;  // uniform over the circle

  bool operator==(const UncertaintyState&) const = default;
};

namespace uncertainty {

/// One IMU step: velocity grows by the error of the acceleration, position by that of the velocity.
void grow(const UncertaintySettings& settings, UncertaintyState& state, double dt_s);

/// A fix of weight w, of which the share `position_share` of the position error and the share
/// `velocity_share` of the velocity error (measured over `interval_s`; 0: none) are applied.
void correct(const UncertaintySettings& settings, UncertaintyState& state, double weight,
             double position_share, double velocity_share, double interval_s);

/// One IMU step of the correction to a heading, which removes this share of the yaw error.
void correct_yaw(const UncertaintySettings& settings, UncertaintyState& state, double share);

/// In-motion alignment removes this share of the yaw error, measured with this standard deviation.
void align_yaw(UncertaintyState& state, double share, double measurement_std_rad);

/// The first fix of a run sets the position.
void reset_position(const UncertaintySettings& settings, UncertaintyState& state);

/// Covariance of the position and the yaw. Tilt is not estimated and unknown. `share` is that of each axis of
/// the fixes that counts: an axis of which a quarter counts has four times the variance, that of fixes with
/// sixteen times the variance that are averaged over four times the time.
[[nodiscard]] Covariance<6> pose_covariance(const UncertaintyState& state,
                                            const Vector3d& share = Vector3d::Ones());

[[nodiscard]] Covariance<3> velocity_covariance(const UncertaintyState& state,
                                                const Vector3d& share = Vector3d::Ones());

}  // namespace uncertainty
}  // namespace sonopose::estimation::documented
