#pragma once
/// \file
/// Queue of fixes that wait for the report of the fusion, which has their weight.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <optional>

namespace sonopose::ros2::relay {

/// A fix that can be published.
struct ReadyFix {
  Vector3d position_world_m = Vector3d::Zero();
  TimeNs emission_time_ns = 0;
  std::optional<Covariance<3>> covariance_world_m2;  ///< covariance from the fix's source, if it knows it
  std::optional<double> weight;                      ///< from the report of a fusion; empty without a report
};

/// Returns each fix of one beacon once and in order, however many fusions report on it. Times are of the
/// steady clock. Not thread-safe. Does not allocate memory.
class FixQueue {
public:
  static constexpr std::size_t max_waiting = 8;

  /// Released fixes: at most all waiting ones and the new one.
  struct Ready {
    std::array<ReadyFix, max_waiting + 1> fixes;
    std::size_t count = 0;

    [[nodiscard]] auto begin() const { return fixes.begin(); }
    [[nodiscard]] auto end() const { return fixes.begin() + static_cast<std::ptrdiff_t>(count); }
  };

  /// Takes a new fix. `fusion_runs`: expect a report.
  Ready on(const UltrasonicFix& fix, SteadyTime now, bool fusion_runs);
  /// Takes a report of a fusion. Returns its fix, after those that have waited longer.
  Ready on(const FixReport& report);
  /// Returns the fixes without a report for `timeout_ns`.
  Ready overdue(SteadyTime now);
  [[nodiscard]] bool has_overdue(SteadyTime now) const;

  static constexpr TimeNs timeout_ns = 100'000'000;

private:
  struct Key {
    std::uint64_t sequence = 0;
    TimeNs emission_time_ns = 0;
    bool operator==(const Key&) const = default;
  };
  struct Waiting {
    Key key;
    Vector3d position_world_m = Vector3d::Zero();
    std::optional<Covariance<3>> covariance_world_m2;
    SteadyTime since;
  };

  void release(const Waiting& fix, std::optional<double> weight, Ready& ready);
  void remove_first();
  void release_first(Ready& ready);
  [[nodiscard]] bool is_released(const Key& key) const;

  std::array<Waiting, max_waiting> waiting_{};
  std::size_t waiting_count_ = 0;
  std::array<Key, 32> released_{};  ///< ring buffer of the latest
  std::size_t next_released_ = 0;
};

}  // namespace sonopose::ros2::relay
