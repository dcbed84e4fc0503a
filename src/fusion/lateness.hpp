#pragma once
/// \file
/// How late the samples of a beacon arrive, without a common clock.

#include <sonopose/samples/time.hpp>

#include <algorithm>
#include <limits>

namespace sonopose::fusion {

/// The age of a sample above the least age of the recent ones. Ages may contain the constant difference of
/// two clocks. A step of one of them makes samples late for at most two windows, unlike a minimum over all
/// time.
class Lateness {
public:
  /// `age_ns`: arrival minus stamp of a sample that arrived at `now`. Returns by how much it is above the
  /// least age of the last one to two windows in which samples arrived. A pause of the samples, or of this
  /// process, forgets at most one window.
  TimeNs on_sample(TimeNs age_ns, SteadyTime now) {
    constexpr TimeNs window_ns = 2'000'000'000;
    if (now - began_ > window_ns) {
      least_before_ns_ = least_ns_;
      least_ns_ = age_ns;
      began_ = now;
    }
    least_ns_ = std::min(least_ns_, age_ns);
    return saturated_difference(age_ns, std::min(least_ns_, least_before_ns_));
  }

private:
  static constexpr TimeNs none = std::numeric_limits<TimeNs>::max();
  SteadyTime began_;
  TimeNs least_ns_ = none;
  TimeNs least_before_ns_ = none;
};

}  // namespace sonopose::fusion
