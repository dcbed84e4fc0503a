#pragma once
/// \file
/// Names as ROS 2 resolves them: namespace, `~`, remapping, and what stands on the wire.
/// Source: design.ros2.org, "Topic and Service name mapping to DDS", "Remapping Names"; rmw's validation.

#include <string>
#include <vector>

namespace sonopose::ros2 {

struct NodeName {
  std::string name_space = "/";  ///< absolute: "/" or "/a/b"
  std::string name = "sonopose";
  bool operator==(const NodeName&) const = default;
};

/// The node's full name: "/a/b/sonopose".
std::string full_name(const NodeName& node);

/// Each throws std::invalid_argument, naming it and what is wrong, for what ROS 2 does not allow.
void check_node_name(const std::string& name);
void check_namespace(const std::string& name_space);
/// An enclave is written as a namespace is: "/" or "/a/b".
void check_enclave(const std::string& enclave);

/// One rule of ROS's `from:=to`. `__node` (or `__name`) and `__ns` stand for the node's own name.
struct RemapRule {
  std::string from;
  std::string to;
  std::string node = {};  ///< the name of the only node that it is for; empty: for all
  bool operator==(const RemapRule&) const = default;
};

/// Reads `from:=to` or `node:from:=to`. Throws std::invalid_argument that names the rule and what is wrong.
RemapRule parse_remap_rule(const std::string& text);

/// What a name of this node's is in the end. Throws std::invalid_argument, naming the name, what is wrong and
/// the rule, for names that ROS 2 does not allow; the constructor also for the node's own and the rules'.
class NameResolver {
public:
  explicit NameResolver(NodeName node, std::vector<RemapRule> rules = {});

  /// After the rules for the node's own name.
  const NodeName& node() const noexcept { return node_; }

  /// Those for topics that are for this node, both sides absolute.
  const std::vector<RemapRule>& rules() const noexcept { return rules_; }

  /// The absolute name: a relative one stands in the namespace, `~/x` below the node; then the first rule
  /// whose left side is this name gives another. "imu/data" → "/robot/imu/data".
  std::string topic(const std::string& name) const;

private:
  std::string expanded(const std::string& name) const;

  NodeName node_;
  std::vector<RemapRule> rules_;
};

/// What a topic is called in DDS: "/imu" → "rt/imu".
std::string name_in_dds(const std::string& topic);

}  // namespace sonopose::ros2
