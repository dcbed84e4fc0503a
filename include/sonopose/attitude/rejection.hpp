#pragma once
/// \file
/// Rejection of a sensor that contradicts the estimate, in two forms (the AHRS document's acceleration and
/// magnetic rejection). Both count by time: each step counts with its duration. At a constant step this
/// equals counting samples; at a varying one it stays meaningful.

#include <algorithm>
#include <cmath>

namespace sonopose::attitude {

/// Angle in [0, π] between a measured and an estimated direction, without trigonometry.
template <class Scalar>
struct AngleError {
  Scalar sine = 0;
  Scalar cosine = 1;

  [[nodiscard]] Scalar angle_rad() const { return std::atan2(sine, cosine); }

  [[nodiscard]] bool within(Scalar angle_rad) const {
    // The bounds θ(1 − θ²/6) ≤ sin θ ≤ θ usually decide; a sine takes as long as the rest of the comparison.
    if (cosine > 0 && angle_rad <= 1) {
      if (sine <= angle_rad * (1 - angle_rad * angle_rad / 6)) return true;
      if (sine > angle_rad) return false;
    }
    return this->angle_rad() <= angle_rad;
  }
  bool operator==(const AngleError&) const = default;
};

/// Limits of one sensor.
template <class Scalar>
struct RejectionLimits {
  Scalar threshold_rad;  ///< 0: never rejected
  Scalar timeout_s;      ///< 0: never rejected

  [[nodiscard]] bool active() const { return threshold_rad > 0 && timeout_s > 0; }
};

/// State of one sensor.
template <class Scalar>
struct Rejection {
  AngleError<Scalar> error;  ///< error of the last measurement
  Scalar timer_s = 0;        ///< time counted towards the timeout
  bool ignored = false;      ///< true if the last measurement was ignored
  bool timed_out = false;    ///< recovery form: in recovery; seed form: see AhrsFlags

  /// Form `seed`: returns true if the time ignored exceeds ten times the time used by more than the timeout.
  /// Call it before assessing a measurement.
  [[nodiscard]] bool expired(const RejectionLimits<Scalar>& limits) const {
    return limits.active() && timer_s > limits.timeout_s;
  }

  /// Form `seed`: assesses a measurement with the error `error` over `dt_s`. A used one takes ten times its
  /// duration off the timer; an ignored one adds its duration.
  void update_seed(const RejectionLimits<Scalar>& limits, bool use_anyway, Scalar dt_s) {
    ignored = limits.active() && !use_anyway && !error.within(limits.threshold_rad);
    timer_s = ignored ? timer_s + dt_s : std::max(timer_s - 10 * dt_s, Scalar(0));
  }

  /// Form `recovery`: assesses a measurement. One outside the threshold adds its duration to the timer; one
  /// inside takes off nine times its duration. Once the timer reaches the timeout, all are used until it is
  /// back at 0.
  void update_recovery(const RejectionLimits<Scalar>& limits, bool use_anyway, Scalar dt_s) {
    const bool agrees = !limits.active() || use_anyway || error.within(limits.threshold_rad);
    timer_s += agrees ? -9 * dt_s : dt_s;
    timed_out = limits.active() && timer_s > (timed_out ? Scalar(0) : limits.timeout_s);
    timer_s = std::clamp(timer_s, Scalar(0), limits.timeout_s);
    ignored = !agrees && !timed_out;
  }

  bool operator==(const Rejection&) const = default;
};

}  // namespace sonopose::attitude
