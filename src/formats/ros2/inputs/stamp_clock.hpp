#pragma once
/// \file
/// Clock of the stamps of a beacon's IMU.

#include <sonopose/samples/time.hpp>

namespace sonopose::ros2 {

/// Relates host time to the IMU's stamps, which in a played recording belong to another time. The delay of a
/// fix is then measured in the clock of these stamps, because the engines also compare a fix with them.
class StampClock {
public:
  /// Takes the stamp of an IMU sample, and its reception in the host's clock.
  void on_imu(TimeNs stamp_ns, TimeNs received_ns) { lag_ns_ = saturated_difference(received_ns, stamp_ns); }

  /// Converts a host time to the clock of the stamps. Before the first sample, or if they differ by at most
  /// `max_transport_ns`, the two are the same clock.
  [[nodiscard]] TimeNs at(TimeNs host_ns) const {
    const bool is_same = lag_ns_ >= -max_transport_ns && lag_ns_ <= max_transport_ns;
    return is_same ? host_ns : saturated_difference(host_ns, lag_ns_);
  }

  static constexpr TimeNs max_transport_ns = 1'000'000'000;

private:
  TimeNs lag_ns_ = 0;
};

}  // namespace sonopose::ros2
