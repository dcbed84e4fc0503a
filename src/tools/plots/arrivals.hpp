#pragma once
/// \file
/// Plot data of the recording itself: headings, and delay and quality of the fixes.

#include "recording/log_folder.hpp"

#include <vector>

namespace sonopose::plots {

/// A heading at its emission, or the latest of several consecutive ones.
struct HeadingMark {
  double time_s = 0;
  double heading_world_rad = 0;
  bool is_of_body = false;  ///< otherwise of a pair: a mount offset applies
};

/// A fix at its receipt. Several consecutive ones: the delay farthest from zero and the worst quality.
struct ArrivalMark {
  double time_s = 0;
  double delay_s = 0;
  double quality_percent = 0;  ///< NaN: unknown
};

struct Arrivals {
  static constexpr std::size_t max_marks = 384;
  std::vector<HeadingMark> headings;
  std::vector<ArrivalMark> fixes;
};

/// Collects the marks. Times are in seconds after the first event.
Arrivals arrivals_of(const recording::SensorLog& log);

}  // namespace sonopose::plots
