#include <sonopose/attitude/ahrs.hpp>
#include <sonopose/geometry/inverse_sqrt.hpp>
#include <sonopose/geometry/rotation.hpp>

namespace sonopose::attitude {
namespace {

constexpr double initial_gain_hz = 10.0;
constexpr double initialisation_s = 3.0;
constexpr double clipping_share = 0.98;  ///< share of the gyroscope's range
constexpr double warning_share = 0.25;   ///< share of the rejection timeout

template <class Scalar>
Scalar radians(double degrees) {
  return Scalar(degrees * geometry::radians_per_degree);
}

/// Limits of the rejection; gain 0 has no feedback that could be rejected.
template <class Scalar>
RejectionLimits<Scalar> limits_of(const AhrsSettings& settings, double threshold_deg) {
  return {radians<Scalar>(threshold_deg), settings.gain > 0.0 ? Scalar(settings.rejection_timeout_s) : 0};
}

template <class Scalar>
RejectionLimits<Scalar> acceleration_limits(const AhrsSettings& settings) {
  return limits_of<Scalar>(settings, settings.acceleration_rejection_deg);
}

template <class Scalar>
RejectionLimits<Scalar> magnetic_limits(const AhrsSettings& settings) {
  return limits_of<Scalar>(settings, settings.magnetic_rejection_deg);
}

template <class Scalar>
void update_rejection(Rejection<Scalar>& rejection, RejectionForm form, const RejectionLimits<Scalar>& limits,
                      bool initialising, Scalar dt_s) {
  if (form == RejectionForm::seed)
    rejection.update_seed(limits, initialising, dt_s);
  else
    rejection.update_recovery(limits, initialising, dt_s);
}

template <class Scalar>
Quaternion<Scalar> unit(const Quaternion<Scalar>& q) {
  return Quaternion<Scalar>(q.coeffs() * geometry::inverse_sqrt(q.squaredNorm()));
}

template <class Scalar>
Scalar normalised_timer(Scalar timer_s, const RejectionLimits<Scalar>& limits) {
  return limits.active() ? std::min(timer_s / limits.timeout_s, Scalar(1)) : Scalar(0);
}

}  // namespace

template <class Scalar>
void BasicAhrs<Scalar>::reset(const Quaternion<Scalar>& q_body_to_world) {
  *this = {};
  q_body_to_world_ = q_body_to_world.normalized();
}

template <class Scalar>
void BasicAhrs<Scalar>::update(const Settings& settings, const Measurement<Scalar>& measurement) {
  HeadingReference reference{Vector2::Zero(), measurement.north_world};
  const Vector3<Scalar>& field_body_t = measurement.magnetic_field_body_t;
  const Vector3<Scalar> field_world_t = q_body_to_world_ * field_body_t;
  // A vertical field contains no heading.
  if (has_level_part(field_world_t)) reference.seen_world = field_world_t.template head<2>();
  step(settings, measurement, reference);
}

template <class Scalar>
void BasicAhrs<Scalar>::update_external_heading(const Settings& settings,
                                                const Measurement<Scalar>& measurement, Scalar heading_rad) {
  const Vector3<Scalar> forward_world = q_body_to_world_ * Vector3<Scalar>::UnitX();
  HeadingReference reference{Vector2::Zero(), {std::cos(heading_rad), std::sin(heading_rad)}};
  if (has_level_part(forward_world)) reference.seen_world = forward_world.template head<2>();
  step(settings, measurement, reference);
}

template <class Scalar>
void BasicAhrs<Scalar>::step(const Settings& settings, const Measurement<Scalar>& measurement,
                             const HeadingReference& reference) {
  const Scalar dt_s = measurement.dt_s;
  const Vector3<Scalar>& measured_radps = measurement.angular_velocity_body_radps;
  const Vector3<Scalar> rate_body_radps = measured_radps - offset_.offset_body_radps;
  if (settings.gyro_offset) {
    offset_.learn({radians<Scalar>(settings.gyro_offset_limit_dps), Scalar(settings.gyro_offset_still_s),
                   Scalar(settings.gyro_offset_cutoff_hz)},
                  measured_radps, dt_s);
  }
  const auto range_radps = radians<Scalar>(clipping_share * settings.gyro_range_dps);
  const bool clipped = range_radps > 0 && measured_radps.cwiseAbs().maxCoeff() > range_radps;
  if (clipped) initialise();
  const Scalar gain = std::min(advance_ramp(settings, dt_s) * dt_s, Scalar(1));
  over_range_ = clipped || (over_range_ && initialising(settings));

  const Vector3<Scalar> up_body = geometry::up_in_body(q_body_to_world_);
  const Vector3<Scalar> tilt_body = tilt_correction(settings, measurement, up_body);
  // A timeout may turn the estimate about the vertical here, which preserves its up.
  const Scalar turn = heading_correction(settings, reference, dt_s);
  const Vector3<Scalar> error_body = tilt_body + turn * up_body;
  q_body_to_world_ =
      unit<Scalar>(q_body_to_world_ * geometry::rotation_by(rate_body_radps * dt_s + gain * error_body));
}

template <class Scalar>
void BasicAhrs<Scalar>::initialise() {
  ramp_s_ = 0;
  acceleration_ = {};
  heading_ = {};
}

template <class Scalar>
bool BasicAhrs<Scalar>::initialising(const Settings& settings) const {
  return settings.gain > 0.0 && ramp_s_ < Scalar(initialisation_s);
}

/// Gain of this step.
template <class Scalar>
Scalar BasicAhrs<Scalar>::advance_ramp(const Settings& settings, Scalar dt_s) {
  ramp_s_ = std::min(ramp_s_ + dt_s, Scalar(initialisation_s));
  if (!initialising(settings)) return Scalar(settings.gain);
  constexpr auto first = Scalar(initial_gain_hz);
  return first - (first - Scalar(settings.gain)) * (ramp_s_ / Scalar(initialisation_s));
}

/// Rotation (rad, body) towards the accelerometer's up; zero if it is absent or ignored.
template <class Scalar>
Vector3<Scalar> BasicAhrs<Scalar>::tilt_correction(const Settings& settings,
                                                   const Measurement<Scalar>& measurement,
                                                   const Vector3<Scalar>& up_body) {
  if (!has_vertical_reference(measurement)) return Vector3<Scalar>::Zero();
  const Vector3<Scalar> force_mps2 = gravity_force_body(measurement, q_body_to_world_);
  const Scalar force_squared = force_mps2.squaredNorm();
  if (!(force_squared > 0)) return Vector3<Scalar>::Zero();
  up_known_ = true;
  const auto limits = acceleration_limits<Scalar>(settings);
  if (settings.rejection == RejectionForm::seed) {
    if (acceleration_.expired(limits)) {
      initialise();
      acceleration_.timed_out = true;
    }
    acceleration_.timed_out = acceleration_.timed_out && initialising(settings);
  }
  const Vector3<Scalar> up_measured_body = force_mps2 * geometry::inverse_sqrt(force_squared);
  Vector3<Scalar> error_body = up_measured_body.cross(up_body);
  const Scalar sine_squared = error_body.squaredNorm();
  acceleration_.error = {std::sqrt(sine_squared), up_measured_body.dot(up_body)};
  update_rejection(acceleration_, settings.rejection, limits, initialising(settings), measurement.dt_s);
  if (acceleration_.ignored) return Vector3<Scalar>::Zero();
  if (acceleration_.error.cosine < 0) {
    // Exactly upside down, any horizontal axis leads back.
    if (sine_squared > 0)
      error_body *= geometry::inverse_sqrt(sine_squared);
    else
      error_body = up_body.unitOrthogonal();
  }
  return error_body;
}

/// Rotation (rad) about up towards the measured heading; zero if it is absent or ignored.
template <class Scalar>
Scalar BasicAhrs<Scalar>::heading_correction(const Settings& settings, const HeadingReference& reference,
                                             Scalar dt_s) {
  const bool seed = settings.rejection == RejectionForm::seed;
  if (seed) heading_.timed_out = false;
  const Vector2& seen = reference.seen_world;
  const Scalar seen_squared = seen.squaredNorm();
  if (!up_known_ || !(seen_squared > 0)) return 0;
  const Scalar scale = geometry::inverse_sqrt(seen_squared);
  const Vector2& wanted = reference.true_world;
  Scalar sine = scale * (seen.x() * wanted.y() - seen.y() * wanted.x());
  Scalar cosine = scale * seen.dot(wanted);
  const auto limits = magnetic_limits<Scalar>(settings);
  if (seed && heading_.expired(limits)) {
    turn_in_world({0, 0, std::atan2(sine, cosine)});
    heading_ = {};
    heading_.timed_out = true;
    sine = 0;
    cosine = 1;
  }
  heading_.error = {std::abs(sine), cosine};
  update_rejection(heading_, settings.rejection, limits, initialising(settings), dt_s);
  if (heading_.ignored) return 0;
  return cosine < 0 ? std::copysign(Scalar(1), sine) : sine;
}

template <class Scalar>
void BasicAhrs<Scalar>::set_heading(Scalar yaw_rad) {
  turn_in_world({0, 0, yaw_rad - geometry::yaw_of(q_body_to_world_)});
}

template <class Scalar>
void BasicAhrs<Scalar>::turn_in_world(const Vector3<Scalar>& rotation_world_rad) {
  q_body_to_world_ = (geometry::rotation_by(rotation_world_rad) * q_body_to_world_).normalized();
}

template <class Scalar>
AhrsInternalStates<Scalar> BasicAhrs<Scalar>::internal_states(const Settings& settings) const {
  constexpr auto degrees = Scalar(1 / geometry::radians_per_degree);
  return {degrees * acceleration_.error.angle_rad(),
          acceleration_.ignored,
          normalised_timer(acceleration_.timer_s, acceleration_limits<Scalar>(settings)),
          degrees * heading_.error.angle_rad(),
          heading_.ignored,
          normalised_timer(heading_.timer_s, magnetic_limits<Scalar>(settings))};
}

template <class Scalar>
AhrsFlags BasicAhrs<Scalar>::flags(const Settings& settings) const {
  const AhrsInternalStates<Scalar> states = internal_states(settings);
  return {initialising(settings),  states.acceleration_timer > Scalar(warning_share),
          acceleration_.timed_out, states.magnetic_timer > Scalar(warning_share),
          heading_.timed_out,      over_range_};
}

template class BasicAhrs<float>;
template class BasicAhrs<double>;

}  // namespace sonopose::attitude
