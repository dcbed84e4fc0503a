#include <sonopose/calibration/model/axes.hpp>
#include <sonopose/calibration/model/axes_check.hpp>
#include <sonopose/text/number_text.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace sonopose::calibration {
namespace {

/// The axis closest to the vertical: "+z", "-x".
std::string up_axis(const Vector3d& force_mps2) {
  Eigen::Index axis = 0;
  force_mps2.cwiseAbs().maxCoeff(&axis);
  constexpr std::string_view names = "xyz";
  return {force_mps2[axis] < 0 ? '-' : '+', names[static_cast<std::size_t>(axis)]};
}

}  // namespace

std::string nearest_axes(const Matrix3d& sensor_to_body, std::string_view up) {
  const auto choices = choices_of(Axes{});
  std::string_view best;
  double best_trace = -4;  // below the trace of any rotation
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (!choices.at(i).ends_with(up)) continue;
    AxesSettings candidate;
    candidate.axes = static_cast<Axes>(i);
    const double trace = (calibration::sensor_to_body(candidate).transpose() * sensor_to_body).trace();
    if (trace > best_trace) {
      best_trace = trace;
      best = choices.at(i);
    }
  }
  return std::string(best);
}

std::optional<AxesProblem> axes_problem(const Vector3d& force_body_mps2, std::string_view when,
                                        const AxesSettings& axes) {
  constexpr double max_tilt_rad = 0.25 * std::numbers::pi;  // a vehicle may stand on a ramp
  const double tilt_rad = std::acos(std::clamp(force_body_mps2.normalized().z(), -1.0, 1.0));
  if (tilt_rad <= max_tilt_rad) return std::nullopt;
  std::string text(when);
  text += ", specific force is along " + up_axis(force_body_mps2) + " of the body instead of +z (";
  for (const double component_mps2 : force_body_mps2) {
    text += (text.ends_with('(') ? "" : ", ") + text::number_text(component_mps2, 1);
  }
  text += " m/s²): the mount of the IMU differs from the fusion's settings";
  const std::string up = up_axis(sensor_to_body(axes).transpose() * force_body_mps2);
  return AxesProblem{std::move(text),
                     "mount it upright, or set calibration.axes=" + nearest_axes(sensor_to_body(axes), up) +
                         "; if the rotation about the vertical differs, choose another value that ends in " +
                         up + ", and set heading.mount_offset_deg"};
}

void AxesCheck::on(const ImuSample& raw) {
  const ImuSample imu = calibration_.corrected(raw);
  if (!imu.specific_force_body_mps2.allFinite()) return;
  if (count_++ == 0) first_ns_ = last_ns_ = raw.sensor_time_ns;
  first_ns_ = std::min(first_ns_, raw.sensor_time_ns);
  last_ns_ = std::max(last_ns_, raw.sensor_time_ns);
  sum_body_mps2_ += imu.specific_force_body_mps2;
}

std::optional<AxesProblem> AxesCheck::problem() const {
  constexpr double min_s = 5.0;                             // shorter accelerations may be as large
  constexpr double min_mps2 = 0.5 * standard_gravity_mps2;  // a body that tumbles has no mean
  constexpr double max_mps2 = 1.5 * standard_gravity_mps2;
  if (count_ == 0 || seconds_between(first_ns_, last_ns_) < min_s) return std::nullopt;
  const Vector3d mean_mps2 = sum_body_mps2_ / static_cast<double>(count_);
  if (mean_mps2.norm() < min_mps2 || mean_mps2.norm() > max_mps2) return std::nullopt;
  return axes_problem(mean_mps2, "on average", axes_);
}

}  // namespace sonopose::calibration
