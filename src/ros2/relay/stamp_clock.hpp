#pragma once
/// \file
/// The clock of the stamps of a beacon's IMU.

#include <sonopose/samples/time.hpp>

namespace sonopose::ros2::relay {

/// A recording that is played back has stamps of another time than the host's. The delay of a fix is then
/// measured in the clock of the IMU's stamps, because the engines also compare a fix with these.
class StampClock {
public:
  /// A sample of the IMU: its stamp, and its reception in the host's clock.
  void on_imu(TimeNs stamp_ns, TimeNs received_ns) { lag_ns_ = saturated_difference(received_ns, stamp_ns); }

  /// A time of the host's clock in the clock of the stamps. The two are the same clock if they differ by at
  /// most `max_transport_ns`, or before the first sample.
  [[nodiscard]] TimeNs at(TimeNs host_ns) const {
    const bool is_same = lag_ns_ >= -max_transport_ns && lag_ns_ <= max_transport_ns;
    return is_same ? host_ns : saturated_difference(host_ns, lag_ns_);
  }

  static constexpr TimeNs max_transport_ns = 1'000'000'000;

private:
  TimeNs lag_ns_ = 0;
};

}  // namespace sonopose::ros2::relay
