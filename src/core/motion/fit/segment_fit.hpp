#pragma once
/// \file
/// The motion that explains the samples of a few seconds, without the fusion: a robust fit of position,
/// velocity, attitude, biases, lever arm, delay and mount. Private to this folder.

#include "motion/window.hpp"

#include <optional>
#include <span>
#include <vector>

namespace sonopose::motion::fit::detail {

struct Segment {
  std::span<const Reading> imu;
  std::span<const Position> fixes;
  std::span<const Direction> headings;
};

struct SegmentFit {
  double cost = 0;        ///< −log of the probability, up to a constant
  double residual_m = 0;  ///< standard deviation of the fixes about the motion per axis, without outliers
  double delay_s = 0;     ///< age of fixes and headings beyond their times
  double delay_std_s = 0;
  double mount_rad = 0;  ///< from body X to the axis of the pair
  double mount_std_rad = 0;
  double map_scale = 1;  ///< distances by the fixes over those by the IMU, if it is free
  double map_scale_std = 0;
  double heading_spread_rad = 0;       ///< standard deviation of the headings about the motion
  bool upright = false;                ///< true if body Z points up
  std::vector<Vector3d> deviations_m;  ///< deviation of each fix from the motion
};

/// Unknowns beyond motion, biases and mount.
struct Freedom {
  double delay_std_s = 0.1;  ///< standard deviation of the delay before any measurement
  bool is_map_scaled = false;
};

/// Best motion, from starts in all directions. `signs`: factors of the axes of the specific force. Empty if
/// no start gives a finite result.
std::optional<SegmentFit> fit_segment(const Segment& segment, const Vector3d& signs,
                                      const Freedom& freedom = {});

/// Best motion with a known mount, which gives the direction of the start. Requires headings.
std::optional<SegmentFit> fit_segment_with_mount(const Segment& segment, double mount_rad);

}  // namespace sonopose::motion::fit::detail
