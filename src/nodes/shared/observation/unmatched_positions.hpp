#pragma once
/// \file
/// Positions that wait for another position of the same instant.

#include <sonopose/samples/samples.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

namespace sonopose::observation {

/// Positions of one stream without a partner in another stream so far. Both streams are in order.
class UnmatchedPositions {
public:
  void store(TimeNs time_ns, const Vector3d& position_world_m) {
    while (!is_empty() && waiting_.back().time_ns >= time_ns) waiting_.pop_back();  // the clock stepped back
    if (waiting_.size() - first_ == max_positions) ++first_;
    if (first_ > max_positions) forget_extracted();
    waiting_.push_back({time_ns, position_world_m});
  }

  /// Removes and returns the position of `time_ns`. Also removes all earlier ones: their partners were lost.
  std::optional<Vector3d> extract(TimeNs time_ns) {
    const auto begin = waiting_.begin() + static_cast<std::ptrdiff_t>(first_);
    const auto found =
        std::lower_bound(begin, waiting_.end(), time_ns,
                         [](const Waiting& each, TimeNs searched_ns) { return each.time_ns < searched_ns; });
    if (found == waiting_.end() || found->time_ns != time_ns) return std::nullopt;
    const Vector3d position_world_m = found->position_world_m;
    first_ = static_cast<std::size_t>(found - waiting_.begin()) + 1;
    if (is_empty()) forget_extracted();
    return position_world_m;
  }

private:
  /// More than one second of samples at any supported rate.
  static constexpr std::size_t max_positions = 2048;

  struct Waiting {
    TimeNs time_ns = 0;
    Vector3d position_world_m;
  };

  [[nodiscard]] bool is_empty() const { return first_ == waiting_.size(); }
  void forget_extracted() {
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
  }

  std::vector<Waiting> waiting_;  ///< by time, from `first_` on: removing the first moves no other
  std::size_t first_ = 0;
};

}  // namespace sonopose::observation
