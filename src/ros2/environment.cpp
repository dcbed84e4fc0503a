#include <sonopose/ros2/environment.hpp>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace sonopose::ros2 {
namespace {

constexpr const char* localhost_only = "ROS_LOCALHOST_ONLY";
constexpr const char* discovery_range = "ROS_AUTOMATIC_DISCOVERY_RANGE";
constexpr const char* static_peers = "ROS_STATIC_PEERS";
constexpr const char* ros_distro = "ROS_DISTRO";

constexpr std::array<std::string_view, 6> old_distros{"crystal", "dashing",  "eloquent",
                                                      "foxy",    "galactic", "humble"};
constexpr std::array<std::string_view, 4> new_distros{"iron", "jazzy", "kilted", "rolling"};

std::string value_of(const Variables& variables, const char* name) {
  const auto found = variables.find(name);
  return found == variables.end() ? std::string() : found->second;
}

[[noreturn]] void refuse(const char* name, const std::string& value, const std::string& why) {
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

bool only_localhost(const Variables& variables) {
  const std::string value = value_of(variables, localhost_only);
  if (!value.empty() && value != "0" && value != "1") refuse(localhost_only, value, "it must be 0 or 1");
  return value == "1";
}

}  // namespace

const std::vector<std::string>& variable_names() {
  static const std::vector<std::string> names{localhost_only, discovery_range, static_peers, ros_distro};
  return names;
}

dds::DomainOptions with_discovery_range(dds::DomainOptions options, const Variables& variables) {
  options.peers.clear();
  // The older variable wins, and then neither range nor peers count.
  if (only_localhost(variables)) {
    options.network = dds::Network::ros_localhost;
    return options;
  }
  const std::string range = value_of(variables, discovery_range);
  if (range == "OFF") {
    refuse(discovery_range, range, "no process could find this one then, nor it any");
  }
  if (range == "LOCALHOST") {
    options.network = dds::Network::ros_localhost;
  } else if (range.empty() || range == "SUBNET" || range == "SYSTEM_DEFAULT") {
    options.network = dds::Network::ros_subnet;
  } else {
    refuse(discovery_range, range, "it must be OFF, LOCALHOST, SUBNET or SYSTEM_DEFAULT");
  }
  if (range != "SYSTEM_DEFAULT") options.peers = split(value_of(variables, static_peers), ';');
  return options;
}

std::optional<Distro> distro_named(const std::string& name) {
  const auto is_one_of = [&](const auto& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (is_one_of(old_distros)) return Distro::humble;
  if (is_one_of(new_distros)) return Distro::jazzy;
  return std::nullopt;
}

std::optional<Distro> distro_of(const Variables& variables) {
  const std::string name = value_of(variables, ros_distro);
  if (name.empty()) return std::nullopt;
  const auto distro = distro_named(name);
  if (!distro) refuse(ros_distro, name, "not known here; humble and jazzy stand for those before and after");
  return distro;
}

}  // namespace sonopose::ros2
