#pragma once
/// \file
/// A topic of a recording with true poses.

#include "ros2/inputs/input_frames.hpp"
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace sonopose::ros2::bag {

/// Converts true poses of the base, or of the child frame of Odometry, to those of its IMU.
class TruthInput {
public:
  /// `frames` must outlive it.
  explicit TruthInput(const InputFrames& frames) : frames_(frames) {}

  /// Takes a message; empty if its stamp is invalid.
  std::optional<TruthSample> on(const PoseStamped& message, BeaconAddress address, TimeNs received_ns);
  std::optional<TruthSample> on(const PoseWithCovarianceStamped& message, BeaconAddress address,
                                TimeNs received_ns);
  std::optional<TruthSample> on(const Odometry& message, BeaconAddress address, TimeNs received_ns);

  /// Assumptions about the messages. `fix_frame`: that of the fixes; empty if there are none.
  [[nodiscard]] std::vector<std::string> assumptions(const std::string& fix_frame) const;

private:
  /// Place of the IMU in a frame. One that is not connected with the base counts as the base.
  Mount imu_in(const std::string& frame, BeaconAddress address);
  std::optional<TimeNs> time_of(const Header& header, TimeNs received_ns);

  static constexpr std::size_t max_frames = 8;  ///< bounds what is said
  const InputFrames& frames_;
  std::set<std::string> stated_;       ///< frames of the poses
  std::set<std::string> unconnected_;  ///< frames that count as the base
  std::uint64_t unstamped_ = 0;
};

}  // namespace sonopose::ros2::bag
