#include "security/roles.hpp"

#include "security/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace sonopose::security {
namespace {

using Topics = std::vector<std::string>;

/// The topics of topics.hpp. Each list is what the programs of the role open.
Access access_of(std::string_view role) {
  const Topics all{"sonopose/*"};
  if (role == "bridge") {
    return {.writes = {"sonopose/imu", "sonopose/fix", "sonopose/heading", "sonopose/twist", "sonopose/truth",
                       "sonopose/beacon_status", "sonopose/line_status", "sonopose/stationary_beacon",
                       "sonopose/log"},
            .reads = {"sonopose/beacon_status", "sonopose/fusion_status"}};
  }
  if (role == "fusion") {
    return {.writes = {"sonopose/pose", "sonopose/report", "sonopose/estimate", "sonopose/fusion_status",
                       "sonopose/settings", "sonopose/changed_settings", "sonopose/settings_reply",
                       "sonopose/log"},
            .reads = {"sonopose/imu", "sonopose/fix", "sonopose/heading", "sonopose/twist", "sonopose/reset",
                      "sonopose/settings_request"}};
  }
  if (role == "operator") {
    return {.writes = {"sonopose/settings_request", "sonopose/reset"}, .reads = all};
  }
  // The parameters of the relay's node are the settings of the fusion.
  if (role == "ros2") {
    return {.writes = {"rt/*", "rq/*", "rr/*", "ros_discovery_info", "sonopose/settings_request",
                       "sonopose/reset", "sonopose/log"},
            .reads = {"rt/*", "rq/*", "rr/*", "ros_discovery_info", "sonopose/*"}};
  }
  if (role == "recorder") return {.writes = {}, .reads = {"sonopose/*", "rt/*"}};
  if (role == "monitor" || role == "web") return {.writes = {}, .reads = all};
  if (role == "autopilot") return {.writes = {"sonopose/log"}, .reads = {"sonopose/pose"}};
  if (role == "consumer") {
    return {.writes = {},
            .reads = {"sonopose/pose", "sonopose/report", "sonopose/estimate", "sonopose/stationary_beacon",
                      "sonopose/beacon_status", "sonopose/fusion_status", "sonopose/line_status"}};
  }
  throw SecurityError(fmt::format("{}: unknown role; the roles are {}", role, fmt::join(role_names, ", ")));
}

void merge(Topics& topics, const Topics& more) {
  topics.insert(topics.end(), more.begin(), more.end());
  std::ranges::sort(topics);
  topics.erase(std::unique(topics.begin(), topics.end()), topics.end());
}

}  // namespace

Access access_of(const std::vector<std::string>& roles) {
  Access all;
  for (const std::string& role : roles) {
    const Access access = access_of(std::string_view(role));
    merge(all.writes, access.writes);
    merge(all.reads, access.reads);
  }
  return all;
}

std::string_view role_of_program(std::string_view verb) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> others{{{"record", "recorder"},
                                                                                 {"settings", "operator"},
                                                                                 {"doctor", "monitor"},
                                                                                 {"play", "bridge"},
                                                                                 {"mavlink", "autopilot"}}};
  const auto* const found =
      std::ranges::find_if(others, [&](const auto& each) { return each.first == verb; });
  return found == others.end() ? verb : found->second;
}

}  // namespace sonopose::security
