#pragma once
/// \file
/// Plot of a run for tuning: the path with its fixes, and over time the error (or the innovations of the
/// fixes), the speed, and how each fix was used. Drawn by gnuplot.

#include "evaluation/baseline.hpp"
#include "evaluation/score.hpp"
#include "files/replacement.hpp"
#include "recording/log_folder.hpp"
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace sonopose::plots {

/// A plot that cannot be drawn; the message states the reason.
class PlotError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// Data of a plot; NaN for unknown values, times in seconds after the recording's first event.
struct PlotData {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

  /// One pose, or several consecutive ones: the latest values, but the largest errors, the lowest trust and
  /// every status bit that was set.
  struct Moment {
    double time_s = 0;
    Vector3d position_world_m = Vector3d::Zero();
    Vector3d true_position_world_m = Vector3d::Constant(unknown);
    double speed_mps = 0;
    double true_speed_mps = unknown;
    double error_m = unknown;
    double last_fix_error_m = unknown;
    double trust = 1;
    std::uint32_t status = 0;
  };

  struct Fix {
    double time_s = 0;  ///< time at which it was applied
    Vector3d position_world_m = Vector3d::Zero();
    double innovation_m = 0;
    double weight = 0;
    double speed_mps = unknown;  ///< from the previous used fix
    std::uint32_t flags = 0;
  };

  std::string title;
  bool has_truth = false;
  std::vector<Moment> moments;
  std::vector<Fix> fixes;
};

/// Collects the poses and reports of a run in a bounded number of moments, and draws them.
class Plot {
public:
  static constexpr std::size_t most_moments = 16384;

  /// `file` has the extension .svg or .png. Throws PlotError for another extension and if gnuplot is not
  /// installed, files::IoError if the file cannot be written. `log` must outlive the plot.
  Plot(std::filesystem::path file, std::string title, const recording::SensorLog& log);

  void add(const FusedPose& pose);
  void add(const FixReport& report);

  [[nodiscard]] const PlotData& data() const { return data_; }

  /// Replaces the file. Throws PlotError if gnuplot fails; the file is then unchanged.
  void draw();

private:
  void halve();
  [[nodiscard]] double speed_since_last_used(const FixReport& fix) const;

  std::filesystem::path file_;
  files::Replacement replacement_;
  TimeNs begin_ns_;
  evaluation::TruthTrack truth_;
  evaluation::Baseline baseline_;
  std::optional<FixReport> last_used_;
  PlotData data_;
  std::size_t poses_per_moment_ = 1;
  std::size_t poses_in_last_ = 0;
};

/// gnuplot commands, including the data, that draw `data` to `file`. `ending` is .svg or .png and selects the
/// format.
std::string gnuplot_script(const PlotData& data, const std::filesystem::path& file,
                           const std::filesystem::path& ending);

}  // namespace sonopose::plots
