#pragma once
/// \file
/// Sentences about status bits, for the log, the doctor and what else explains them.

#include <string_view>

namespace sonopose {

/// Meaning of status_imu_inconsistent.
inline constexpr std::string_view imu_inconsistent_meaning =
    "its gyroscope, accelerometer or mount contradicts fixes, headings or gravity";
/// Meaning of status_fixes_inconsistent.
inline constexpr std::string_view fixes_inconsistent_meaning =
    "some are a default position or of a wrong height, or their clock is not that of the IMU";

}  // namespace sonopose
