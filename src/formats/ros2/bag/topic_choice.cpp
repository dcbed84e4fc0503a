#include "ros2/bag/topic_choice.hpp"

#include "files/error.hpp"
#include "recording/log_folder.hpp"
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/text/count_text.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace sonopose::ros2::bag {
namespace {

using Types = std::vector<std::string_view>;

const Types imu_types{"sensor_msgs/msg/Imu"};
const Types fix_types{"geometry_msgs/msg/PointStamped", "geometry_msgs/msg/PoseWithCovarianceStamped"};
const Types truth_types{"nav_msgs/msg/Odometry", "geometry_msgs/msg/PoseStamped",
                        "geometry_msgs/msg/PoseWithCovarianceStamped"};
/// In the order of AidingInput::Type. A service is not recorded.
constexpr std::array<std::string_view, 9> aiding_types{"nav_msgs/msg/Odometry",
                                                       "geometry_msgs/msg/TwistWithCovarianceStamped",
                                                       "geometry_msgs/msg/TwistStamped",
                                                       "sensor_msgs/msg/JointState",
                                                       "sensor_msgs/msg/Imu",
                                                       "geometry_msgs/msg/PoseWithCovarianceStamped",
                                                       "geometry_msgs/msg/PoseStamped",
                                                       "std_msgs/msg/Float64",
                                                       "robot_localization/srv/SetPose"};

bool has(const Types& types, const std::string& type) {
  return std::ranges::find(types, type) != types.end();
}

std::string with_address(const std::string& text, BeaconAddress address) {
  if (text.find('=') != std::string::npos) return text;
  const std::size_t place = std::min(text.find('@'), text.size());
  return fmt::format("{}={}{}", text.substr(0, place), address, text.substr(place));
}

struct Parsed {
  std::vector<Input> inputs;
  std::vector<AidingInput> aidings;
};

Parsed parse(const TopicChoice& choice, BeaconAddress address) {
  Parsed parsed;
  const auto add = [&](Input::Kind kind, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      parsed.inputs.push_back(Input::parse(kind, with_address(text, address)));
      parsed.inputs.back().imu_meaning = choice.imu_meaning;
      if (parsed.inputs.back().imu_type != ImuType::ros) {
        throw std::invalid_argument(text_of(parsed.inputs.back()) +
                                    " can only be read live, by sonopose-ros2");
      }
    }
  };
  add(Input::Kind::imu, choice.imu);
  add(Input::Kind::fix, choice.fix);
  for (const auto& [kind, texts] : choice.aiding) {
    for (const std::string& text : texts) {
      AidingInput input = AidingInput::parse(kind, with_address(text, address));
      if (kind == AidingInput::Kind::wheels) input.wheels = choice.wheels.value_or(Wheels{});
      parsed.aidings.push_back(std::move(input));
    }
  }
  check(parsed.inputs);
  check(parsed.aidings);
  return parsed;
}

std::string_view without_slash(std::string_view name) {
  if (name.starts_with('/')) name.remove_prefix(1);
  return name;
}

/// Lists topics, all of them or those of some types.
std::string listed(const std::vector<BagTopic>& topics, const Types& types = {}) {
  std::vector<std::string> texts;
  for (const BagTopic& topic : topics) {
    if (types.empty() || (has(types, topic.type) && topic.messages > 0)) texts.push_back(with_type(topic));
  }
  return texts.empty() ? "none" : fmt::format("{}", fmt::join(texts, ", "));
}

/// Finds a topic that was named. Of several types, one that fits comes first.
std::size_t find_topic(const Storage& storage, std::string_view option, std::string_view name,
                       const Types& types) {
  const auto& topics = storage.topics();
  const BagTopic* other = nullptr;
  for (const BagTopic& topic : topics) {
    if (without_slash(topic.name) != without_slash(name)) continue;
    if (has(types, topic.type) && is_usable(topic)) return static_cast<std::size_t>(&topic - topics.data());
    other = &topic;
  }
  if (other == nullptr) {
    throw files::IoError(
        fmt::format("{}: has no topic {} ({}); it has: {}", storage.name(), name, option, listed(topics)));
  }
  if (has(types, other->type)) {
    throw files::IoError(fmt::format(R"({}: {} has the encoding "{}" instead of "cdr")", storage.name(), name,
                                     text::escaped(other->encoding)));
  }
  throw files::IoError(fmt::format("{}: {} is of type {}; {} takes {}{}", storage.name(), name,
                                   other->type.empty() ? "unknown" : text::escaped(other->type), option,
                                   fmt::join(types, ", "),
                                   option == "--fix-in" ? advice_on_type(name, other->type) : ""));
}

/// Finds the only topic of these types that has messages, and is not in `except`; empty if there is none.
std::optional<std::size_t> only_topic(const Storage& storage, std::string_view option, const Types& types,
                                      const std::set<std::size_t>& except) {
  std::optional<std::size_t> found;
  const auto& topics = storage.topics();
  for (std::size_t i = 0; i < topics.size(); ++i) {
    if (!has(types, topics[i].type) || topics[i].messages == 0 || !is_usable(topics[i])) continue;
    if (except.contains(i)) continue;
    if (found) {
      throw files::IoError(fmt::format(
          "{}: has several topics of {}; choose with {}, or for the bridge by sonopose-mcap filter: {}",
          storage.name(), fmt::join(types, " or "), option, listed(topics, types)));
    }
    found = i;
  }
  return found;
}

/// Finds the topic of an input that was not named; empty if there is none.
std::optional<std::size_t> topic_of_type(const Storage& storage, const Inputs& named, Input::Kind kind,
                                         std::string_view option, const Types& types) {
  const bool has_pose = std::ranges::any_of(named.aidings, [](const Inputs::OfAiding& aiding) {
    return aiding.option.kind == AidingInput::Kind::pose;
  });
  if (kind == Input::Kind::fix && has_pose) return std::nullopt;
  std::set<std::size_t> others;
  if (named.truth) others.insert(*named.truth);
  const std::set<std::size_t> truth = others;
  for (const Inputs::OfAiding& aiding : named.aidings) others.insert(aiding.topic);
  // One topic can be that of the IMU and of headings.
  const auto found = only_topic(storage, option, types, others);
  return found ? found : only_topic(storage, option, types, truth);
}

/// Returns the address of the beacon that is read.
BeaconAddress address_of(const Storage& storage, const Parsed& parsed, std::optional<BeaconAddress> given) {
  std::set<BeaconAddress> addresses;
  for (const Input& input : parsed.inputs) addresses.insert(input.address);
  for (const AidingInput& aiding : parsed.aidings) addresses.insert(aiding.address);
  if (addresses.empty()) return given.value_or(recording::default_log_address);
  if (!given && addresses.size() > 1) {
    throw files::IoError(fmt::format("{}: the topics belong to {} beacons; choose one with --beacon: {}",
                                     storage.name(), addresses.size(), fmt::join(addresses, ", ")));
  }
  if (given && !addresses.contains(*given)) {
    throw files::IoError(fmt::format("{}: no topic belongs to beacon {}; they belong to {}", storage.name(),
                                     *given, fmt::join(addresses, ", ")));
  }
  return given.value_or(*addresses.begin());
}

TopicChoice& current_choice() {
  static TopicChoice choice;
  return choice;
}

}  // namespace

std::string with_type(const BagTopic& topic) {
  return fmt::format("{} ({}, {})", text::escaped(topic.name),
                     topic.type.empty() ? "of unknown type" : text::escaped(topic.type),
                     text::count_text(topic.messages, "message"));
}

void choose_topics(TopicChoice choice) {
  parse(choice, recording::default_log_address);
  current_choice() = std::move(choice);
}

const TopicChoice& chosen_topics() {
  return current_choice();
}

bool is_usable(const BagTopic& topic) {
  return topic.encoding == "cdr" || topic.encoding.empty();
}

Inputs find_inputs(const Storage& storage, const TopicChoice& choice, std::optional<BeaconAddress> address,
                   bool needs_fixes) {
  const Parsed parsed = parse(choice, address.value_or(recording::default_log_address));
  Inputs found{.address = address_of(storage, parsed, address)};
  const auto of_other_beacon = [&](const auto& option) { return option.address != found.address; };
  const auto add = [&](Input option, std::size_t topic) {
    if (option.kind == Input::Kind::fix) {
      option.fix_type = storage.topics()[topic].type == fix_types.front() ? FixType::point : FixType::pose;
    }
    found.inputs.push_back({std::move(option), topic});
  };
  const auto add_kind = [&](Input::Kind kind, std::string_view option_name, const Types& types) {
    bool is_named = false;
    for (const Input& option : parsed.inputs) {
      if (option.kind != kind) continue;
      is_named = true;
      if (of_other_beacon(option)) continue;
      const Types allowed = option.fix_type == FixType::point  ? Types{fix_types[0]}
                            : option.fix_type == FixType::pose ? Types{fix_types[1]}
                                                               : types;
      add(option, find_topic(storage, option_name, option.topic, allowed));
    }
    if (is_named) return;
    const auto topic = topic_of_type(storage, found, kind, option_name, types);
    if (!topic) return;
    const BagTopic& chosen = storage.topics()[*topic];
    add({.kind = kind, .topic = chosen.name, .address = found.address, .imu_meaning = choice.imu_meaning},
        *topic);
    found.notes.push_back(fmt::format("{}: uses {} as {}, for it is the only one", storage.name(),
                                      with_type(chosen), kind == Input::Kind::imu ? "the IMU" : "the fixes"));
  };
  if (choice.wheels.has_value() != choice.aiding.contains(AidingInput::Kind::wheels)) {
    throw files::IoError(fmt::format("{}: --wheel-in and --wheels need each other", storage.name()));
  }
  for (const AidingInput& option : parsed.aidings) {
    if (of_other_beacon(option) || !needs_fixes) continue;
    const Types types{aiding_types.at(static_cast<std::size_t>(option.type))};
    found.aidings.push_back({option, find_topic(storage, option_name(option.kind), option.topic, types)});
  }
  if (choice.truth) found.truth = find_topic(storage, "--truth-in", *choice.truth, truth_types);
  add_kind(Input::Kind::imu, "--imu-in", imu_types);
  if (needs_fixes) add_kind(Input::Kind::fix, "--fix-in", fix_types);
  if (found.inputs.empty()) {
    throw files::IoError(fmt::format("{}: has no message of {}, {}; it has: {}", storage.name(),
                                     imu_types.front(), fmt::join(fix_types, ", "),
                                     listed(storage.topics())));
  }
  return found;
}

}  // namespace sonopose::ros2::bag
