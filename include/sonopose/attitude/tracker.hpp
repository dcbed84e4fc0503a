#pragma once
/// \file
/// An attitude filter fed with IMU samples. Their stamps give the time step; the first sample sets the start.

#include <sonopose/attitude/filter.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/time_jump.hpp>

#include <cmath>
#include <utility>

namespace sonopose::attitude {

/// Use of the magnetometer when a sample becomes the measurement of any filter.
struct FieldUse {
  bool use_magnetometer = false;
  double north_deg = 90;  ///< direction of magnetic north in the world, counter-clockwise from +X

  Measurement<double> measurement_of(const ImuSample& imu, double dt_s) const {
    Measurement<double> measurement{dt_s, imu.angular_velocity_body_radps, imu.specific_force_body_mps2};
    if (use_magnetometer && imu.magnetic_field_body_t) {
      const double north_rad = north_deg * geometry::radians_per_degree;
      measurement.magnetic_field_body_t = *imu.magnetic_field_body_t;
      measurement.north_world = {std::cos(north_rad), std::sin(north_rad)};
    }
    return measurement;
  }
};

/// Initial orientation: level with the specific force, and with the field's level part pointing north, if
/// there is one. A force of zero length or a field without a horizontal part carries no information.
Quaterniond first_orientation(const Measurement<double>& measurement);

/// True if all values are finite and below 1000 rad/s, 10 km/s² and 1 T. No sensor measures more.
inline bool is_measurement(const ImuSample& imu) {
  const auto below = [](const Vector3d& vector, double limit) {
    return vector.allFinite() && vector.cwiseAbs().maxCoeff() < limit;
  };
  return below(imu.angular_velocity_body_radps, 1e3) && below(imu.specific_force_body_mps2, 1e4) &&
         (!imu.magnetic_field_body_t || below(*imu.magnetic_field_body_t, 1.0));
}

/// Tracks attitude with a double-precision filter: `Tracker<Mahony>`, or `Tracker<AnyFilter>` to let the
/// settings select it.
template <Filter F>
class Tracker {
public:
  Tracker(typename F::Settings settings, FieldUse field) : settings_(std::move(settings)), field_(field) {}

  /// Processes one sample. Returns false and does nothing if the sample is not a measurement (not finite or
  /// beyond any sensor's range), is earlier than the previous one, or is so much later that the next ones
  /// must confirm it (is_unconfirmed_jump). After `max_backward_samples` earlier samples in a row, the clock
  /// was set back: the filter continues from there.
  bool on(const ImuSample& imu) {
    if (!is_measurement(imu)) return false;
    if (started_ && is_unconfirmed_jump(announced_ns_, ahead_in_row_, time_ns_, imu.sensor_time_ns))
      return false;
    const bool is_backward = started_ && imu.sensor_time_ns < time_ns_;
    backward_in_row_ = is_backward ? backward_in_row_ + 1 : 0;
    if (is_backward && backward_in_row_ < max_backward_samples) return false;
    const double dt_s = started_ && !is_backward ? seconds_between(time_ns_, imu.sensor_time_ns) : 0.0;
    backward_in_row_ = 0;
    const Measurement<double> measurement = field_.measurement_of(imu, dt_s);
    if (!started_) filter_.reset(first_orientation(measurement));
    started_ = true;
    time_ns_ = imu.sensor_time_ns;
    filter_.update(settings_, measurement);
    return true;
  }

  [[nodiscard]] const F& filter() const { return filter_; }
  F& filter() { return filter_; }

private:
  typename F::Settings settings_;
  FieldUse field_;
  F filter_;
  bool started_ = false;
  TimeNs time_ns_ = 0;
  int backward_in_row_ = 0;
  TimeNs announced_ns_ = 0;  ///< unconfirmed stamp far ahead; 0: none
  int ahead_in_row_ = 0;
};

}  // namespace sonopose::attitude
