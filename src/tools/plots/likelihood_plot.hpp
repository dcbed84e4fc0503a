#pragma once
/// \file
/// Plots the likelihood along each quantity of a calibration from a drive.

#include "evaluation/calibration/drive_calibration.hpp"
#include "files/replacement.hpp"

#include <filesystem>

namespace sonopose::plots {

/// Draws a panel per wanted quantity with a curve: the likelihood, and the interval as a band. A dashed
/// parabola is the curve of a normal distribution with that interval. Uses gnuplot.
class LikelihoodPlot {
public:
  /// `file` has the extension .svg or .png. Throws PlotError (plot.hpp) for another extension or if gnuplot
  /// is not installed, and files::IoError if the file cannot be written.
  explicit LikelihoodPlot(std::filesystem::path file);

  /// Replaces the file. Throws PlotError if no quantity has a curve or gnuplot fails, and leaves the file
  /// unchanged.
  void draw(const evaluation::DriveCalibration& result);

private:
  std::filesystem::path file_;
  files::Replacement replacement_;
};

}  // namespace sonopose::plots
