#pragma once
/// \file
/// Joins the samples of an accelerometer and of a gyroscope that a driver publishes apart.

#include <sonopose/ros2/messages/input.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace sonopose::ros2 {

/// One beacon's samples at the times of its gyroscope, with the specific force interpolated to them. A sample
/// waits for a later specific force for at most `max_wait_ns`; then it has the latest one. Complete samples
/// pass. Times of waiting are of the steady clock. Not thread-safe.
class ImuJoiner {
public:
  static constexpr TimeNs max_wait_ns = 20'000'000;
  /// Longest time between a sample and the specific force that it gets.
  static constexpr TimeNs max_age_ns = 50'000'000;
  static constexpr std::size_t max_waiting = 64;

  /// Takes a message, and appends the samples that are complete to `ready`.
  void on(const ros2::ReceivedImu& received, SteadyTime now, std::vector<ImuSample>& ready);

  /// Appends samples that have waited long enough.
  void update(SteadyTime now, std::vector<ImuSample>& ready);

  /// Number of joined samples.
  [[nodiscard]] std::uint64_t joined() const { return joined_; }
  /// Number of samples without a specific force near them, which are not used.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

private:
  struct Waiting {
    ImuSample sample;
    SteadyTime since;
  };
  struct Force {
    TimeNs time_ns = 0;
    Vector3d force_body_mps2 = Vector3d::Zero();
  };

  void release_first(std::vector<ImuSample>& ready);
  /// Returns the specific force at a time; empty if none is near.
  [[nodiscard]] std::optional<Vector3d> force_at(TimeNs time_ns) const;

  std::deque<Waiting> waiting_;
  std::deque<Force> forces_;  ///< the latest, in order of time
  std::uint64_t joined_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace sonopose::ros2
