#pragma once
/// \file
/// Detects that a beacon was switched off or carried away.

#include "observation/beacon_observer.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstdint>

namespace sonopose::ros2::relay {

/// Presence of one beacon, updated about once per second.
class Presence {
public:
  enum class State : std::uint8_t {
    present,
    stale,  ///< no sample for `Limits::stale_after_ns`
    gone    ///< no sample for `Limits::gone_after_ns`; present again at the next one
  };

  struct Limits {
    TimeNs stale_after_ns = 5'000'000'000;
    TimeNs gone_after_ns = 30'000'000'000;
  };

  Presence(const Limits& limits, SteadyTime now) : limits_(limits), active_at_(now) {}

  /// `view`: observations since the last update. A beacon is active if it has poses, or samples by the status
  /// of its bridge. `has_bridge`: that status is recent.
  void update(const observation::BeaconView& view, bool has_bridge, SteadyTime now);

  [[nodiscard]] State state(SteadyTime now) const;
  [[nodiscard]] double silent_s(SteadyTime now) const { return seconds_between(active_at_, now); }

private:
  Limits limits_;
  SteadyTime active_at_;
};

}  // namespace sonopose::ros2::relay
