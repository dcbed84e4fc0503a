#pragma once
/// \file
/// Causes for which an engine refuses a fix. An outlier is judged, not refused.

#include <sonopose/samples/pose.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>

namespace sonopose {

enum class FixRefusal : std::uint8_t {
  low_quality,
  too_old,  ///< older than the IMU samples allow
  too_new,  ///< newer than the IMU samples
  no_imu,   ///< no IMU sample before it
  invalid   ///< repeated, out of order, not finite or out of range
};

inline constexpr std::size_t fix_refusal_count = static_cast<std::size_t>(FixRefusal::invalid) + 1;

/// Cause of the refusal; empty if the fix was not refused.
inline std::optional<FixRefusal> refusal_of(const FixReport& report) {
  if ((report.flags & fix_low_quality) != 0U) return FixRefusal::low_quality;
  if ((report.flags & (fix_invalid | fix_too_late)) == 0U) return std::nullopt;
  if (report.applied_time_ns == 0) return FixRefusal::no_imu;
  if ((report.flags & fix_too_late) != 0U) return FixRefusal::too_old;
  return report.emission_time_ns > report.applied_time_ns ? FixRefusal::too_new : FixRefusal::invalid;
}

}  // namespace sonopose
