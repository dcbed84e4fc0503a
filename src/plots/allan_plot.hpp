#pragma once
/// \file
/// The Allan deviation as a plot.

#include "evaluation/allan.hpp"
#include "files/replacement.hpp"

#include <filesystem>

namespace sonopose::plots {

/// The curves of both sensors with the line of the noise density and the floor. Drawn by gnuplot.
class AllanPlot {
public:
  /// `file` ends in .svg or .png. Throws PictureError (picture.hpp) for another ending and where gnuplot is
  /// not installed, files::IoError where the file cannot be written.
  explicit AllanPlot(std::filesystem::path file);

  /// Replaces the file. Throws PictureError where gnuplot fails; the file then stays as it was.
  void draw(const evaluation::AllanResult& result);

private:
  std::filesystem::path file_;
  files::Replacement replacement_;
};

}  // namespace sonopose::plots
