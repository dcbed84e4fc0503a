#pragma once
/// \file
/// Layout of the panels of a plot, and the ranges of their axes.

#include "plots/plot.hpp"

#include <algorithm>
#include <limits>
#include <string>

namespace sonopose::plots {

inline constexpr double plot_width = 1600;
inline constexpr double plot_height = 1000;

/// Edges of a panel as fractions of the plot, from the lower left.
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

/// A rectangle of the map, m.
struct Box {
  Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Array2d high = -low;

  void include(const Vector3d& point) {
    if (!point.allFinite()) return;
    low = low.min(point.head<2>().array());
    high = high.max(point.head<2>().array());
  }

  /// Adds a margin, then extends it about its centre to the aspect ratio `width` : `height`.
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

/// 0: used, 1: used with a reduced weight (outlier), 2: rejected.
int class_of(std::uint32_t flags);

/// 1 if the status bit is set, else 0.
inline int bit(std::uint32_t status, PoseStatus wanted) {
  return (status & wanted) != 0 ? 1 : 0;
}

/// Ranges of both axes with equal scales, so that the path and the good fixes fill the panel.
Box path_box(const PlotData& data);

/// gnuplot commands for the axis of the position errors, and of the innovations.
std::string axis_of_errors(const PlotData& data);
std::string axis_of_innovations(const PlotData& data);

double top_of_speeds_mps(const PlotData& data);

}  // namespace sonopose::plots
