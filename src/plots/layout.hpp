#pragma once
/// \file
/// Where the panels of a picture stand, and which part of the map it shows. Private to this room.

#include "plots/picture.hpp"

#include <algorithm>
#include <limits>
#include <string>

namespace sonopose::plots {

inline constexpr double picture_width = 1600;
inline constexpr double picture_height = 1000;

/// A panel's edges as shares of the picture, from the lower left.
struct Panel {
  double left;
  double right;
  double bottom;
  double top;

  [[nodiscard]] constexpr double width() const { return right - left; }
  [[nodiscard]] constexpr double height() const { return top - bottom; }
};

inline constexpr Panel path_panel{0.065, 0.47, 0.075, 0.9};
inline constexpr Panel error_panel{0.58, 0.985, 0.69, 0.9};
inline constexpr Panel speed_panel{0.58, 0.985, 0.425, 0.635};
inline constexpr Panel fix_flag_panel{0.58, 0.985, 0.075, 0.37};

/// What a part of the map spans.
struct Box {
  Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Array2d high = -low;

  void include(const Vector3d& point) {
    if (!point.allFinite()) return;
    low = low.min(point.head<2>().array());
    high = high.max(point.head<2>().array());
  }

  /// Widens it, by a margin and then to the shape `width` by `height`, about its centre.
  void fit(double width, double height) {
    constexpr double least_m = 0.1;
    constexpr double margin = 1.08;
    if (!(high >= low).all()) low = high = Eigen::Array2d::Zero();
    const Eigen::Array2d centre = 0.5 * (low + high);
    const Eigen::Array2d span = (margin * (high - low)).max(least_m);
    const double m_per_pixel = std::max(span.x() / width, span.y() / height);
    const Eigen::Array2d half = 0.5 * m_per_pixel * Eigen::Array2d(width, height);
    low = centre - half;
    high = centre + half;
  }
};

/// 0: used, 1: used with less weight as an outlier, 2: rejected.
int class_of(std::uint32_t flags);

/// 1 where the status is set, else 0.
inline int bit(std::uint32_t status, PoseStatus wanted) {
  return (status & wanted) != 0 ? 1 : 0;
}

/// Both axes' ranges, so that the path and the good fixes fill the panel and a metre is as long on both.
Box path_box(const PictureData& data);

/// Commands for the axis of the position errors, and of the fixes' innovations.
std::string axis_of_errors(const PictureData& data);
std::string axis_of_residuals(const PictureData& data);

double top_of_speeds_mps(const PictureData& data);

}  // namespace sonopose::plots
