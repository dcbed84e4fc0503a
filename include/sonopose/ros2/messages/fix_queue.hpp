#pragma once
/// \file
/// Fixes wait a moment for what the fusion says of them: how much each is worth.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <optional>

namespace sonopose::ros2 {

/// A fix that may go out.
struct ReadyFix {
  Vector3d position_world_m = Vector3d::Zero();
  TimeNs emission_time_ns = 0;
  std::optional<double> weight;  ///< what the fusion gave it; empty where none said anything
};

/// The fixes of one beacon, each out once, in their order, however many fusions report on it. Times are of
/// the steady clock. Not for several threads at once. Allocates nothing.
class FixQueue {
public:
  static constexpr std::size_t most_waiting = 8;

  /// At most as many as can wait, and the one that came.
  struct Ready {
    std::array<ReadyFix, most_waiting + 1> fixes;
    std::size_t count = 0;

    [[nodiscard]] auto begin() const { return fixes.begin(); }
    [[nodiscard]] auto end() const { return fixes.begin() + static_cast<std::ptrdiff_t>(count); }
  };

  /// A fix came. `fusion_runs`: whether a report is worth waiting for.
  Ready on(const UltrasonicFix& fix, SteadyTime now, bool fusion_runs);
  /// A fusion reported on one: that one goes out, and before it those that wait since longer.
  Ready on(const FixReport& report);
  /// Those that nobody reported on for `timeout_ns`.
  Ready overdue(SteadyTime now);

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
    SteadyTime since;
  };

  void put_out(const Key& key, const Vector3d& position_world_m, std::optional<double> weight, Ready& ready);
  void put_first_out(Ready& ready);
  [[nodiscard]] bool is_out(const Key& key) const;

  std::array<Waiting, most_waiting> waiting_{};
  std::size_t waiting_count_ = 0;
  std::array<Key, 32> out_{};  ///< the latest ones
  std::size_t next_out_ = 0;
};

}  // namespace sonopose::ros2
