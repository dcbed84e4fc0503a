#pragma once
/// \file
/// What the variables of a ROS 2 shell ask for. Source: rcl and rmw_cyclonedds.

#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/ros2/messages/node.hpp>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::ros2 {

/// The environment's variables by name; what is empty counts as not set, as in ROS 2.
using Variables = std::map<std::string, std::string>;

/// The names of those that are read here. ROS_DOMAIN_ID is read where every process reads it
/// (dds::resolve_domain_id).
const std::vector<std::string>& variable_names();

/// How far to look for ROS 2 nodes: network and peers of `options` are replaced by those that
/// ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE and ROS_STATIC_PEERS ask for, the subnet where they say
/// nothing. Throws std::invalid_argument that names variable, value and what is allowed. The range OFF is
/// refused too: a node that keeps it can be found by nobody.
dds::DomainOptions with_discovery_range(dds::DomainOptions options, const Variables& variables);

/// The distributions that are known, from the oldest on.
std::vector<std::string> distro_names();

/// The layout that a distribution speaks, by its name: "foxy". Empty for a name that is not known.
std::optional<Distro> distro_named(const std::string& name);

inline constexpr Distro newest_layout = Distro::jazzy;

struct FoundDistro {
  Distro distro = newest_layout;
  std::string warning = {};  ///< names variable and value; empty: there is none
};

/// By ROS_DISTRO, which ROS's setup sets. A name that is not known is taken for a newer one, with a warning.
FoundDistro distro_of(const Variables& variables);

}  // namespace sonopose::ros2
