#pragma once
/// \file
/// A change of a beacon's state as a plain value: recorded where samples arrive, put into words elsewhere.

#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sonopose::transitions {

/// The kind of change. States begin and end; other kinds are single events.
enum class Kind : std::uint8_t {
  found,
  initialised,
  restarted,  ///< the estimate was discarded
  relocated,
  stale,
  frozen,
  gated,
  converging,
  low_trust,
  imu_inconsistent,
  fixes_inconsistent,
  heading_unknown,
  imu_gap,
  imu_silent,
  fixes_silent,
  poses_silent,
  bridge_lost,
  overloaded  ///< state of the whole process: the address is all_beacons
};
inline constexpr std::size_t kind_count = 18;

struct Transition {
  BeaconAddress address = 0;
  Kind kind = Kind::found;
  bool begins = true;       ///< false: the state has ended
  double lasted_s = 0;      ///< duration of an ended state
  double value = 0;         ///< relocated: the jump in m; gated: the latest innovation in m; stale: age in s
  std::uint64_t count = 0;  ///< gated: fixes so far

  bool operator==(const Transition&) const = default;
};

/// The transitions of one beacon since they were last handled. Bounded, without allocations; not thread-safe.
class TransitionQueue {
public:
  void add(const Transition& transition) noexcept {
    if (size_ < values_.size()) {
      values_[size_++] = transition;
    } else {
      ++dropped_;
    }
  }

  [[nodiscard]] bool empty() const noexcept { return size_ == 0 && dropped_ == 0; }
  [[nodiscard]] std::span<const Transition> values() const noexcept {
    return std::span(values_).first(size_);
  }
  /// Number of transitions that found no space.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

  void clear() noexcept {
    size_ = 0;
    dropped_ = 0;
  }

private:
  std::array<Transition, 32> values_{};
  std::size_t size_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace sonopose::transitions
