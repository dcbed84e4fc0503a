#include "observation/stream_state.hpp"

#include "observation/status_words.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::observation {

std::string_view tilt_words(const BeaconView& view) {
  constexpr double upside_down_rad = 135.0 * geometry::radians_per_degree;
  if (!view.wrong_tilt_rad) return "";
  return *view.wrong_tilt_rad > upside_down_rad ? "IMU upside down" : "IMU on its side";
}

std::string stream_words(const BeaconView& view) {
  if (view.lost) return "lost";
  if (view.poses + view.predicted == 0) return "silent";
  std::vector<std::string> words;
  if (has_several_bridges(view)) words.emplace_back("several bridges");
  if (view.fusion && view.fusion->imu_silent) words.emplace_back("IMU silent");
  if (view.wrong_tilt_rad) words.emplace_back(tilt_words(view));
  if (words.empty() || view.pose.status != 0) words.push_back(status_words(view.pose.status));
  return fmt::format("{}", fmt::join(words, ", "));
}

bool has_several_bridges(const BeaconView& view) {
  return view.bridge && view.bridge->other_bridges > 0;
}

int severity_of(const BeaconView& view) {
  if (view.lost) return 100;
  if (view.poses + view.predicted == 0) return 95;
  if (view.fusion && view.fusion->imu_silent) return 90;
  if (has_several_bridges(view)) return 85;  // the pose is of mixed samples
  constexpr int severity_of_tilt = 25;       // the pose is right for the IMU as it is mounted
  return std::max(severity_of_status(view.pose.status), view.wrong_tilt_rad ? severity_of_tilt : 0);
}

int severity_of_status(std::uint32_t status) {
  constexpr std::array<std::pair<std::uint32_t, int>, 13> severities{{{status_initialising, 80},
                                                                      {status_stale, 75},
                                                                      {status_frozen_track, 70},
                                                                      {status_overloaded, 65},
                                                                      {status_imu_inconsistent, 63},
                                                                      {status_low_trust, 60},
                                                                      {status_fixes_inconsistent, 58},
                                                                      {status_late, 55},
                                                                      {status_imu_gap, 40},
                                                                      {status_converging, 35},
                                                                      {status_heading_unknown, 30},
                                                                      {status_uncalibrated, 20},
                                                                      {status_rotating_fast, 5}}};
  constexpr int severity_of_others = 45;
  std::uint32_t rest = status & ~std::uint32_t{status_predicted};  // no fault
  int worst = 0;
  for (const auto& [bit, severity] : severities) {
    if ((rest & bit) != 0U) worst = std::max(worst, severity);
    rest &= ~bit;
  }
  return rest != 0U ? std::max(worst, severity_of_others) : worst;
}

}  // namespace sonopose::observation
