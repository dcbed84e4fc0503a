#pragma once
/// \file
/// Stamps that are far ahead: of a clock that was set or a sensor that was silent, or corrupt.

#include <sonopose/samples/time.hpp>

namespace sonopose {

/// Number of samples in a row that are refused before the next one confirms a step ahead.
inline constexpr int max_ahead_samples = 9;

/// True if a stamp is so far after `now_ns` that samples after it must confirm it; otherwise a few corrupt
/// stamps would exclude all later samples. `announced_ns`: the latest unconfirmed stamp; 0: none.
/// `ahead_in_row`: number of unconfirmed stamps in a row.
constexpr bool is_unconfirmed_jump(TimeNs& announced_ns, int& ahead_in_row, TimeNs now_ns, TimeNs stamp_ns) {
  constexpr TimeNs max_step_ns = 2'000'000'000;
  const TimeNs before_ns = announced_ns;
  const int before_in_row = ahead_in_row;
  announced_ns = 0;
  ahead_in_row = 0;
  if (saturated_difference(stamp_ns, now_ns) <= max_step_ns) return false;
  const bool is_next =
      before_ns != 0 && stamp_ns >= before_ns && saturated_difference(stamp_ns, before_ns) <= max_step_ns;
  if (is_next && before_in_row >= max_ahead_samples) return false;
  announced_ns = stamp_ns;
  ahead_in_row = is_next ? before_in_row + 1 : 1;
  return true;
}

}  // namespace sonopose
