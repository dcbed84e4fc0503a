#pragma once
/// \file
/// Measured velocities of the body, and the verdicts on them.

#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/samples.hpp>

namespace sonopose::estimation::kalman {

/// Velocity of a point of the body, in body axes.
struct TwistMeasurement {
  TimeNs time_ns = 0;
  TimeNs stamp_ns = 0;
  Vector3d velocity_body_mps = Vector3d::Zero();
  Vector3d std_mps = Vector3d::Constant(-1);  ///< per axis; negative: not measured
  int constrained = 0;  ///< bits of TwistAxis: known from how the vehicle moves, not measured

  bool operator==(const TwistMeasurement&) const = default;
};

/// Recent velocities, as judged by the best filter.
struct TwistGate {
  TimeNs seen_ns = 0;
  double interval_s = 0;                            ///< usual interval, up to 1 s; 0: unknown
  Vector3d mean_innovation_mps = Vector3d::Zero();  ///< mean of about the last 0.15 s, per axis
  TimeNs rejected_since_ns = 0;  ///< beginning of the current run of contradictions; 0: none
  TimeNs rejected_ns = 0;        ///< time of the last contradiction
  bool rejected = false;         ///< true if the latest one was: the wheels slip
  /// Time of motion over which they agreed with the filter that uses none, less that over which they did
  /// not; 0 … 20 s.
  double agreed_s = 0;

  /// True if they agreed for long: then other fixes or headings are wrong rather than they.
  [[nodiscard]] bool are_proven() const {
    constexpr double proven_after_s = 4.0;
    return agreed_s > proven_after_s;
  }

  bool operator==(const TwistGate&) const = default;
};

void for_each_field(IsFieldsOf<TwistMeasurement> auto& twist, const auto& visit) {
  visit("time_ns", twist.time_ns);
  visit("stamp_ns", twist.stamp_ns);
  visit("velocity_body_mps", twist.velocity_body_mps);
  visit("std_mps", twist.std_mps);
  visit("constrained", twist.constrained);
}

void for_each_field(IsFieldsOf<TwistGate> auto& gate, const auto& visit) {
  visit("seen_ns", gate.seen_ns);
  visit("interval_s", gate.interval_s);
  visit("mean_innovation_mps", gate.mean_innovation_mps);
  visit("rejected_since_ns", gate.rejected_since_ns);
  visit("rejected_ns", gate.rejected_ns);
  visit("rejected", gate.rejected);
  visit("agreed_s", gate.agreed_s);
}

}  // namespace sonopose::estimation::kalman
