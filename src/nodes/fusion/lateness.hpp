#pragma once
/// \file
/// Measures how late the samples of a beacon arrive, without a common clock.

#include <sonopose/samples/time.hpp>

#include <algorithm>
#include <limits>

namespace sonopose::fusion {

/// Age of a sample above the least recent age. Ages may contain the constant difference of two clocks. A step
/// of one clock makes samples late for at most two windows, unlike with a minimum over all time.
class Lateness {
public:
  /// `age_ns`: arrival minus stamp of a sample that arrived at `now`. Returns its excess over the least age
  /// of the last one to two windows with samples. A pause of the samples, or of this process, discards at
  /// most one window.
  TimeNs on_sample(TimeNs age_ns, SteadyTime now) {
    constexpr TimeNs window_ns = 2'000'000'000;
    if (now - began_ > window_ns) {
      min_before_ns_ = min_ns_;
      min_ns_ = age_ns;
      began_ = now;
    }
    min_ns_ = std::min(min_ns_, age_ns);
    return saturated_difference(age_ns, std::min(min_ns_, min_before_ns_));
  }

private:
  static constexpr TimeNs none = std::numeric_limits<TimeNs>::max();
  SteadyTime began_;
  TimeNs min_ns_ = none;
  TimeNs min_before_ns_ = none;
};

}  // namespace sonopose::fusion
