#pragma once
/// \file
/// Plot of the Allan deviation.

#include "evaluation/allan.hpp"
#include "files/replacement.hpp"

#include <filesystem>

namespace sonopose::plots {

/// Draws the curves of both sensors with the noise density and the bias instability, using gnuplot.
class AllanPlot {
public:
  /// `file` has the extension .svg or .png. Throws PlotError (plot.hpp) for another extension and if gnuplot
  /// is not installed, files::IoError if the file cannot be written.
  explicit AllanPlot(std::filesystem::path file);

  /// Replaces the file. Throws PlotError if gnuplot fails; the file is then unchanged.
  void draw(const evaluation::AllanResult& result);

private:
  std::filesystem::path file_;
  files::Replacement replacement_;
};

}  // namespace sonopose::plots
