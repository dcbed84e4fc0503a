#pragma once
/// \file
/// Plot of one run, or of two that are compared: the path with its fixes, over time errors, innovations,
/// height, yaw and speed, and how each fix was used. Drawn by gnuplot.

#include "files/replacement.hpp"
#include "plots/arrivals.hpp"
#include "plots/curves.hpp"
#include "recording/log_folder.hpp"
#include <sonopose/settings/settings.hpp>

#include <deque>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace sonopose::plots {

/// A plot that cannot be drawn; the message states the reason.
class PlotError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// What a plot shows.
struct PlotData {
  std::string title;
  bool has_truth = false;
  Arrivals arrivals;
  std::deque<RunCurves> runs;  ///< one or two
};

class Plot {
public:
  /// `file` has the extension .svg or .png. Throws PlotError for another extension and if gnuplot is not
  /// installed, files::IoError if the file cannot be written. `log` must outlive the plot.
  Plot(std::filesystem::path file, std::string title, const recording::SensorLog& log);

  /// Begins a run, which is filled through the reference that is returned. `engine` is its name if it is not
  /// that of the settings.
  RunCurves& add_run(std::string name, const settings::Settings& settings, const std::string& engine = {});

  [[nodiscard]] const PlotData& data() const { return data_; }

  /// Replaces the file. Throws PlotError if gnuplot fails; the file is then unchanged. Needs one or two runs.
  void draw();

private:
  std::filesystem::path file_;
  files::Replacement replacement_;
  const recording::SensorLog& log_;
  PlotData data_;
};

/// gnuplot commands, including the data, that draw `data` to `file`. `ending` is .svg or .png and selects the
/// format.
std::string gnuplot_script(const PlotData& data, const std::filesystem::path& file,
                           const std::filesystem::path& ending);

}  // namespace sonopose::plots
