#pragma once
/// \file
/// Messages of the server to the page: texts of the sub-protocol sonopose.v1 (docs/web.md). Requests of the
/// page are in page_requests.hpp.

#include <sonopose/samples/live_settings.hpp>
#include <sonopose/samples/log_line.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace sonopose::web {

inline constexpr std::string_view page_protocol = "sonopose.v1";

struct Hello {
  std::string version;
  bool is_recording = false;
  bool allows_changes = false;
  std::optional<std::uint32_t> domain_id = {};
  std::string title = {};
};
std::string text_of(const Hello& hello);

struct Reply {
  std::uint64_t id = 0;
  bool accepted = false;
  std::string reason;
  std::string details = {};
  std::uint64_t from_sequence = 0;
};
std::string text_of(const Reply& reply);

std::string event_text(TimeNs time_ns, std::string_view level, std::string_view text);
/// An event with the process that logged it. `missing`: its lines that are missing before this one.
std::string event_text(const LogLine& line, std::uint64_t missing);
std::string settings_text(const EffectiveSettings& settings);
std::string stationary_text(const std::map<BeaconAddress, Vector3d>& positions_world_m);
std::string gone_text(BeaconAddress address);
std::string dropped_text(std::uint64_t frames);
/// `report`: the doctor's JSON.
std::string findings_text(std::string_view report);
std::string examining_text(double share);
/// `views`: the JSON of observation::bus::json_of.
std::string status_text(std::string_view views);

/// Bits of a pose's status, {"bit", "word", "severity"}, as the monitor shows them.
std::string status_table_json();

/// Table of all settings, for the page's form.
std::string settings_table_json();

}  // namespace sonopose::web
