#include <sonopose/ros2/messages/names.hpp>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace sonopose::ros2 {
namespace {

/// Limits of rmw: 255 characters in DDS, eight of which are reserved for prefixes and suffixes.
constexpr std::size_t max_topic_length = 247;
constexpr std::size_t max_node_name_length = 255;
constexpr std::size_t max_namespace_length = max_topic_length - 2;
constexpr std::size_t max_enclave_length = 255;  // limit of rcl

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_word(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

[[noreturn]] void refuse(const std::string& what, const std::string& name, const std::string& why) {
  throw std::invalid_argument(what + " '" + name + "': " + why);
}

/// Checks a part of a name between two slashes.
void check_word(const std::string& what, const std::string& name, const std::string& word) {
  if (word.empty()) refuse(what, name, "it is empty, begins or ends with '/', or has two '/' in a row");
  const auto invalid = std::find_if_not(word.begin(), word.end(), is_word);
  if (invalid != word.end()) {
    refuse(
        what, name,
        std::string("it contains '") + *invalid + "'; ROS 2 allows only letters a-z and A-Z, digits and '_'");
  }
  if (is_digit(word.front())) refuse(what, name, "in ROS 2, no part of a name may begin with a digit");
}

/// Checks an absolute name, such as "/a/b".
void check_path(const std::string& what, const std::string& name, std::size_t max_length) {
  if (!name.starts_with('/')) refuse(what, name, "it must begin with '/'");
  for (std::size_t begin = 1, end = 0; end < name.size(); begin = end + 1) {
    end = std::min(name.find('/', begin), name.size());
    check_word(what, name, name.substr(begin, end - begin));
  }
  if (name.size() > max_length) {
    refuse(what, name,
           "it has " + std::to_string(name.size()) + " characters, and ROS 2 allows " +
               std::to_string(max_length));
  }
}

bool names_node(const RemapRule& rule) {
  return rule.from == "__node" || rule.from == "__name";
}
bool names_namespace(const RemapRule& rule) {
  return rule.from == "__ns";
}

/// Calls `resolve` and adds the rule to the text of an exception.
template <class Resolve>
auto with_rule(const RemapRule& rule, const Resolve& resolve) {
  try {
    return resolve();
  } catch (const std::invalid_argument& error) {
    refuse("remap rule", rule.from + ":=" + rule.to, error.what());
  }
}

/// Applies the first rule of each kind, as in rcl.
NodeName renamed(NodeName node, const std::vector<RemapRule>& rules) {
  const auto space = std::find_if(rules.begin(), rules.end(), names_namespace);
  const auto name = std::find_if(rules.begin(), rules.end(), names_node);
  if (space != rules.end()) {
    with_rule(*space, [&] { check_namespace(space->to); });
    node.name_space = space->to;
  }
  if (name != rules.end()) {
    with_rule(*name, [&] { check_node_name(name->to); });
    node.name = name->to;
  }
  return node;
}

}  // namespace

std::string full_name(const NodeName& node) {
  return (node.name_space == "/" ? "" : node.name_space) + "/" + node.name;
}

std::string logger_name(const NodeName& node) {
  std::string name = full_name(node).substr(1);
  std::replace(name.begin(), name.end(), '/', '.');
  return name;
}

void check_node_name(const std::string& name) {
  const char* const what = "node name";
  if (name.empty()) refuse(what, name, "it is empty");
  check_word(what, name, name);
  if (name.size() > max_node_name_length) {
    refuse(what, name, "ROS 2 allows " + std::to_string(max_node_name_length) + " characters");
  }
}

void check_namespace(const std::string& name_space) {
  if (name_space != "/") check_path("namespace", name_space, max_namespace_length);
}

void check_enclave(const std::string& enclave) {
  if (enclave != "/") check_path("enclave", enclave, max_enclave_length);
}

RemapRule parse_remap_rule(const std::string& text) {
  const std::string assignment = ":=";
  const std::size_t split = text.find(assignment);
  if (split == std::string::npos) refuse("remap rule", text, "it must be 'from:=to'");
  RemapRule rule{.from = text.substr(0, split), .to = text.substr(split + assignment.size())};
  const std::size_t colon = rule.from.find(':');
  if (colon != std::string::npos) {
    rule.node = rule.from.substr(0, colon);
    rule.from.erase(0, colon + 1);
    if (rule.node.empty()) refuse("remap rule", text, "there is no node name before ':'");
  }
  if (rule.from.empty() || rule.to.empty()) refuse("remap rule", text, "a side of ':=' is empty");
  return rule;
}

NameResolver::NameResolver(NodeName node, std::vector<RemapRule> rules) {
  std::erase_if(rules, [&](const RemapRule& rule) { return !rule.node.empty() && rule.node != node.name; });
  check_node_name(node.name);
  check_namespace(node.name_space);
  node_ = renamed(std::move(node), rules);
  std::erase_if(rules, [](const RemapRule& rule) { return names_node(rule) || names_namespace(rule); });
  for (const RemapRule& rule : rules) {
    rules_.push_back(with_rule(rule, [&] {
      return RemapRule{.from = expanded(rule.from), .to = expanded(rule.to), .node = rule.node};
    }));
  }
}

std::string NameResolver::expanded(const std::string& name) const {
  std::string path = name;
  if (name == "~" || name.starts_with("~/")) {
    path = full_name(node_) + name.substr(1);
  } else if (!name.starts_with('/')) {
    path = (node_.name_space == "/" ? "" : node_.name_space) + "/" + name;
  }
  check_path("topic name", path, max_topic_length);
  return path;
}

std::string NameResolver::topic(const std::string& name) const {
  const std::string path = expanded(name);
  const auto rule =
      std::find_if(rules_.begin(), rules_.end(), [&](const RemapRule& each) { return each.from == path; });
  return rule == rules_.end() ? path : rule->to;
}

std::string name_in_dds(const std::string& topic) {
  return "rt" + topic;
}

std::string type_name_in_ros(const std::string& dds_type_name) {
  constexpr std::string_view infix = "::dds_::";
  const std::size_t found = dds_type_name.find(infix);
  const std::size_t package_end = dds_type_name.find("::");
  if (found == std::string::npos || package_end >= found || !dds_type_name.ends_with('_'))
    return dds_type_name;
  const std::size_t name_begin = found + infix.size();
  return dds_type_name.substr(0, package_end) + '/' +
         dds_type_name.substr(package_end + 2, found - package_end - 2) + '/' +
         dds_type_name.substr(name_begin, dds_type_name.size() - name_begin - 1);
}

}  // namespace sonopose::ros2
