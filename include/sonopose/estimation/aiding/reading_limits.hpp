#pragma once
/// \file
/// Limits of the readings of sensors.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <optional>

namespace sonopose::estimation::aiding {

/// A setting whose limit a sample exceeds.
struct ExceededLimit {
  const char* key = nullptr;  ///< null: the specific force is exactly zero, as of no accelerometer
  double value = 0;
};

/// The limit that the readings of an IMU sample exceed; empty if there is none.
[[nodiscard]] std::optional<ExceededLimit> exceeded_limit(const settings::AdmissionSettings& settings,
                                                          const ImuSample& imu);

/// The limit that the position of a fix, or that of its tag on the body, exceeds; empty if there is none.
[[nodiscard]] std::optional<ExceededLimit> exceeded_limit(const settings::AdmissionSettings& settings,
                                                          const UltrasonicFix& fix);

}  // namespace sonopose::estimation::aiding
