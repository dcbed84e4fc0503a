#include "recording/unread_tables.hpp"

#include "recording/log_columns.hpp"
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <system_error>

namespace sonopose::recording {

std::vector<std::string> unread_tables(const std::filesystem::path& folder) {
  constexpr std::array<std::string_view, 10> known{imu_file,   ultrasonic_file,  heading_file,  twist_file,
                                                   truth_file, wheel_speed_file, movement_file, pose_file,
                                                   fixes_file, covariance_file};
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    std::string lower = name;
    std::ranges::transform(lower, lower.begin(), [](unsigned char letter) { return std::tolower(letter); });
    const bool is_table = lower.ends_with(".csv") || lower.ends_with(".csv.gz");
    if (is_table && std::ranges::find(known, name) == known.end()) names.push_back(name);
  }
  if (names.empty()) return {};
  std::ranges::sort(names);
  return {fmt::format("{}: not read: {}", folder.string(),
                      text::escaped(fmt::format("{}", fmt::join(names, ", "))))};
}

}  // namespace sonopose::recording
