#include "doctor/rules/checks.hpp"
#include <sonopose/calibration/model/axes_check.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

namespace sonopose::doctor::rules {
namespace {

/// Limit above the error of a typical uncalibrated MEMS accelerometer (a few per cent).
constexpr double gravity_tolerance = 0.05;
/// Limit of a good gyroscope. The initial calibration removes any bias.
constexpr double large_rate_offset_radps = 3.0 * geometry::radians_per_degree;
constexpr double notable_tilt_deg = 15.0;

/// Checks the mean specific force. `when`: "at rest" or "on average". Returns false if an axis is wrong.
bool check_direction(const BeaconObservation& beacon, std::string_view when, const Vector3d& force,
                     const calibration::AxesSettings& axes, Findings& findings) {
  const double tilt_deg =
      std::acos(std::clamp(force.normalized().z(), -1.0, 1.0)) / geometry::radians_per_degree;
  if (auto problem = calibration::axes_problem(force, when, axes)) {
    // A wrong sign of Z alone also turns the force upside down.
    constexpr double upside_down_deg = 135.0;
    if (tilt_deg > upside_down_deg) {
      auto faults = installation::wrong_sign_of_z(evidence_of(beacon));
      const bool is_explained = !faults.empty();
      add_faults(beacon, std::move(faults), findings);
      if (is_explained) return false;
    }
    findings.push_back(
        {Severity::warning, name_of(beacon), std::move(problem->text), std::move(problem->remedy)});
    return false;
  }
  if (tilt_deg > notable_tilt_deg) {
    findings.push_back(
        {Severity::note, name_of(beacon),
         fmt::format("it is tilted by {:.0f}° {}; the fused attitude is that of the IMU, not of the vehicle",
                     tilt_deg, when),
         "mount the IMU level if the attitude of the vehicle matters"});
  }
  return true;
}

/// The settings that scale all axes of a sensor.
std::string scaled_by(std::string_view sensor, double factor, std::string_view to_or_by) {
  return fmt::format("calibration.{}.sensitivity_x, sensitivity_y and sensitivity_z {} {:.4g}", sensor,
                     to_or_by, factor);
}

/// Reports units that contradict the readings. Returns false if it did.
bool check_units(const BeaconObservation& beacon, Findings& findings) {
  const std::size_t before = findings.size();
  const motion::ImuSummary& imu = beacon.imu_summary;
  const auto report_force = [&](std::string_view text, std::string remedy) {
    findings.push_back({Severity::error, name_of(beacon),
                        fmt::format("its accelerometer usually reads {:.3g} m/s² instead of about 9.81: {}",
                                    imu.median_force_mps2, text),
                        std::move(remedy)});
  };
  switch (motion::force_unit_of(imu)) {
    case motion::ForceUnit::mps2:
      break;
    case motion::ForceUnit::g:
      report_force("it seems to be in g",
                   "publish m/s², or set " + scaled_by("accelerometer", standard_gravity_mps2, "to"));
      break;
    case motion::ForceUnit::mg:
      report_force("it seems to be in mg or cm/s²", "publish m/s²");
      break;
    case motion::ForceUnit::no_gravity:
      report_force("it does not measure gravity",
                   "check that the beacon streams raw data (gravity not removed), or replace it");
      break;
    case motion::ForceUnit::unknown:
      report_force("its unit is unknown", "publish m/s²");
      break;
  }
  if (motion::has_rates_in_degrees(imu) ||
      motion::turn_fault_of(beacon.turn_gain) == motion::TurnFault::degrees) {
    const bool is_thousandth = motion::has_rates_in_millidegrees(imu);
    std::string remedy = "publish rad/s";
    if (!is_thousandth) remedy += ", or set " + scaled_by("gyroscope", geometry::radians_per_degree, "to");
    findings.push_back({Severity::error, name_of(beacon),
                        fmt::format("its gyroscope exceeds {:.3g} rad/s in every twentieth sample, which is "
                                    "too fast or contradicts gravity or headings: it seems to be in {}",
                                    imu.fast_rate_radps, is_thousandth ? "mdeg/s" : "deg/s"),
                        std::move(remedy)});
  }
  return findings.size() == before;
}

/// Reports sensors and axes that do not measure. Returns false if it did.
bool check_axes(const BeaconObservation& beacon, Findings& findings) {
  const std::string remedy = "check the driver of the IMU, or replace the beacon";
  const std::size_t before = findings.size();
  for (const std::string& text : beacon.imu_faults) {
    findings.push_back({Severity::error, name_of(beacon), text, remedy});
  }
  if (findings.size() > before) return false;
  const double gain = beacon.turn_gain.gain;
  const auto report_turns = [&](Severity severity, std::string_view text, std::string advice) {
    findings.push_back(
        {severity, name_of(beacon),
         fmt::format("its gyroscope measures {:.2f} of the turns of its headings: {}", gain, text),
         std::move(advice)});
  };
  switch (motion::turn_fault_of(beacon.turn_gain)) {
    case motion::TurnFault::dead:
      report_turns(Severity::error, "the vertical axis is dead", remedy);
      break;
    case motion::TurnFault::scale:
      report_turns(
          Severity::warning, "its scale is wrong, or its range too small",
          fmt::format("increase the range, or multiply {}", scaled_by("gyroscope", 1.0 / gain, "by")));
      break;
    case motion::TurnFault::none:
    case motion::TurnFault::wrong_sign:  // check_installation reports it
    case motion::TurnFault::degrees:     // check_units reports it
      break;
  }
  return findings.size() == before;
}

}  // namespace

bool check_imu(const BeaconObservation& beacon, Findings& findings) {
  if (!check_axes(beacon, findings)) return false;
  if (beacon.imu_summary.duration_s > 0 && !check_units(beacon, findings)) return false;
  if (!beacon.rest) {
    // Over this time the mean acceleration is small against gravity.
    constexpr double min_s = 5.0;
    if (beacon.imu_summary.duration_s < min_s) return true;
    return check_direction(beacon, "on average", beacon.imu_summary.mean_force_body_mps2,
                           beacon.fusion_settings.calibration.axes, findings);
  }
  const RestObservation& rest = *beacon.rest;
  const double force_mps2 = rest.mean_force_body_mps2.norm();
  if (!(force_mps2 > 0.5 * standard_gravity_mps2)) {
    findings.push_back(
        {Severity::error, name_of(beacon),
         fmt::format("at rest, its accelerometer reads {:.2f} m/s²: it does not measure gravity", force_mps2),
         "check that the beacon streams raw data (gravity not removed), or replace it"});
    return false;
  }
  const bool is_right = check_direction(beacon, "at rest", rest.mean_force_body_mps2, rest.axes, findings);
  if (std::abs(force_mps2 / standard_gravity_mps2 - 1.0) > gravity_tolerance) {
    findings.push_back({Severity::warning, name_of(beacon),
                        fmt::format("at rest, its accelerometer reads {:.2f} m/s² instead of {:.2f}",
                                    force_mps2, standard_gravity_mps2),
                        "calibrate it: sonopose-calibrate imu (docs/calibration.md)"});
  }
  const double rate_radps = rest.mean_rate_body_radps.norm();
  if (rate_radps > large_rate_offset_radps) {
    findings.push_back(
        {Severity::warning, name_of(beacon),
         fmt::format("at rest, its gyroscope reads {:.1f} deg/s", rate_radps / geometry::radians_per_degree),
         "unless it rotates at a constant rate, calibrate it: sonopose-calibrate gyroscope "
         "(docs/calibration.md)"});
  }
  return is_right;
}

}  // namespace sonopose::doctor::rules
