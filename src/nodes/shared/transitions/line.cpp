#include "transitions/line.hpp"

#include <sonopose/samples/status_meanings.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

namespace sonopose::transitions {
namespace {

using logging::Level;

/// Returns the line of a state: level and words of its beginning, or the words of its end.
LogText begun_or_ended(const Transition& transition, Level level, const std::string& begun,
                       std::string_view ended) {
  if (transition.begins) return {level, begun};
  return {level == Level::debug ? Level::debug : Level::info,
          fmt::format("{}, after {:.1f} s", ended, transition.lasted_s)};
}

LogText words_of(const Transition& transition) {
  switch (transition.kind) {
    case Kind::found:
      return {Level::info, "found"};
    case Kind::initialised:
      return {Level::info, fmt::format("initialised, after {:.1f} s", transition.lasted_s)};
    case Kind::restarted:
      return {Level::warning, "restarted: the estimate was discarded"};
    case Kind::relocated:
      return {Level::warning,
              fmt::format("relocated: the position jumped by {:.2f} m to the fixes", transition.value)};
    case Kind::stale:
      return begun_or_ended(transition, Level::warning,
                            fmt::format("stale: no valid fix for {:.1f} s", transition.value),
                            "no longer stale");
    case Kind::frozen:
      return begun_or_ended(transition, Level::warning,
                            "frozen track: the fixes repeat one position while the IMU moves",
                            "the fixes move again");
    case Kind::gated:
      if (transition.begins) {
        return {Level::warning, fmt::format("gated: {} fixes in a row are outliers, the latest by {:.2f} m",
                                            transition.count, transition.value)};
      }
      return {Level::info,
              fmt::format("no longer gated, after {}", text::count_text(transition.count, "fix", "fixes"))};
    case Kind::converging:
      return begun_or_ended(transition, Level::warning,
                            "converging again: the pose is corrected by a large distance", "converged");
    case Kind::low_trust:
      return begun_or_ended(transition, Level::warning,
                            "low trust: the fixes contradict the IMU; sonopose-doctor names causes",
                            "the fixes are trusted again");
    case Kind::imu_inconsistent:
      return begun_or_ended(
          transition, Level::warning,
          fmt::format("IMU inconsistent: {}; sonopose-doctor names causes", imu_inconsistent_meaning),
          "the IMU is consistent again");
    case Kind::fixes_inconsistent:
      return begun_or_ended(transition, Level::warning,
                            fmt::format("fixes inconsistent: {}", fixes_inconsistent_meaning),
                            "the fixes are consistent again");
    case Kind::heading_unknown:
      return begun_or_ended(transition, Level::warning,
                            "heading unknown: no recent pair heading, and too little motion",
                            "heading known");
    case Kind::imu_gap:
      return begun_or_ended(transition, Level::debug, "IMU gap: samples are missing", "end of the IMU gap");
    case Kind::imu_silent:
      return begun_or_ended(transition, Level::warning,
                            fmt::format("IMU silent: no sample for {:.1f} s", transition.lasted_s),
                            "IMU samples arrive again");
    case Kind::fixes_silent:
      return begun_or_ended(transition, Level::warning,
                            fmt::format("no fix for {:.1f} s", transition.lasted_s), "fixes arrive again");
    case Kind::poses_silent:
      return begun_or_ended(transition, Level::warning,
                            fmt::format("no pose for {:.1f} s", transition.lasted_s), "poses arrive again");
    case Kind::bridge_lost:
      return begun_or_ended(transition, Level::error,
                            "bridge lost: it crashed, was killed, or cannot be reached",
                            "a bridge sends again");
    case Kind::overloaded:
      if (transition.begins) {
        return {Level::warning,
                "overloaded: every sample is fused, but poses are skipped; docs/realtime.md lists remedies"};
      }
      return {Level::info, "no longer overloaded: every pose is written"};
  }
  return {};
}

}  // namespace

LogText line_of(const Transition& transition) {
  LogText line = words_of(transition);
  if (transition.address != all_beacons) {
    line.text = fmt::format("beacon {}: {}", transition.address, line.text);
  }
  return line;
}

std::string_view change_of(std::string_view line_text) {
  constexpr std::string_view after_address = ": ";
  const std::size_t address_end = line_text.find(after_address);
  const bool has_address = line_text.starts_with("beacon ") && address_end != std::string_view::npos;
  const std::size_t begin = has_address ? address_end + after_address.size() : 0;
  std::string_view change = line_text.substr(0, line_text.find_first_of(":,(", begin));
  while (change.ends_with(' ')) change.remove_suffix(1);
  return change;
}

}  // namespace sonopose::transitions
