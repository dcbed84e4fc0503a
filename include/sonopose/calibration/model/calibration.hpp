#pragma once
/// \file
/// Conversion of raw sensor readings for the filters. Corrects offsets, sensitivities, misalignments and iron
/// in the sensors' axes, then converts to body axes.

#include <sonopose/calibration/model/affine.hpp>
#include <sonopose/calibration/model/settings.hpp>
#include <sonopose/samples/samples.hpp>

namespace sonopose::calibration {

/// Three maps, made once from the settings. A value without pointers.
class Calibration {
public:
  /// Constructs the identity.
  Calibration() = default;
  explicit Calibration(const Settings& settings);

  /// Returns the sample in body axes; times, address and sequence stay. Default settings preserve every bit.
  /// A number that is not finite makes its whole vector so, and a huge one may overflow. Callers that need
  /// finite numbers must check the result.
  [[nodiscard]] ImuSample corrected(const ImuSample& raw) const noexcept;

  /// Re-expresses a rate, corrected by `other`, as corrected by this calibration. Not finite if the
  /// correction by `other` cannot be inverted.
  [[nodiscard]] Vector3d rate_from(const Calibration& other, const Vector3d& rate_body_radps) const noexcept {
    return gyroscope_(other.gyroscope_.inverse_of(rate_body_radps));
  }

  bool operator==(const Calibration&) const = default;

private:
  Affine gyroscope_;
  Affine accelerometer_;
  Affine magnetometer_;
};

}  // namespace sonopose::calibration
