#include "installation/installation.hpp"

#include "motion/fit/changes.hpp"
#include <sonopose/calibration/model/axes.hpp>
#include <sonopose/calibration/model/axes_check.hpp>
#include <sonopose/estimation/aiding/admission.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/settings/settings_table.hpp>
#include <sonopose/text/number_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

namespace sonopose::installation {
namespace {

using motion::fit::are_few;
using motion::fit::explains;
using motion::fit::is_judged;
using motion::fit::max_residual_m;
using motion::fit::mean_of;
using motion::fit::Measured;
using motion::fit::min_log_likelihood_ratio;
using motion::fit::min_span_m;
using motion::fit::Piece;
using motion::fit::significant_stds;

constexpr double degrees = 1.0 / geometry::radians_per_degree;

/// Accuracy of a useful piece.
constexpr double useful_mount_std_rad = 15.0 * geometry::radians_per_degree;
constexpr double useful_delay_std_s = 0.020;
/// Largest response time of a beacon. A larger estimate comes from an IMU that does not fit the fixes, as on
/// a slipping wheel.
constexpr double credible_delay_s = 0.15;
/// Harmless errors of mount and delay. The fit itself errs by some degrees and milliseconds if lever arm,
/// gyroscope scale or slip are not as assumed.
constexpr double wrong_mount_rad = 15.0 * geometry::radians_per_degree;
constexpr double wrong_delay_s = 0.025;
constexpr double mount_error_rad = 2.0 * geometry::radians_per_degree;
constexpr double delay_error_s = 0.003;
constexpr double feet_per_m = 1 / 0.3048;
/// Largest share of fixes far from the motion. Beyond it the cause is a wrong track, not the installation.
constexpr double max_outliers = 0.2;
/// Three initial standard deviations of `kalman.delay.estimate`: the engine finds such a delay itself.
constexpr double estimated_delay_s = 0.06;

/// An angle in whole degrees, from -179 to 180.
double whole_degrees(double angle_rad) {
  const double angle_deg = std::round(geometry::wrap_angle(angle_rad) * degrees);
  return angle_deg > -180.0 ? angle_deg : 180.0;
}

bool is_usable(const Piece& piece) {
  return piece.residual_m < max_residual_m && piece.span_m > min_span_m &&
         are_few(piece.outliers_m.size(), piece, max_outliers);
}

bool has_known_mount(const Piece& piece) {
  return is_usable(piece) && piece.mount_rad && piece.mount_rad->std < useful_mount_std_rad;
}

bool has_known_delay(const Piece& piece) {
  return is_usable(piece) && piece.delay_s.std < useful_delay_std_s;
}

/// True if more than half of the pieces differ by more than `limit` on the mean's side.
bool majority_exceeds(const std::vector<Measured>& all, const Measured& mean, double limit) {
  const auto agrees = [&](const Measured& each) { return each.value * (mean.value > 0 ? 1 : -1) > limit; };
  return 2 * std::count_if(all.begin(), all.end(), agrees) > static_cast<std::ptrdiff_t>(all.size());
}

class InstallationCheck {
public:
  explicit InstallationCheck(const Evidence& evidence) : evidence_(evidence) {}

  /// Runs the checks. Other clocks, a wrong scale, mirrored fixes and a wrong sign make mount and delay wrong
  /// too, so they come first.
  void run() {
    if (clocks() || map_scale() || mirror() || report_sign(inverted_axes())) return;
    mount();
    delay();
  }

  /// Reports a wrong sign of axis Z alone.
  void sign_of_z() {
    const std::vector<std::size_t> axes = inverted_axes();
    if (axes == std::vector<std::size_t>{2}) report_sign(axes);
  }

  [[nodiscard]] std::vector<Finding> findings() && { return std::move(findings_); }

private:
  /// Reports stamps of fixes and IMU that are of different clocks. Returns false if they are of one, or if
  /// that is not known.
  bool clocks() {
    const auto offset = motion::fit::clock_offset_in(evidence_.pieces);
    if (!offset || !evidence_.settings.delay.extrapolate) return false;
    if (offset->value > 0 && can_set(age_setting(*offset))) {
      report_age(*offset, false, ": another delay, or another clock than that of the IMU");
    } else {
      report_age(*offset, true, ": the stamps of fixes and IMU are of different clocks");
    }
    return true;
  }

  /// Reports fixes of a left-handed map. Returns false if there are none, or if that is not known.
  bool mirror() {
    if (!has_gravity_upwards()) return false;  // an IMU upside down turns as a mirrored one
    const auto change = motion::fit::mirror_in(evidence_.pieces, configured_mount_rad());
    if (!change) return false;
    report_error(
        "its fixes are mirrored: they agree with the IMU only if an axis of the map is inverted",
        fmt::format(
            "{} at the source of the positions: the map of the beacons is left-handed, or their driver "
            "mixes the axes",
            motion::fit::text_of(*change)));
    return true;
  }

  void report_error(std::string text, std::string remedy) {
    findings_.push_back({.is_error = true, .text = std::move(text), .remedy = std::move(remedy)});
  }

  /// True if the mean force is up, as at rest. If it is down, an inverted accelerometer explains the fit as
  /// well as a gyroscope with the wrong sign does.
  [[nodiscard]] bool has_gravity_upwards() const {
    const Vector3d& force = evidence_.imu_summary.mean_force_body_mps2;
    return force.z() > force.head<2>().norm();
  }

  /// Returns false if no axis has the wrong sign.
  bool report_sign(std::vector<std::size_t> axes) {
    if (axes.empty()) return false;
    // In the horizontal plane, inverting X equals inverting Y with a mount that is off by 180°.
    const bool has_mount = std::any_of(
        evidence_.pieces.begin(), evidence_.pieces.end(),
        [&](const Piece& piece) { return piece.inverted.at(axes.front()).mount_rad.has_value(); });
    if (has_mount) {
      axes = {*std::min_element(axes.begin(), axes.end(), [&](std::size_t a, std::size_t b) {
        return mount_error_rad_with(a) < mount_error_rad_with(b);
      })};
    }
    const motion::TurnGain& turn = evidence_.turn_gain;
    if (turn.by_heading && motion::turn_fault_of(turn) == motion::TurnFault::wrong_sign &&
        has_gravity_upwards()) {
      report_error(
          "its gyroscope has the wrong sign about the body's axis z, or about all axes, or its headings are "
          "clockwise, as those of a compass: each turns against the other",
          "correct the sign in the driver of the IMU or of the headings; calibration.axes can only rotate");
      return true;
    }
    if (axes == std::vector<std::size_t>{2} && has_gravity_upwards()) {
      report_error(
          "its gyroscope has the wrong sign about the body's axis z, or about all axes: only then "
          "does the IMU agree with the fixes and headings",
          "correct the sign in the driver of the IMU; calibration.axes can only rotate");
      return true;
    }
    std::string names;
    for (const std::size_t axis : axes) {
      names += (names.empty() ? "on the body's axis " : " or ");
      names += "xyz"[axis];
    }
    // Inverting X and Y equals a mount that is off by 180°.
    const bool may_be_all = axes == std::vector<std::size_t>{2};
    if (may_be_all && !has_mount) names += ", or on all axes";
    if (may_be_all && has_mount && mount_error_rad_with(2) > 0.5 * std::numbers::pi) names = "on all axes";
    report_error(
        fmt::format("its accelerometer has the wrong sign {}: only then does the IMU agree with the fixes "
                    "and headings",
                    names),
        "correct the sign in the driver of the IMU (of all axes if it reports gravity instead of specific "
        "force), or replace the beacon; calibration.axes can only rotate");
    return true;
  }

  [[nodiscard]] double configured_mount_rad() const {
    return evidence_.settings.heading.mount_offset_deg * geometry::radians_per_degree;
  }

  /// The accelerometer axes whose other sign explains most pieces.
  [[nodiscard]] std::vector<std::size_t> inverted_axes() const {
    if (motion::turn_fault_of(evidence_.turn_gain) == motion::TurnFault::wrong_sign) return {2};
    std::array<double, 3> evidence{};
    std::array<std::size_t, 3> pieces{};
    std::size_t judged = 0;
    for (const Piece& piece : evidence_.pieces) {
      if (!is_judged(piece)) continue;
      ++judged;
      for (std::size_t axis = 0; axis < evidence.size(); ++axis) {
        if (!explains(piece.inverted.at(axis), piece)) continue;
        evidence.at(axis) += piece.inverted.at(axis).log_likelihood;
        ++pieces.at(axis);
      }
    }
    constexpr double min_evidence_share = 0.6;
    const double max_evidence = *std::max_element(evidence.begin(), evidence.end());
    std::vector<std::size_t> axes;
    for (std::size_t axis = 0; axis < evidence.size(); ++axis) {
      if (2 * pieces.at(axis) > judged && evidence.at(axis) > min_evidence_share * max_evidence)
        axes.push_back(axis);
    }
    return axes;
  }

  /// Deviation of the mount from the configured one if this axis is inverted; large without headings.
  [[nodiscard]] double mount_error_rad_with(std::size_t axis) const {
    double min_error_rad = 2.0 * std::numbers::pi;
    for (const Piece& piece : evidence_.pieces) {
      const auto& mount = piece.inverted.at(axis).mount_rad;
      if (mount)
        min_error_rad =
            std::min(min_error_rad, std::abs(geometry::wrap_angle(mount->value - configured_mount_rad())));
    }
    return min_error_rad;
  }

  /// Advice for a mount that is off by a multiple of 90°: the IMU may be what is turned. Otherwise empty.
  [[nodiscard]] std::string axes_advice(double error_rad) const {
    constexpr double right_angle_rad = 0.5 * std::numbers::pi;
    const double turn_rad = std::round(error_rad / right_angle_rad) * right_angle_rad;
    if (std::abs(error_rad - turn_rad) > 0.5 * wrong_mount_rad) return "";
    const Eigen::Matrix3d turned = geometry::rotation_about_z(-turn_rad).toRotationMatrix() *
                                   calibration::sensor_to_body(evidence_.settings.calibration.axes);
    return fmt::format(", or, if the IMU is turned in the beacon, calibration.axes={}",
                       calibration::nearest_axes(turned));
  }

  /// Reports a map of another scale, if gravity shows that the accelerometer does not measure another scale.
  bool map_scale() {
    constexpr double gravity_tolerance = 0.04;
    constexpr double feet_tolerance = 0.3;
    const auto scale = motion::fit::map_scale_in(evidence_.pieces);
    if (!scale) return false;
    // A turn adds to the horizontal force, and so to the median.
    const motion::ImuSummary& imu = evidence_.imu_summary;
    const double median = imu.median_force_mps2 / standard_gravity_mps2;
    const double mean_up = imu.mean_force_body_mps2.z() / standard_gravity_mps2;
    if (scale->value > 1 ? median < 1.0 - gravity_tolerance
                         : std::min(median, mean_up) > 1.0 + gravity_tolerance) {
      return false;
    }
    report_error(
        fmt::format("its fixes move {:.2f} (±{:.2f}) times as far as the IMU: the map has a wrong scale",
                    scale->value, scale->std),
        std::abs(scale->value - feet_per_m) < feet_tolerance
            ? "publish the positions in m: they seem to be in feet"
            : "measure a distance between two stationary beacons, and correct those of the map");
    return true;
  }

  void mount() {
    std::vector<Measured> errors;
    bool credible = true;
    std::ptrdiff_t wrong = 0;
    for (const Piece& piece : evidence_.pieces) {
      if (!has_known_mount(piece)) continue;
      credible = credible && std::abs(piece.delay_s.value) < credible_delay_s;
      errors.push_back(
          {geometry::wrap_angle(piece.mount_rad->value - configured_mount_rad()), piece.mount_rad->std});
      const bool is_far = std::abs(errors.back().value) > wrong_mount_rad;
      if (is_far && piece.mount_log_likelihood > min_log_likelihood_ratio) ++wrong;
    }
    if (errors.empty()) return;
    // Relative to the first one, since angles near ±180° have no mean.
    const double origin_rad = errors.front().value;
    std::vector<Measured> around = errors;
    for (Measured& error : around) error.value = geometry::wrap_angle(error.value - origin_rad);
    constexpr double poor_error_rad = 8.0 * geometry::radians_per_degree;
    Measured error = mean_of(around, credible ? mount_error_rad : poor_error_rad);
    error.value = geometry::wrap_angle(error.value + origin_rad);
    if (2 * wrong <= static_cast<std::ptrdiff_t>(errors.size())) return;
    if (std::abs(error.value) < std::max(wrong_mount_rad, significant_stds * error.std)) return;
    if (evidence_.are_headings_of_body) {
      report_error(
          fmt::format(
              "its headings are {:.0f}° (±{:.0f}°) too {}: the IMU, the fixes and the headings do not "
              "agree",
              std::abs(whole_degrees(error.value)), error.std * degrees, error.value > 0 ? "large" : "small"),
          "let their driver give the yaw counter-clockwise from the map's x, not from north or from the "
          "start, "
          "or correct the place of the IMU (--mount, /tf_static)");
      return;
    }
    report_error(
        fmt::format(
            "its mount offset is wrong by about {:.0f}° (±{:.0f}°): the IMU, the fixes and the heading "
            "of the pair do not agree",
            whole_degrees(error.value), error.std * degrees),
        fmt::format("try heading.mount_offset_deg={}{}; sonopose-calibrate mount finds it exactly "
                    "(docs/calibration.md)",
                    text::number_text(whole_degrees(configured_mount_rad() + error.value), 0),
                    axes_advice(error.value)));
  }

  void delay() {
    std::vector<Measured> errors;
    for (const Piece& piece : evidence_.pieces) {
      if (has_known_delay(piece)) errors.push_back(piece.delay_s);
    }
    const settings::DelaySettings& settings = evidence_.settings.delay;
    if (errors.empty() || !settings.extrapolate) return;
    const Measured error = mean_of(errors, delay_error_s);
    const bool is_estimated = settings.estimate && std::abs(error.value) < estimated_delay_s;
    if (is_estimated || std::abs(error.value) > credible_delay_s) return;
    if (std::abs(error.value) < std::max(wrong_delay_s, significant_stds * error.std)) return;
    if (!majority_exceeds(errors, error, 0.5 * wrong_delay_s)) return;
    report_age(error, false, "");
  }

  /// Setting that corrects the age of the fixes, and the value that does. Below `min_s` the fusion would
  /// refuse fixes as from the future.
  struct AgeSetting {
    std::string key;
    double value_s = 0;
    double min_s = 0;
    double max_s = 0;
  };

  [[nodiscard]] AgeSetting age_setting(const Measured& error) const {
    const settings::DelaySettings& settings = evidence_.settings.delay;
    const bool own = settings.source == settings::DelaySource::measured && evidence_.are_fixes_timed;
    const std::string key = own ? "delay.correction_s" : "delay.processing_s";
    const settings::SettingInfo& limits = settings::setting_info(key);
    const double min_s =
        -estimation::aiding::admission::future_tolerance_s - (own ? evidence_.min_fix_delay_s : 0.0);
    return {key, (own ? settings.correction_s : settings.processing_s) + error.value,
            std::max(std::get<double>(limits.minimum), min_s), std::get<double>(limits.maximum)};
  }

  static bool can_set(const AgeSetting& setting) {
    return setting.value_s >= setting.min_s && setting.value_s <= setting.max_s;
  }

  /// Reports the age of the fixes beyond what the fusion assumes, with the setting that corrects it.
  void report_age(const Measured& error, bool is_error, std::string_view cause) {
    const AgeSetting setting = age_setting(error);
    findings_.push_back(
        {.is_error = is_error,
         .text = fmt::format("its fixes are about {:.0f} ms (±{:.0f} ms) {} than the fusion assumes{}",
                             std::abs(error.value) * 1e3, error.std * 1e3,
                             error.value > 0 ? "older" : "younger", cause),
         .remedy =
             can_set(setting)
                 ? fmt::format("try {}={}; sonopose-calibrate delay finds it exactly (docs/calibration.md)",
                               setting.key, text::number_text(setting.value_s, 3))
                 : fmt::format(
                       "synchronise the clocks that stamp the fixes and the IMU samples, or add {} s to "
                       "the stamps "
                       "of the fixes in their driver; {} allows only {} to {} s",
                       text::number_text(-error.value, 3), setting.key, text::number_text(setting.min_s, 2),
                       text::number_text(setting.max_s, 2))});
  }

  const Evidence& evidence_;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> findings_of(const Evidence& evidence) {
  InstallationCheck check(evidence);
  check.run();
  return std::move(check).findings();
}

bool is_explained(const Piece& piece) {
  return !is_judged(piece) ||
         (piece.residual_m < max_residual_m && piece.mount_log_likelihood < min_log_likelihood_ratio &&
          std::abs(piece.delay_s.value) < wrong_delay_s &&
          std::abs(piece.map_scale.value - 1.0) <= significant_stds * piece.map_scale.std);
}

std::vector<Finding> wrong_sign_of_z(const Evidence& evidence) {
  InstallationCheck check(evidence);
  check.sign_of_z();
  return std::move(check).findings();
}

}  // namespace sonopose::installation
