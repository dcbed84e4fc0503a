#pragma once
/// \file
/// The motion between two IMU samples, and the joining of several such steps.

#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/samples.hpp>

#include <array>

namespace sonopose::estimation::kalman {

/// A calibrated IMU sample.
struct ImuMeasurement {
  TimeNs time_ns = 0;
  Vector3d rate_body_radps = Vector3d::Zero();
  Vector3d force_body_mps2 = Vector3d::Zero();
  bool is_mean = false;  ///< true for the mean since the previous sample, false for an instant

  bool operator==(const ImuMeasurement&) const = default;
};

/// Motion between two samples.
struct ImuStep {
  double duration_s = 0;
  Vector3d rate_body_radps = Vector3d::Zero();  ///< mean
  Vector3d force_body_mps2 = Vector3d::Zero();  ///< mean
  bool irregular = false;       ///< true if it is so long that the mean of its ends may miss much
  double velocity_std_mps = 0;  ///< velocity that it may miss
  double position_std_m = 0;    ///< position that it may miss
  double attitude_std_rad = 0;  ///< attitude that it may miss
  Vector3d made_up_turn_body_rad = Vector3d::Zero();     ///< turn of earlier readings that were held back
  Vector3d made_up_impulse_body_mps = Vector3d::Zero();  ///< integral of earlier forces that were held back
  Vector3d made_up_shift_body_m = Vector3d::Zero();      ///< distance that the body moved by them meanwhile

  bool operator==(const ImuStep&) const = default;
};
/// Motion between two samples. `usual_s` is the usual interval between samples.
[[nodiscard]] ImuStep step_between(const ImuMeasurement& last, const ImuMeasurement& next, double usual_s);

/// Detects shocks in the readings of a sensor, in m/s² or rad/s. A shock lasts a few samples, may exceed the
/// sensor's range and bends its mount, so its integral is hardly known. The motion of a body is smooth at
/// this scale.
struct ShockDetector {
  int intervals = 0;  ///< number of known intervals, up to 2
  double open_s = 0;  ///< duration of the incomplete interval
  Vector3d open_integral_body = Vector3d::Zero();
  double roughness = 0;                                                      ///< usual second difference
  std::array<Vector3d, 2> reading_body{Vector3d::Zero(), Vector3d::Zero()};  ///< means of the last intervals

  /// Adds a step. `smooth` is the largest second difference of the motion of a body at 10 ms. Returns the
  /// error, with a standard deviation of 1, that a shock adds to the integral.
  Vector3d add(const Vector3d& reading_body, double duration_s, double smooth);
  /// Density of white noise with this roughness, per √Hz.
  [[nodiscard]] double density_rthz() const;
  bool operator==(const ShockDetector&) const = default;
};

// Largest change of the motion of a body in 10 ms.
inline constexpr double max_jump_mps2 = 20.0;
inline constexpr double max_jump_radps = 4.0;
inline constexpr double dropped_share = 0.5;  ///< standard deviation of what a dropped integral may be worth

/// Holds back readings of a sensor that leave the last one suddenly, by far more than other readings of late.
/// If they return within some samples, they were wrong, and count as the last one. Otherwise, or if they
/// change gradually, as in a shock, they were right, and their integral is made up for.
struct SpikeFilter {
  double recent_jump = 0;                            ///< largest change of late, which fades
  double held_s = 0;                                 ///< duration of the held readings; 0: none
  double largest_jump = 0;                           ///< largest distance of one from the last one before
  double largest_change = 0;                         ///< largest distance of one from the one before it
  Vector3d held_body = Vector3d::Zero();             ///< latest of them
  Vector3d excess_integral_body = Vector3d::Zero();  ///< integral of these distances
  Vector3d excess_double_integral_body = Vector3d::Zero();

  /// Reading to use, and the integrals of those that were held back before it.
  struct Output {
    Vector3d reading_body;
    Vector3d made_up_body = Vector3d::Zero();        ///< integral of held readings that were right
    Vector3d made_up_shift_body = Vector3d::Zero();  ///< double integral of these
    Vector3d dropped_body = Vector3d::Zero();        ///< integral of held readings that were wrong
  };
  /// Adds a reading after `last_body`, the one that was used before it. `max_jump`: largest change of a
  /// body's motion in 10 ms.
  Output add(const Vector3d& last_body, const Vector3d& reading_body, double duration_s, double max_jump);
  /// Forgets the held readings.
  void forget_held() { *this = {.recent_jump = recent_jump}; }
  bool operator==(const SpikeFilter&) const = default;
};

/// Detects a gyroscope at the end of its range, where a reading repeats its largest value. The body may turn
/// faster then.
struct ClipDetector {
  Vector3d largest_body_radps = Vector3d::Zero();  ///< largest magnitude of a reading so far
  Vector3d repeats = Vector3d::Zero();             ///< number of consecutive readings at it

  /// Adds a reading. Returns the rate that it may miss, per axis.
  Vector3d add(const Vector3d& reading_body_radps);
  bool operator==(const ClipDetector&) const = default;
};

/// Detects an IMU that repeats its last sample, as some drivers do while they get none. Only noise on all
/// axes shows it: a simulation without noise, or a coarse sensor at rest, has equal samples too.
struct RepeatDetector {
  static constexpr int min_repeats = 3;  ///< a lost packet or two may be sent again too

  int repeats = 0;                           ///< equal samples in a row
  Vector3d equal_rates = Vector3d::Ones();   ///< share of rates equal to the one before, per axis
  Vector3d equal_forces = Vector3d::Ones();  ///< the same of the specific force

  /// True if this sample is a repetition of `last`, and not of a sensor that has equal samples.
  [[nodiscard]] bool repeats_with(const ImuMeasurement& last, const ImuMeasurement& sample) const;
  /// Adds a sample.
  void add(const ImuMeasurement& last, const ImuMeasurement& sample);
  bool operator==(const RepeatDetector&) const = default;
};

/// Updates the usual interval between samples with another one.
[[nodiscard]] double nominal_imu_period_s(double before_s, double step_s);

/// Joins several steps of a fast IMU into one. Rate and force are means, corrected for the turn of the body
/// between the steps (coning and sculling: Savage, Strapdown Inertial Navigation Integration Algorithm
/// Design, 1998).
class ImuPreintegrator {
public:
  [[nodiscard]] bool empty() const { return duration_s_ == 0.0; }
  [[nodiscard]] double duration_s() const { return duration_s_; }
  void add(const ImuStep& step);

  /// True if rate and force of the joined step are not those of the latest.
  [[nodiscard]] bool joined_differs() const {
    return duration_s_ > latest_.duration_s || !latest_.made_up_turn_body_rad.isZero(0.0) ||
           !latest_.made_up_impulse_body_mps.isZero(0.0);
  }
  /// Joined step. Requires at least one step.
  [[nodiscard]] ImuStep joined() const;
  [[nodiscard]] const ImuStep& latest() const { return latest_; }

  bool operator==(const ImuPreintegrator&) const = default;

private:
  double duration_s_ = 0;
  Vector3d turn_rad_ = Vector3d::Zero();     // Σ ω Δt
  Vector3d impulse_mps_ = Vector3d::Zero();  // Σ f Δt
  Vector3d coning_rad_ = Vector3d::Zero();
  Vector3d sculling_mps_ = Vector3d::Zero();
  Vector3d shift_m_ = Vector3d::Zero();
  ImuStep latest_;
};

void for_each_field(IsFieldsOf<ImuMeasurement> auto& imu, const auto& visit) {
  visit("time_ns", imu.time_ns);
  visit("rate_body_radps", imu.rate_body_radps);
  visit("force_body_mps2", imu.force_body_mps2);
  visit("is_mean", imu.is_mean);
}

void for_each_field(IsFieldsOf<ShockDetector> auto& shocks, const auto& visit) {
  visit("intervals", shocks.intervals);
  visit("open_s", shocks.open_s);
  visit("roughness", shocks.roughness);
  visit("open_integral_body", shocks.open_integral_body);
  visit("reading_before_body", shocks.reading_body[0]);
  visit("reading_last_body", shocks.reading_body[1]);
}

void for_each_field(IsFieldsOf<SpikeFilter> auto& spikes, const auto& visit) {
  visit("recent_jump", spikes.recent_jump);
  visit("held_s", spikes.held_s);
  visit("largest_jump", spikes.largest_jump);
  visit("largest_change", spikes.largest_change);
  visit("held_body", spikes.held_body);
  visit("excess_integral_body", spikes.excess_integral_body);
  visit("excess_double_integral_body", spikes.excess_double_integral_body);
}

void for_each_field(IsFieldsOf<RepeatDetector> auto& repeats, const auto& visit) {
  visit("repeats", repeats.repeats);
  visit("equal_rates", repeats.equal_rates);
  visit("equal_forces", repeats.equal_forces);
}

void for_each_field(IsFieldsOf<ClipDetector> auto& clip, const auto& visit) {
  visit("largest_body_radps", clip.largest_body_radps);
  visit("repeats", clip.repeats);
}

}  // namespace sonopose::estimation::kalman
