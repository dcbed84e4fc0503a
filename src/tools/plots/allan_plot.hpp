#pragma once
/// \file
/// Plots the Allan deviation.

#include "evaluation/calibration/allan.hpp"
#include "files/replacement.hpp"

#include <filesystem>

namespace sonopose::plots {

/// Draws the curves of both sensors with the noise density and the bias instability, using gnuplot.
class AllanPlot {
public:
  /// `file` has the extension .svg or .png. Throws PlotError (plot.hpp) for another extension or if gnuplot
  /// is not installed, and files::IoError if the file cannot be written.
  explicit AllanPlot(std::filesystem::path file);

  /// Replaces the file. Throws PlotError if gnuplot fails, and leaves the file unchanged.
  void draw(const evaluation::AllanResult& result);

private:
  std::filesystem::path file_;
  files::Replacement replacement_;
};

}  // namespace sonopose::plots
