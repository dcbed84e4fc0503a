#pragma once
/// \file
/// Recognises a driver that sends its last position again until it has a new one.

#include <sonopose/samples/samples.hpp>

#include <optional>

namespace sonopose::ros2 {

/// Takes each position of one topic once. A driver repeats if the same value comes several times between
/// positions that move; a body at rest may have equal positions. Then an equal one is used after `hold_ns` at
/// the earliest. Times are those of measurement. Not thread-safe.
class FixRepeats {
public:
  static constexpr double moved_m = 0.02;         ///< a longer step is motion
  static constexpr TimeNs hold_ns = 500'000'000;  ///< a later equal position is one of a body at rest
  static constexpr int enough_steps = 3;          ///< steps in a row, each after a repeated position

  /// Returns true if the fix is a new one.
  bool is_new(const UltrasonicFix& fix);

  /// True once the driver is known to repeat.
  [[nodiscard]] bool are_known() const { return steps_ >= enough_steps; }

private:
  std::optional<UltrasonicFix> latest_;  ///< latest new one
  bool has_repeats_ = false;             ///< the latest new one came again
  int steps_ = 0;
};

}  // namespace sonopose::ros2
