#pragma once
/// \file
/// Earlier states of an engine, to return to: dense over the last 0.3 s, in which most fixes were measured,
/// and sparse before.

#include <sonopose/estimation/kalman/state.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sonopose::estimation::kalman {

/// State after the sample at its time, and before the fixes and headings of that time.
struct Checkpoint {
  State state;
  std::uint64_t next_imu = 0;  ///< number of the first sample that is not part of it
};

/// A store of checkpoints. Its memory is allocated at construction, and most of it is never touched.
class Checkpoints {
public:
  static constexpr std::size_t capacity = 12;

  Checkpoints();

  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] const Checkpoint& oldest() const { return slots_[order_.front()]; }
  [[nodiscard]] const Checkpoint& latest() const { return slots_[order_[count_ - 1]]; }

  /// True if a state of this time is to be added.
  [[nodiscard]] bool is_due(TimeNs time_ns) const;

  /// Adds the latest state and removes those that are too dense or too old.
  void add(const State& state, std::uint64_t next_imu);

  /// Returns to the latest checkpoint that is not after this time, or to the oldest.
  const Checkpoint& rewind(TimeNs time_ns);

  /// Removes the oldest checkpoint, unless it is the only one. Returns true if it was removed.
  bool drop_oldest();

  void clear() { count_ = 0; }

private:
  [[nodiscard]] TimeNs time_ns(std::size_t i) const { return slots_[order_[i]].state.imu.time_ns; }
  void remove(std::size_t i);

  std::vector<Checkpoint> slots_;
  std::array<std::uint8_t, capacity> order_{};  // slots from the oldest state to the latest, then unused ones
  std::size_t count_ = 0;
};

}  // namespace sonopose::estimation::kalman
