#pragma once
/// \file
/// Names of the topics of one beacon, and their validation.

#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/samples/samples.hpp>

#include <string>
#include <vector>

namespace sonopose::ros2 {

/// Topics of a beacon: "odom", "imu/data", … The path is not among them; it has its own option.
const std::vector<std::string>& beacon_topics();

/// Prefix of the names of a beacon's topics: "hedge_{address}" → "hedge_7/". Empty for an empty pattern: the
/// topics are then in the node's namespace.
std::string topic_prefix(const std::string& pattern, BeaconAddress address);

/// True if each beacon has topics with different names.
bool has_topics_per_beacon(const std::string& pattern);

/// Throws std::invalid_argument, with topic and reason, if ROS 2 does not allow a topic name of any beacon.
void check_beacon_namespace(const NameResolver& names, const std::string& pattern);

/// Throws std::invalid_argument, with both topics, if the remap rules give the same name to two topics of a
/// beacon, or to one of them and a topic of the node, such as /tf.
void check_outputs_differ(const NameResolver& names, const std::string& pattern);

}  // namespace sonopose::ros2
