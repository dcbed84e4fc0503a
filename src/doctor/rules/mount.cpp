#include "doctor/rules/rules.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace sonopose::doctor::doctor {
namespace {

// At rest: spreads above those of a noisy sensor and below those of a vehicle that moves.
constexpr double rest_force_std_mps2 = 0.25;
constexpr double rest_rate_std_radps = 0.03;
constexpr double rest_fixes_span_m = 0.25;

/// An uncalibrated MEMS accelerometer is off by a few per cent.
constexpr double gravity_tolerance = 0.05;
/// 3 deg/s; the start-up calibration takes off less and more, but a good gyroscope is below.
constexpr double large_rate_offset_radps = 3.0 * geometry::radians_per_degree;
/// A vehicle may stand on a ramp.
constexpr double wrong_axis_deg = 45.0;
constexpr double notable_tilt_deg = 15.0;

bool at_rest(const RestObservation& rest) {
  return rest.force_std_mps2 < rest_force_std_mps2 && rest.rate_std_radps < rest_rate_std_radps &&
         rest.fixes_span_m < rest_fixes_span_m;
}

/// The axis that points up most: "+z", "-x".
std::string up_axis(const Vector3d& force) {
  Eigen::Index axis = 0;
  force.cwiseAbs().maxCoeff(&axis);
  constexpr std::string_view names = "xyz";
  return {force[axis] < 0 ? '-' : '+', names[static_cast<std::size_t>(axis)]};
}

/// The value of calibration.axes that puts the sensor's axis `up` on body Z and turns the rest the least.
std::string axes_with(const std::string& up, const calibration::AxesSettings& now) {
  const auto choices = calibration::choices_of(calibration::Axes{});
  std::string_view best;
  double most = -4;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (!choices.at(i).ends_with(up)) continue;
    calibration::AxesSettings candidate;
    candidate.axes = static_cast<calibration::Axes>(i);
    const double alike =
        (calibration::sensor_to_body(candidate).transpose() * calibration::sensor_to_body(now)).trace();
    if (alike > most) {
      most = alike;
      best = choices.at(i);
    }
  }
  return std::string(best);
}

void check_direction(const BeaconObservation& beacon, const RestObservation& rest, Findings& findings) {
  const Vector3d& force = rest.mean_force_body_mps2;
  const double tilt_deg = std::acos(std::clamp(force.normalized().z(), -1.0, 1.0)) / geometry::radians_per_degree;
  if (tilt_deg > wrong_axis_deg) {
    const Vector3d force_sensor = calibration::sensor_to_body(rest.axes).transpose() * force;
    findings.push_back(
        {Severity::warning, name_of(beacon),
         fmt::format(
             "at rest gravity's reaction is on {} of the body and not on +z ({:.1f}, {:.1f}, {:.1f} m/s²): "
             "the IMU is not mounted as the fusion believes",
             up_axis(force), force.x(), force.y(), force.z()),
         fmt::format(
             "mount it upright, or tell the fusion: calibration.axes={}; the direction about the vertical "
             "is up to you: another choice that ends in {}, and heading.mount_offset_deg",
             axes_with(up_axis(force_sensor), rest.axes), up_axis(force_sensor))});
  } else if (tilt_deg > notable_tilt_deg) {
    findings.push_back(
        {Severity::note, name_of(beacon),
         fmt::format("it leans by {:.0f}° at rest; the fusion levels it, and its pose tells the IMU's "
                     "tilt, not the vehicle's",
                     tilt_deg),
         "mount the IMU level where that matters"});
  }
}

}  // namespace

void check_mount(const BeaconObservation& beacon, Findings& findings) {
  if (!beacon.imu_means || !at_rest(*beacon.imu_means)) return;
  const RestObservation& rest = *beacon.imu_means;
  const double force_mps2 = rest.mean_force_body_mps2.norm();
  if (!(force_mps2 > 0.5 * standard_gravity_mps2)) {
    findings.push_back(
        {Severity::error, name_of(beacon),
         fmt::format("at rest its accelerometer tells {:.2f} m/s²: it does not measure gravity", force_mps2),
         "look at what the beacon streams (raw, not compensated), or replace it"});
    return;
  }
  check_direction(beacon, rest, findings);
  if (std::abs(force_mps2 / standard_gravity_mps2 - 1.0) > gravity_tolerance) {
    findings.push_back({Severity::warning, name_of(beacon),
                        fmt::format("at rest its accelerometer tells {:.2f} m/s² instead of {:.2f}",
                                    force_mps2, standard_gravity_mps2),
                        "calibrate it: sonopose-calibrate imu (docs/calibration.md)"});
  }
  const double rate_radps = rest.mean_rate_body_radps.norm();
  if (rate_radps > large_rate_offset_radps) {
    findings.push_back(
        {Severity::warning, name_of(beacon),
         fmt::format("its gyroscope tells {:.1f} deg/s at rest", rate_radps / geometry::radians_per_degree),
         "if it does not turn steadily, calibrate it: sonopose-calibrate gyroscope (docs/calibration.md)"});
  }
}

}  // namespace sonopose::doctor::doctor
