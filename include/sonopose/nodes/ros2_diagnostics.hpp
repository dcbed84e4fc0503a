#pragma once
/// \file
/// What ROS 2's dashboards are told of a beacon, once a second.

#include <sonopose/nodes/beacon_view.hpp>
#include <sonopose/ros2/diagnostics.hpp>

#include <string>

namespace sonopose::nodes {

/// `node` is the name before the colon. `before` is the view of the second before, for counters that rose.
/// No pose for the whole window is STALE; a pose stream without a living writer, or an IMU that is silent,
/// an ERROR; doubts of the pose, and whatever was missed or lost in this second, a WARN.
ros2::Diagnostic diagnostic_of(const std::string& node, const BeaconView& view, const BeaconView& before);

}  // namespace sonopose::nodes
