#pragma once
/// \file
/// From raw sensor readings to what the filters use: offsets, sensitivities, misalignments and iron in the
/// sensors' axes, then the body's axes.

#include <sonopose/calibration/model/affine.hpp>
#include <sonopose/calibration/model/settings.hpp>
#include <sonopose/samples/samples.hpp>

namespace sonopose::calibration {

/// The settings as three maps, made once. A value without pointers.
class Calibration {
public:
  /// Changes nothing.
  Calibration() = default;
  explicit Calibration(const Settings& settings);

  /// The sample in body axes, its times, address and sequence as they were. With default settings it has the
  /// very same bits. A number that is not finite makes the whole of its vector so, and a huge one may
  /// overflow: callers that need finite numbers must check the result.
  [[nodiscard]] ImuSample corrected(const ImuSample& raw) const noexcept;

  /// Re-expresses a rate, corrected by `other`, as corrected by this one. Not finite where that cannot be
  /// known.
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
