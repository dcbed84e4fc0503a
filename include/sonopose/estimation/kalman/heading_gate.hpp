#pragma once
/// \file
/// The recent headings: the last one for a start, and runs of rejected ones.

#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/samples.hpp>

namespace sonopose::estimation::kalman {

inline constexpr double longest_heading_interval_s = 10.0;  ///< a longer one counts as this

struct HeadingGate {
  TimeNs used_ns = 0;            ///< last heading that was used
  double heading_world_rad = 0;  ///< it, turned to the latest IMU sample while it is current
  bool is_current = false;       ///< it is recent, and no gap of the IMU followed: a start may use it
  TimeNs rejected_since_ns = 0;  ///< first rejected heading of the present run of them; 0: none
  TimeNs rejected_ns = 0;        ///< last rejected heading
  int rejected_in_row = 0;
  TimeNs seen_ns = 0;     ///< last heading, used or not
  double interval_s = 0;  ///< between most headings; up to longest_heading_interval_s

  /// Registers a heading, used or not.
  void see(TimeNs time_ns);
  /// Registers a rejected heading. True if headings have been rejected for so long that they must be
  /// believed.
  bool reject(TimeNs time_ns);
  /// Ends the run of rejected headings.
  void accept();
  /// Time without a heading after which a run of them has ended.
  [[nodiscard]] double run_ends_s() const;
  bool operator==(const HeadingGate&) const = default;
};

void for_each_field(IsFieldsOf<HeadingGate> auto& gate, const auto& visit) {
  visit("used_ns", gate.used_ns);
  visit("heading_world_rad", gate.heading_world_rad);
  visit("is_current", gate.is_current);
  visit("rejected_since_ns", gate.rejected_since_ns);
  visit("rejected_ns", gate.rejected_ns);
  visit("rejected_in_row", gate.rejected_in_row);
  visit("seen_ns", gate.seen_ns);
  visit("interval_s", gate.interval_s);
}

}  // namespace sonopose::estimation::kalman
