#pragma once
/// \file
/// Resolution of names as in ROS 2: namespaces, `~`, remapping, and names in DDS.
/// Source: design.ros2.org, "Topic and Service name mapping to DDS", "Remapping Names"; rmw's validation.

#include <string>
#include <vector>

namespace sonopose::ros2 {

struct NodeName {
  std::string name_space = "/";  ///< absolute: "/" or "/a/b"
  std::string name = "sonopose";
  bool operator==(const NodeName&) const = default;
};

/// Full name of the node: "/a/b/sonopose".
std::string full_name(const NodeName& node);

/// Name of the node's logger: "a.b.sonopose".
std::string logger_name(const NodeName& node);

/// Throws std::invalid_argument, with name and reason, for a name that ROS 2 does not allow, like all these
/// checks.
void check_node_name(const std::string& name);
void check_namespace(const std::string& name_space);
/// Checks an enclave, which has the syntax of a namespace: "/" or "/a/b".
void check_enclave(const std::string& enclave);

/// A rule `from:=to`. `__node` (or `__name`) and `__ns` stand for the name and the namespace of the node.
struct RemapRule {
  std::string from;
  std::string to;
  std::string node = {};  ///< node to which it applies; empty: all nodes
  bool operator==(const RemapRule&) const = default;
};

/// Parses `from:=to` or `node:from:=to`. Throws std::invalid_argument with rule and reason.
RemapRule parse_remap_rule(const std::string& text);

/// Resolves names of a node. Throws std::invalid_argument, with name, reason and rule, for names that ROS 2
/// does not allow. The constructor also checks the name of the node and the rules.
class NameResolver {
public:
  explicit NameResolver(NodeName node, std::vector<RemapRule> rules = {});

  /// Name of the node, after remapping.
  const NodeName& node() const noexcept { return node_; }

  /// Rules for topics of this node, with absolute names.
  const std::vector<RemapRule>& rules() const noexcept { return rules_; }

  /// Absolute name of a topic: relative to the namespace, or `~/x` relative to the node, then remapped by the
  /// first matching rule. "imu/data" → "/robot/imu/data".
  std::string topic(const std::string& name) const;

private:
  std::string expanded(const std::string& name) const;

  NodeName node_;
  std::vector<RemapRule> rules_;
};

/// Name of a topic in DDS: "/imu" → "rt/imu".
std::string name_in_dds(const std::string& topic);

/// Name of a type in ROS 2: "sensor_msgs::msg::dds_::Imu_" → "sensor_msgs/msg/Imu". Other names are returned
/// unchanged.
std::string type_name_in_ros(const std::string& dds_type_name);

}  // namespace sonopose::ros2
