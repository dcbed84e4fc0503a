#pragma once
/// \file
/// Messages of the server to the page on the WebSocket /ws: JSON texts of the sub-protocol sonopose.v1. Times
/// are seconds since the Unix epoch, units are SI and radians, null is unknown. `op` is the name of the
/// message:
///
///   hello       first: version, mode (live or recording), allow_changes, domain, title
///   frame       25 times a second: t, and `beacons` with what is new: a (address); pose: t and
///               live::pose_columns; truth: t, x, y, z, yaw; fixes: t_applied, t_emission, x, y, z, ix, iy,
///               iz (innovation), test ratio, weight, flags, verdict (0 used, 1 down-weighted, 2 rejected)
///   status      once a second: the object of `sonopose-monitor --json`
///   event       t, level, text; for a log line also program, host, pid, and missing: lines lost before it. A
///               new page gets the latest 500
///   stationary  beacons (a, x, y, z)
///   settings    address, values, from_event
///   gone        a: a forgotten beacon
///   reply       to a request: id, accepted, reason, details, from_event
///   findings    running, share, ok, findings
///   dropped     frames that this browser did not take
///
/// Requests of the page are in page_requests.hpp. GET /settings.json has all settings, /status.json the
/// status bits, /map.json the floor plan's place and the geofence, /recording.json the columns of a
/// recording.

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
