#pragma once
// Walks over the declared rows of every group; the one place that knows which groups there are.

#include <sonopose/settings/settings.hpp>

#include <string_view>

namespace sonopose::settings::detail {

template <class Group, class Value>
constexpr std::string_view group_of(const Declaration<Group, Value>& /*row*/) {
  return Group::group;
}

/// Calls `visit(row, value)` for every setting of one group.
template <class Group, class Visit>
void for_each_in(Group& group, const Visit& visit) {
  std::remove_const_t<Group>::declarations()(
      [&](const auto&... row) { (visit(row, group.*(row.field)), ...); });
}

/// Calls `visit(row, value)` for every setting; `AnySettings` is Settings or const Settings.
template <class AnySettings, class Visit>
void for_each_setting(AnySettings& settings, const Visit& visit) {
  auto& [preset, drift, velocity, alignment, heading, delay, outage, admission, trust, runaway, motion,
         attitude, startup, frozen, uncertainty, output, calibration] = settings;
  auto& [selection, adaptive_groups, mahony, complementary, ahrs] = attitude;
  auto& [adaptive, rest, bias, magnetic] = adaptive_groups;
  auto& [axes, gyroscope, accelerometer, magnetometer] = calibration;
  const auto each = [&visit](auto&... group) { (for_each_in(group, visit), ...); };
  each(preset, drift, velocity, alignment, heading, delay, outage, admission, trust, runaway, motion,
       selection, mahony, adaptive, rest, bias, magnetic, complementary, ahrs, startup, frozen, uncertainty,
       output, axes, gyroscope, accelerometer, magnetometer);
}

}  // namespace sonopose::settings::detail
