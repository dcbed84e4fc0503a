#include <sonopose/ros2/node/environment.hpp>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace sonopose::ros2 {
namespace {

constexpr const char* localhost_only = "ROS_LOCALHOST_ONLY";
constexpr const char* discovery_range = "ROS_AUTOMATIC_DISCOVERY_RANGE";
constexpr const char* static_peers = "ROS_STATIC_PEERS";
constexpr const char* ros_distro = "ROS_DISTRO";

struct NamedDistro {
  const char* name;
  Distro layout;
};
constexpr std::array<NamedDistro, 10> distros{{{"crystal", Distro::humble},
                                               {"dashing", Distro::humble},
                                               {"eloquent", Distro::humble},
                                               {"foxy", Distro::humble},
                                               {"galactic", Distro::humble},
                                               {"humble", Distro::humble},
                                               {"iron", Distro::jazzy},
                                               {"jazzy", Distro::jazzy},
                                               {"kilted", Distro::jazzy},
                                               {"rolling", Distro::jazzy}}};

std::string value_of(const Variables& variables, const char* name) {
  const auto found = variables.find(name);
  return found == variables.end() ? std::string() : found->second;
}

[[noreturn]] void refuse_variable(const char* name, const std::string& value, const std::string& why) {
  throw std::invalid_argument(std::string(name) + " is '" + value + "': " + why);
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    if (end > begin) parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::vector<std::string> peers(const Variables& variables) {
  const std::string value = value_of(variables, static_peers);
  std::vector<std::string> found = split(value, ';');
  for (const std::string& peer : found) {
    if (peer.find_first_of("<>&\"' \t\n") == std::string::npos) continue;
    refuse_variable(static_peers, value,
                    "'" + peer + "' is not an address or a host name; separate several with ';'");
  }
  return found;
}

bool only_localhost(const Variables& variables) {
  const std::string value = value_of(variables, localhost_only);
  if (!value.empty() && value != "0" && value != "1")
    refuse_variable(localhost_only, value, "it must be 0 or 1");
  return value == "1";
}

}  // namespace

const std::vector<std::string>& variable_names() {
  static const std::vector<std::string> names{localhost_only, discovery_range, static_peers, ros_distro};
  return names;
}

dds::DomainOptions with_discovery_range(dds::DomainOptions options, const Variables& variables) {
  options.peers.clear();
  // The older variable has precedence. Range and peers are then ignored.
  if (only_localhost(variables)) {
    options.network = dds::Network::ros_localhost;
    return options;
  }
  const std::string range = value_of(variables, discovery_range);
  if (range == "OFF") {
    refuse_variable(discovery_range, range, "no process could discover this one, or be discovered by it");
  }
  if (range == "LOCALHOST") {
    options.network = dds::Network::ros_localhost;
  } else if (range.empty() || range == "SUBNET" || range == "SYSTEM_DEFAULT") {
    options.network = dds::Network::ros_subnet;
  } else {
    refuse_variable(discovery_range, range, "it must be OFF, LOCALHOST, SUBNET or SYSTEM_DEFAULT");
  }
  if (range != "SYSTEM_DEFAULT") options.peers = peers(variables);
  return options;
}

std::vector<std::string> distro_names() {
  std::vector<std::string> names;
  for (const NamedDistro& each : distros) names.emplace_back(each.name);
  return names;
}

std::optional<Distro> distro_named(const std::string& name) {
  const auto found = std::find_if(distros.begin(), distros.end(),
                                  [&](const NamedDistro& each) { return each.name == name; });
  if (found == distros.end()) return std::nullopt;
  return found->layout;
}

FoundDistro distro_of(const Variables& variables) {
  const std::string name = value_of(variables, ros_distro);
  if (name.empty()) return {};
  if (const auto known = distro_named(name)) return {.distro = known, .warning = {}};
  return {.distro = Distro::jazzy,
          .warning = std::string(ros_distro) + " is '" + name +
                     "', which is unknown: the node is announced as in Iron and later"};
}

}  // namespace sonopose::ros2
