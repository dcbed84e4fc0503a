#pragma once
/// \file
/// Layout of the panels of a plot, and the ranges of their axes.

#include "plots/plot.hpp"

#include <algorithm>
#include <limits>
#include <string>

namespace sonopose::plots {

inline constexpr double plot_width = 1600;
inline constexpr double plot_height = 1500;

/// Edges of a panel as fractions of the plot, from the lower left.
struct Panel {
  double left;
  double right;
  double bottom;
  double top;

  [[nodiscard]] constexpr double width() const { return right - left; }
  [[nodiscard]] constexpr double height() const { return top - bottom; }
};

inline constexpr Panel path_panel{0.065, 0.47, 0.40, 0.925};
inline constexpr Panel along_histogram_panel{0.065, 0.25, 0.05, 0.32};
inline constexpr Panel left_histogram_panel{0.285, 0.47, 0.05, 0.32};

/// Returns panel `row` of `rows` in the right column, from the top. All share the time axis, below the last.
constexpr Panel time_panel(int row, int rows) {
  constexpr double top = 0.925;
  constexpr double bottom = 0.05;
  constexpr double gap = 0.03;  // room for the key above each panel
  const double pitch = (top - bottom + gap) / rows;
  return {0.565, 0.945, top - pitch * row - (pitch - gap), top - pitch * row};
}

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
    constexpr double min_m = 0.1;
    constexpr double margin = 1.08;
    if (!(high >= low).all()) low = high = Eigen::Array2d::Zero();
    const Eigen::Array2d centre = 0.5 * (low + high);
    const Eigen::Array2d span = (margin * (high - low)).max(min_m);
    const double m_per_pixel = std::max(span.x() / width, span.y() / height);
    const Eigen::Array2d half = 0.5 * m_per_pixel * Eigen::Array2d(width, height);
    low = centre - half;
    high = centre + half;
  }
};

/// Returns 1 if the status bit is set, else 0.
inline int bit(std::uint32_t status, PoseStatus wanted) {
  return (status & wanted) != 0 ? 1 : 0;
}

/// Returns ranges of both axes with equal scales, so that the paths and the good fixes fill the panel.
Box path_box(const PlotData& data);

/// Returns a round distance of tics of which at most five fit into `span`, which is above 0.
double tic_step(double span);

/// Return gnuplot commands for the vertical axes. Rare large values may be cut off.
std::string axis_of_errors(const PlotData& data);
std::string axis_of_innovations(const PlotData& data);
std::string axis_of_heights(const PlotData& data);
std::string axis_of_speeds(const PlotData& data);
std::string axis_of_delays(const PlotData& data);

}  // namespace sonopose::plots
