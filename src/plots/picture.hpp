#pragma once
/// \file
/// A run as a picture to tune by: the path with its fixes, and over time the error (or the fixes' innovations),
/// the speed, and what was made of each fix. Drawn by gnuplot.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include "recording/log_folder.hpp"
#include "files/replacement.hpp"
#include "evaluation/baseline.hpp"
#include "evaluation/score.hpp"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace sonopose::plots {

/// A picture that cannot be drawn; the message says what is missing.
class PictureError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// What is drawn; NaN where not known, times in seconds after the recording's first event.
struct PictureData {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

  /// One or several poses in a row: the latest of each value, but the greatest of the errors, the least trust
  /// and every status that was set.
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
    double time_s = 0;  ///< when it was applied
    Vector3d position_world_m = Vector3d::Zero();
    double innovation_m = 0;
    double weight = 0;
    double speed_mps = unknown;  ///< from the used fix before
    std::uint32_t flags = 0;
  };

  std::string title;
  bool has_truth = false;
  std::vector<Moment> moments;
  std::vector<Fix> fixes;
};

/// Collects a run's poses and reports, in a bounded number of moments, and draws them.
class Picture {
public:
  static constexpr std::size_t most_moments = 16384;

  /// `file` ends in .svg or .png. Throws PictureError for another ending and where gnuplot
  /// is not installed, files::IoError where the file cannot be written. `log` must outlive the picture.
  Picture(std::filesystem::path file, std::string title, const recording::SensorLog& log);

  void add(const FusedPose& pose);
  void add(const FixReport& report);

  [[nodiscard]] const PictureData& data() const { return data_; }

  /// Replaces the file. Throws PictureError where gnuplot fails; the file then stays as it was.
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
  PictureData data_;
  std::size_t poses_per_moment_ = 1;
  std::size_t poses_in_last_ = 0;
};

/// The commands that draw `data` into `file`, data included. `ending` is .svg or .png and says how.
std::string gnuplot_script(const PictureData& data, const std::filesystem::path& file,
                           const std::filesystem::path& ending);

}  // namespace sonopose::plots
