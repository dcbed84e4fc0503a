#pragma once
/// \file
/// The revised AHRS algorithm of S. Madgwick's thesis (2014), chapter 7. The gyroscope is integrated and
/// corrected towards the accelerometer's vertical and the magnetometer's heading. Each sensor is ignored
/// while it deviates too much from the estimate.

#include <sonopose/attitude/ahrs_outputs.hpp>
#include <sonopose/attitude/filter.hpp>
#include <sonopose/attitude/gyro_offset.hpp>
#include <sonopose/attitude/rejection.hpp>
#include <sonopose/attitude/settings.hpp>

namespace sonopose::attitude {

/// The filter as a value: copying it copies its state. It starts initialising: for 3 s its gain falls from
/// 10/s to the configured one, nothing is rejected, and it converges from any orientation. A filter of gain 0
/// never initialises.
template <class Scalar_>
class BasicAhrs {
public:
  using Scalar = Scalar_;
  using Settings = AhrsSettings;
  static constexpr std::string_view name = "ahrs";

  /// Restarts the initialisation at this orientation and forgets the learned gyroscope offset.
  void reset(const Quaternion<Scalar>& q_body_to_world);

  /// One step, with all sensors, without the magnetometer, or with the gyroscope alone:
  ///   e = up_measured × up_estimated + up_estimated · sin(heading_measured − heading_estimated)
  ///   q ← q ⊗ exp((ω − offset)·Δt + gain·Δt·e)
  /// Both errors are rotations in body axes, each of length 1 beyond 90°, so that the correction does not
  /// fade towards 180°. No step corrects more than its errors. A missing sensor (zero length) corrects
  /// nothing and counts as neither used nor ignored. One that is present in every n-th step corrects 1/n as
  /// fast. The magnetometer corrects only the heading, and only after the first accelerometer sample.
  void update(const Settings& settings, const Measurement<Scalar>& measurement);

  /// One step with an external heading instead of the magnetometer, with the same rejection. `heading_rad` is
  /// the body's yaw in the world: the direction of body X seen from above, counter-clockwise from world +X.
  /// It must be finite. It corrects nothing while body X is vertical.
  void update_external_heading(const Settings& settings, const Measurement<Scalar>& measurement,
                               Scalar heading_rad);

  /// Overload for the body's ZYX yaw in a convention: the value of
  /// `geometry::yaw_of(orientation_in(convention, …))` once the filter has settled.
  void update_external_heading(const Settings& settings, const Measurement<Scalar>& measurement,
                               Scalar heading_rad, Convention convention) {
    update_external_heading(settings, measurement,
                            yaw_in_world(convention, measurement.north_world, heading_rad));
  }

  /// Turns the estimate about world Z to this yaw; nothing else changes.
  void set_heading(Scalar yaw_rad);

  /// Turns the estimate by a rotation vector in the world; nothing else changes.
  void turn_in_world(const Vector3<Scalar>& rotation_world_rad);

  [[nodiscard]] const Quaternion<Scalar>& orientation() const { return q_body_to_world_; }

  /// Gyroscope offset, learned or given, that is subtracted from the rates (rad/s, body).
  [[nodiscard]] const Vector3<Scalar>& gyro_bias_body_radps() const { return offset_.offset_body_radps; }
  void set_gyro_bias(const Vector3<Scalar>& bias_body_radps) { offset_.offset_body_radps = bias_body_radps; }

  /// Internal states; `settings` must be those of the last update.
  [[nodiscard]] AhrsInternalStates<Scalar> internal_states(const Settings& settings) const;
  [[nodiscard]] AhrsFlags flags(const Settings& settings) const;

  bool operator==(const BasicAhrs& other) const {
    return q_body_to_world_.coeffs() == other.q_body_to_world_.coeffs() && offset_ == other.offset_ &&
           acceleration_ == other.acceleration_ && heading_ == other.heading_ && ramp_s_ == other.ramp_s_ &&
           up_known_ == other.up_known_ && over_range_ == other.over_range_;
  }

  /// Calls visit(name, field) for each field of the state.
  template <class Visit>
  void for_each_field(Visit&& visit) {
    visit_fields(*this, visit);
  }
  template <class Visit>
  void for_each_field(Visit&& visit) const {
    visit_fields(*this, visit);
  }

private:
  using Vector2 = Eigen::Matrix<Scalar, 2, 1>;

  /// A horizontal direction as estimated and as true, both in the world. `seen_world` may have any length;
  /// zero means none.
  struct HeadingReference {
    Vector2 seen_world;
    Vector2 true_world;
  };

  void step(const Settings& settings, const Measurement<Scalar>& measurement,
            const HeadingReference& reference);
  void initialise();
  [[nodiscard]] bool initialising(const Settings& settings) const;
  Scalar advance_ramp(const Settings& settings, Scalar dt_s);
  Vector3<Scalar> tilt_correction(const Settings& settings, const Measurement<Scalar>& measurement,
                                  const Vector3<Scalar>& up_body);
  Scalar heading_correction(const Settings& settings, const HeadingReference& reference, Scalar dt_s);

  template <class Self, class Visit>
  static void visit_fields(Self& self, Visit& visit) {
    visit("q_body_to_world", self.q_body_to_world_);
    visit("gyro_offset_body_radps", self.offset_.offset_body_radps);
    visit("still_s", self.offset_.still_s);
    visit("acceleration_error_sine", self.acceleration_.error.sine);
    visit("acceleration_error_cosine", self.acceleration_.error.cosine);
    visit("acceleration_timer_s", self.acceleration_.timer_s);
    visit("acceleration_ignored", self.acceleration_.ignored);
    visit("acceleration_timed_out", self.acceleration_.timed_out);
    visit("heading_error_sine", self.heading_.error.sine);
    visit("heading_error_cosine", self.heading_.error.cosine);
    visit("heading_timer_s", self.heading_.timer_s);
    visit("heading_ignored", self.heading_.ignored);
    visit("heading_timed_out", self.heading_.timed_out);
    visit("ramp_s", self.ramp_s_);
    visit("up_known", self.up_known_);
    visit("over_range", self.over_range_);
  }

  Quaternion<Scalar> q_body_to_world_ = Quaternion<Scalar>::Identity();
  GyroOffset<Scalar> offset_;
  Rejection<Scalar> acceleration_;
  Rejection<Scalar> heading_;
  Scalar ramp_s_ = 0;        ///< time since initialisation began, up to its duration
  bool up_known_ = false;    ///< true once an accelerometer sample was processed
  bool over_range_ = false;  ///< flag of the same name
};

using Ahrs = BasicAhrs<double>;

extern template class BasicAhrs<float>;
extern template class BasicAhrs<double>;

}  // namespace sonopose::attitude
