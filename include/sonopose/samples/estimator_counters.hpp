#pragma once

#include <cstdint>

namespace sonopose {

/// Counts of the events that an estimator has processed since it was made. A reset does not clear them.
struct EstimatorCounters {
  std::uint64_t imu_samples = 0;
  std::uint64_t fixes_used = 0;
  std::uint64_t fixes_rejected = 0;
  std::uint64_t headings = 0;
  std::uint64_t twists_used = 0;
  std::uint64_t twists_rejected = 0;  ///< velocities that contradict the estimate, as when wheels slip
  std::uint64_t twists_unused =
      0;  ///< without linear velocity, before the first fix, too dense, or turned off
  std::uint64_t samples_invalid = 0;  ///< not finite, impossible, out of order, or too late
  std::uint64_t imu_gaps = 0;         ///< silences of the IMU not integrated over

  bool operator==(const EstimatorCounters&) const = default;

  /// Counts since `before`.
  EstimatorCounters operator-(const EstimatorCounters& before) const {
    return {.imu_samples = imu_samples - before.imu_samples,
            .fixes_used = fixes_used - before.fixes_used,
            .fixes_rejected = fixes_rejected - before.fixes_rejected,
            .headings = headings - before.headings,
            .twists_used = twists_used - before.twists_used,
            .twists_rejected = twists_rejected - before.twists_rejected,
            .twists_unused = twists_unused - before.twists_unused,
            .samples_invalid = samples_invalid - before.samples_invalid,
            .imu_gaps = imu_gaps - before.imu_gaps};
  }
};

/// Calls `visit(name, counter)` for each counter; `Counters` is EstimatorCounters or const EstimatorCounters.
template <class Counters, class Visit>
void for_each_counter(Counters& counters, const Visit& visit) {
  visit("imu_samples", counters.imu_samples);
  visit("fixes_used", counters.fixes_used);
  visit("fixes_rejected", counters.fixes_rejected);
  visit("headings", counters.headings);
  visit("twists_used", counters.twists_used);
  visit("twists_rejected", counters.twists_rejected);
  visit("twists_unused", counters.twists_unused);
  visit("samples_invalid", counters.samples_invalid);
  visit("imu_gaps", counters.imu_gaps);
}

}  // namespace sonopose
