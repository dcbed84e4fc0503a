#pragma once
/// \file
/// The direction of gravity in the body, which shows whether the sensor is mounted as the settings say.

#include <sonopose/calibration/model/calibration.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sonopose::calibration {

/// A mount that the direction of gravity contradicts.
struct AxesProblem {
  std::string text;    ///< where the specific force is
  std::string remedy;  ///< the setting to try
};

/// The value of calibration.axes closest to a rotation, of those that map the sensor's axis `up` ("-x") to
/// body Z.
std::string nearest_axes(const Matrix3d& sensor_to_body, std::string_view up = "");

/// Set if this specific force in body axes is more than 45° from +z. `when`: "at rest", "on average".
std::optional<AxesProblem> axes_problem(const Vector3d& force_body_mps2, std::string_view when,
                                        const AxesSettings& axes);

/// Mean specific force of a recording.
class AxesCheck {
public:
  explicit AxesCheck(const Settings& settings) : axes_(settings.axes), calibration_(settings) {}

  /// Adds a sample, uncorrected.
  void on(const ImuSample& raw);

  /// Empty without gravity, as in another unit, and while the accelerations of a short time may hide it.
  [[nodiscard]] std::optional<AxesProblem> problem() const;

private:
  AxesSettings axes_;
  Calibration calibration_;
  TimeNs first_ns_ = 0;
  TimeNs last_ns_ = 0;
  std::uint64_t count_ = 0;
  Vector3d sum_body_mps2_ = Vector3d::Zero();
};

}  // namespace sonopose::calibration
