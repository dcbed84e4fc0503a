#include <sonopose/ros2/messages/beacon_topics.hpp>
#include <sonopose/ros2/messages/frames.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <map>
#include <set>
#include <stdexcept>

namespace sonopose::ros2 {
namespace {

constexpr std::array<const char*, 7> beacon_outputs{"imu/data_raw", "imu/data", "imu/mag", "odom",
                                                    "pose",         "fix",      "path"};
constexpr std::array<const char*, 5> node_outputs{"/tf", "/tf_static", "/diagnostics", "/rosout",
                                                  "/parameter_events"};
constexpr BeaconAddress last_address = all_beacons - 1;

/// Adds the addresses whose digits occur in `name`: only topics of these beacons can have this name.
void add_addresses_in(const std::string& name, std::set<BeaconAddress>& addresses) {
  constexpr std::size_t max_digits = 5;  // 65534
  for (std::size_t begin = 0; begin < name.size(); ++begin) {
    for (std::size_t length = 1; length <= std::min(max_digits, name.size() - begin); ++length) {
      unsigned value = 0;
      const char* const first = name.data() + begin;
      const auto [end, error] = std::from_chars(first, first + length, value);
      if (error == std::errc() && end == first + length && value <= last_address) {
        addresses.insert(static_cast<BeaconAddress>(value));
      }
    }
  }
}

void check_outputs_of(const NameResolver& names, const std::string& prefix) {
  std::map<std::string, std::string> outputs;
  const auto add = [&](const std::string& output) {
    const std::string name = names.topic(output);
    const auto [found, is_new] = outputs.emplace(name, output);
    if (is_new) return;
    throw std::invalid_argument("'" + found->second + "' and '" + output + "' would both be the topic '" +
                                name + "'");
  };
  for (const char* const output : node_outputs) add(output);
  for (const char* const output : beacon_outputs) add(prefix + output);
}

}  // namespace

const std::vector<std::string>& beacon_topics() {
  static const std::vector<std::string> topics(beacon_outputs.begin(), beacon_outputs.end() - 1);
  return topics;
}

std::string topic_prefix(const std::string& pattern, BeaconAddress address) {
  return pattern.empty() ? std::string() : for_beacon(pattern, address) + "/";
}

bool has_topics_per_beacon(const std::string& pattern) {
  return topic_prefix(pattern, 0) != topic_prefix(pattern, last_address);
}

void check_beacon_namespace(const NameResolver& names, const std::string& pattern) {
  // Validity depends only on letters, digits and length: the shortest and the longest address suffice.
  for (const BeaconAddress address : {BeaconAddress{0}, last_address}) {
    const std::string prefix = topic_prefix(pattern, address);
    for (const char* const output : beacon_outputs) static_cast<void>(names.topic(prefix + output));
  }
}

void check_outputs_differ(const NameResolver& names, const std::string& pattern) {
  // Without a remap rule all names differ.
  std::set<BeaconAddress> addresses{0};
  for (const RemapRule& rule : names.rules()) add_addresses_in(rule.from, addresses);
  for (const BeaconAddress address : addresses) check_outputs_of(names, topic_prefix(pattern, address));
}

}  // namespace sonopose::ros2
