#pragma once
/// \file
/// Plot data of one run. Times are in seconds after the recording's first event, unknown values NaN.

#include "evaluation/score/baseline.hpp"
#include "evaluation/score/score.hpp"
#include "plots/thinned.hpp"
#include "recording/log_folder.hpp"
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::plots {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// A pose. Several consecutive ones: the latest values, but the largest errors and deviations, the lowest
/// trust and every status bit that was set.
struct Moment {
  double time_s = 0;
  Vector3d position_world_m = Vector3d::Zero();
  Eigen::Matrix3d position_covariance_m2 = Eigen::Matrix3d::Constant(unknown);
  double yaw_rad = 0;
  double yaw_std_rad = unknown;
  double speed_mps = 0;
  double trust = 1;
  std::uint32_t status = 0;
  Vector3d true_position_world_m = Vector3d::Constant(unknown);
  double true_yaw_rad = unknown;
  double true_speed_mps = unknown;
  double error_m = unknown;
  double last_fix_error_m = unknown;

  /// Returns false before the first fix, while the position is zero.
  [[nodiscard]] bool is_placed() const { return (status & status_initialising) == 0; }
};

/// A pose on the map, or the latest of several consecutive ones.
struct PathPoint {
  double time_s = 0;
  Vector3d position_world_m = Vector3d::Constant(unknown);
  Vector3d true_position_world_m = Vector3d::Constant(unknown);
};

/// A time without poses, since the IMU was silent.
struct Silence {
  double begin_s = 0;
  double end_s = 0;
};

/// A fix, or the most remarkable of several consecutive ones: rejected, then marked, then far from its
/// prediction.
struct FixMark {
  double time_s = 0;  ///< time of application
  Vector3d position_world_m = Vector3d::Zero();
  double innovation_m = 0;  ///< innovation; unknown if it was not computed
  double along_m = 0;       ///< innovation in the direction of motion, or unknown
  double left_m = 0;        ///< innovation to the left of the motion, or unknown
  double along_std_m = unknown;
  double left_std_m = unknown;
  double weight = 0;
  double speed_mps = unknown;  ///< speed from the previous used fix, if all are of one tag
  FixVerdict verdict = FixVerdict::used;
  std::uint32_t flags = 0;
  std::uint32_t seen_flags = 0;  ///< flags of all merged fixes
};

/// A histogram of the innovations of all used fixes except the first. The outermost bins count everything
/// beyond them.
struct Histogram {
  static constexpr int bins = 40;
  double half_width_m = 0;  ///< half of the range of all bins
  std::vector<std::size_t> along = std::vector<std::size_t>(bins);
  std::vector<std::size_t> left = std::vector<std::size_t>(bins);

  [[nodiscard]] double centre_m(int bin) const { return ((bin + 0.5) * 2.0 / bins - 1.0) * half_width_m; }
};

/// Limits of entries per run, whatever its duration.
struct Detail {
  std::size_t moments = 1024;
  std::size_t path_points = 3072;
  std::size_t fixes = 384;
};

/// Collects poses and reports, thinned so that the plot of an hour stays small.
class RunCurves {
public:
  /// `log` must outlive the curves. `name` distinguishes runs. `engine`: its name if it is not that of the
  /// settings.
  RunCurves(std::string name, const settings::Settings& settings, const std::string& engine,
            const recording::SensorLog& log, const Detail& detail = {});

  void add(const FusedPose& pose);
  void add(const FixReport& report);

  [[nodiscard]] const std::string& name() const { return name_; }
  /// The engine, and the settings that differ from their defaults.
  [[nodiscard]] const std::string& settings_text() const { return settings_text_; }
  [[nodiscard]] double mount_offset_rad() const { return mount_offset_rad_; }
  [[nodiscard]] const std::vector<Moment>& moments() const { return moments_.entries(); }
  [[nodiscard]] const std::vector<PathPoint>& path() const { return path_.entries(); }
  [[nodiscard]] const std::vector<FixMark>& fixes() const { return fixes_.entries(); }
  [[nodiscard]] const std::vector<Silence>& silences() const { return silences_; }
  [[nodiscard]] Histogram histogram() const;

private:
  [[nodiscard]] double speed_since_last_used(const FixReport& fix) const;

  std::string name_;
  std::string settings_text_;
  double mount_offset_rad_;
  bool has_several_tags_;
  TimeNs begin_ns_;
  evaluation::TruthTrack truth_;
  FusedPose before_{};  ///< the pose before
  evaluation::Baseline baseline_;
  std::optional<FixReport> last_used_;
  Vector3d direction_world_ = Vector3d::UnitX();  ///< direction of the latest horizontal motion
  std::vector<double> along_m_;                   ///< innovations of the used fixes
  std::vector<double> left_m_;
  Thinned<Moment> moments_;
  Thinned<PathPoint> path_;
  Thinned<FixMark> fixes_;
  std::vector<Silence> silences_;
};

}  // namespace sonopose::plots
