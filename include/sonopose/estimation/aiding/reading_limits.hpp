#pragma once
/// \file
/// Limits of the readings of an IMU.

#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <optional>

namespace sonopose::estimation::aiding {

/// A setting whose limit a sample exceeds.
struct ExceededLimit {
  const char* key = nullptr;
  double value = 0;
};

/// The limit that the readings of an IMU sample exceed; empty if there is none.
[[nodiscard]] std::optional<ExceededLimit> exceeded_limit(const settings::AdmissionSettings& settings,
                                                          const ImuSample& imu);

}  // namespace sonopose::estimation::aiding
