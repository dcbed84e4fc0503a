#pragma once
/// \file
/// Recent headings: the last one, for a start, and runs of rejected ones.

#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/samples.hpp>

#include <optional>

namespace sonopose::estimation::kalman {

inline constexpr double max_heading_interval_s = 10.0;  ///< upper limit of a counted interval
inline constexpr int proven_offset_samples = 40;        ///< headings that prove a constant offset

struct HeadingGate {
  TimeNs used_ns = 0;            ///< time of the last heading used
  double heading_world_rad = 0;  ///< that heading, turned to the latest IMU sample while it is current
  double std_rad = 0;            ///< its own standard deviation; 0: unknown
  bool is_current = false;       ///< true if it is recent and no IMU gap followed: a start may use it
  TimeNs rejected_since_ns = 0;  ///< time of the first heading in the current run of rejected ones; 0: none
  TimeNs rejected_ns = 0;        ///< time of the last rejected heading
  int rejected_in_row = 0;
  TimeNs seen_ns = 0;      ///< time of the last heading, used or not
  double interval_s = 0;   ///< usual interval between headings, up to max_heading_interval_s
  double offset_rad = 0;   ///< mean difference of headings from the yaw of ImuModel::wrong_headings
  int offset_samples = 0;  ///< number of headings in a row with this offset, up to `proven_offset_samples`

  /// Registers a heading, used or not.
  void add(TimeNs time_ns);
  /// Deviation of this difference from the mean of the earlier ones, which it joins; it starts a new mean if
  /// it is further off than `max_rad`.
  std::optional<double> add_offset(double difference_rad, double max_rad);
  /// Registers a rejected heading. Returns true if headings have been rejected for so long that they must be
  /// believed.
  bool reject(TimeNs time_ns);
  /// Ends the run of rejected headings.
  void accept();
  /// Time without a heading after which a run of them has ended.
  [[nodiscard]] double rejection_timeout_s() const;
  bool operator==(const HeadingGate&) const = default;
};

void for_each_field(IsFieldsOf<HeadingGate> auto& gate, const auto& visit) {
  visit("used_ns", gate.used_ns);
  visit("heading_world_rad", gate.heading_world_rad);
  visit("std_rad", gate.std_rad);
  visit("is_current", gate.is_current);
  visit("rejected_since_ns", gate.rejected_since_ns);
  visit("rejected_ns", gate.rejected_ns);
  visit("rejected_in_row", gate.rejected_in_row);
  visit("seen_ns", gate.seen_ns);
  visit("interval_s", gate.interval_s);
  visit("offset_rad", gate.offset_rad);
  visit("offset_samples", gate.offset_samples);
}

}  // namespace sonopose::estimation::kalman
