#include "observation/status_words.hpp"

#include <sonopose/samples/pose.hpp>

#include <array>
#include <string_view>
#include <utility>

namespace sonopose::observation {
namespace {

constexpr std::array<std::pair<PoseStatus, std::string_view>, 14> status_names{{
    {status_initialising, "initialising"},
    {status_uncalibrated, "uncalibrated"},
    {status_stale, "stale"},
    {status_converging, "converging"},
    {status_heading_unknown, "heading unknown"},
    {status_frozen_track, "frozen track"},
    {status_predicted, "predicted"},
    {status_imu_gap, "IMU gap"},
    {status_low_trust, "low trust"},
    {status_rotating_fast, "rotating fast"},
    {status_late, "late"},
    {status_overloaded, "overloaded"},
    {status_imu_inconsistent, "IMU inconsistent"},
    {status_fixes_inconsistent, "fixes inconsistent"},
}};

}  // namespace

std::uint32_t causes_of(std::uint32_t bit) {
  return bit == status_stale ? std::uint32_t{status_frozen_track}
                             : 0U;  // repeated positions are no valid fixes
}

std::uint32_t causes_in(std::uint32_t status) {
  const bool is_explained = (status & causes_of(status_stale)) != 0U;
  return is_explained ? status & ~std::uint32_t{status_stale} : status;
}

std::string status_words(std::uint32_t status) {
  std::string words;
  for (const auto& [bit, name] : status_names) {
    if ((causes_in(status) & bit) == 0U) continue;
    if (!words.empty()) words += ", ";
    words += name;
  }
  return words.empty() ? "ok" : words;
}

}  // namespace sonopose::observation
