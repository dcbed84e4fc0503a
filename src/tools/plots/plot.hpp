#pragma once
/// \file
/// Plots one run, or two for comparison, by gnuplot: the path with its fixes, and over time the errors,
/// innovations, height, yaw, speed, and how each fix was used.

#include "files/replacement.hpp"
#include "plots/arrivals.hpp"
#include "plots/run_curves.hpp"
#include "recording/log_folder.hpp"
#include <sonopose/settings/settings.hpp>

#include <deque>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace sonopose::plots {

/// The error for a plot that cannot be drawn. The message states the reason.
class PlotError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

struct PlotData {
  std::string title;
  bool has_truth = false;
  Arrivals arrivals;
  std::deque<RunCurves> runs;  ///< one or two
};

class Plot {
public:
  /// `file` has the extension .svg or .png. `log` must outlive the plot. Throws PlotError for another
  /// extension or if gnuplot is not installed, and files::IoError if the file cannot be written.
  Plot(std::filesystem::path file, std::string title, const recording::SensorLog& log);

  /// Begins a run, which the returned reference fills. `engine`: its name if it is not that of the settings.
  RunCurves& add_run(std::string name, const settings::Settings& settings, const std::string& engine = {});

  [[nodiscard]] const PlotData& data() const { return data_; }

  /// Replaces the file. Needs one or two runs. Throws PlotError if gnuplot fails, and leaves the file
  /// unchanged.
  void draw();

private:
  std::filesystem::path file_;
  files::Replacement replacement_;
  const recording::SensorLog& log_;
  PlotData data_;
};

/// Returns gnuplot commands, including the data, that draw `data` to `file`. `ending` is .svg or .png and
/// selects the format.
std::string gnuplot_script(const PlotData& data, const std::filesystem::path& file,
                           const std::filesystem::path& ending);

}  // namespace sonopose::plots
