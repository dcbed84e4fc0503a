#pragma once
/// \file
/// Configuration by ROS 2's environment variables. Source: rcl and rmw_cyclonedds.

#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::ros2 {

/// Environment variables by name. As in ROS 2, an empty variable counts as not set.
using Variables = std::map<std::string, std::string>;

/// Names of the variables that the functions below use. dds::resolve_domain_id uses ROS_DOMAIN_ID.
const std::vector<std::string>& variable_names();

/// Replaces network and peers of `options` according to the discovery range: ROS_LOCALHOST_ONLY,
/// ROS_AUTOMATIC_DISCOVERY_RANGE and ROS_STATIC_PEERS. The default is the subnet. Throws
/// std::invalid_argument with variable, value and the allowed values. The range OFF is rejected, because no
/// process could discover the node.
dds::DomainOptions with_discovery_range(dds::DomainOptions options, const Variables& variables);

/// Known distributions, oldest first.
std::vector<std::string> distro_names();

/// Discovery layout of a distribution by its name, such as "foxy"; empty for an unknown name.
std::optional<Distro> distro_named(const std::string& name);

struct FoundDistro {
  std::optional<Distro> distro = std::nullopt;  ///< empty if the variable is not set
  std::string warning = {};                     ///< warning with variable and value; may be empty
};

/// Distribution by ROS_DISTRO, which the setup files of ROS 2 set. An unknown name counts as a newer
/// distribution and causes a warning.
FoundDistro distro_of(const Variables& variables);

}  // namespace sonopose::ros2
