#pragma once
/// \file
/// Pairs each pose with its IMU sample, in any order of arrival.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace sonopose::ros2::relay {

/// Pairs poses and samples of one beacon. They come from different processes, so a pose may overtake its
/// sample, and then waits. Times are of the steady clock. Not thread-safe. Does not allocate memory.
class ImuPairing {
public:
  static constexpr std::size_t max_kept = 64;
  static constexpr TimeNs timeout_ns = 1'000'000'000;

  /// Returns the sample of a measured pose, if it has arrived. Otherwise the pose waits for it.
  std::optional<ImuSample> on(const FusedPose& pose, SteadyTime now);

  /// Takes a new sample. Returns the pose that waited for it, if any. Gives up poses of earlier samples,
  /// because samples arrive in order.
  std::optional<FusedPose> on(const ImuSample& sample);

  /// Gives up poses that have waited for `timeout_ns`.
  void drop_overdue(SteadyTime now);

  /// Number of poses whose sample did not arrive, without those from before the first sample.
  [[nodiscard]] std::uint64_t given_up() const { return given_up_; }

private:
  struct Waiting {
    FusedPose pose;
    SteadyTime since;
  };

  void give_up_first();
  void remove_first();

  std::array<ImuSample, max_kept> samples_{};  ///< ring buffer of the latest
  std::size_t sample_count_ = 0;               ///< since the start
  std::array<Waiting, max_kept> waiting_{};    ///< ring buffer
  std::size_t first_waiting_ = 0;
  std::size_t waiting_count_ = 0;
  std::optional<std::uint64_t> first_sequence_;  ///< first number since the bridge started numbering
  std::uint64_t latest_sequence_ = 0;
  std::uint64_t given_up_ = 0;
};

}  // namespace sonopose::ros2::relay
