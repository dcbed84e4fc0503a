#pragma once
/// \file
/// What the topics of one beacon are called, and whether they can be called so.

#include <sonopose/samples/samples.hpp>
#include <sonopose/ros2/messages/names.hpp>

#include <string>

namespace sonopose::ros2 {

/// What stands before the names of a beacon's topics: "hedge_{address}" → "hedge_7/". An empty pattern is no
/// prefix: they stand right in the node's namespace then.
std::string topic_prefix(const std::string& pattern, BeaconAddress address);

/// Whether no two beacons share topics by this pattern.
bool tells_topics_apart(const std::string& pattern);

/// Throws std::invalid_argument, naming topic and fault, where ROS 2 would not allow the topics of some
/// beacon.
void check_beacon_namespace(const NameResolver& names, const std::string& pattern);

/// Throws std::invalid_argument, naming both, where the rules give one name to two topics that the node
/// writes: two of one beacon's, or one of them and /tf, /tf_static or /diagnostics.
void check_outputs_differ(const NameResolver& names, const std::string& pattern);

}  // namespace sonopose::ros2
