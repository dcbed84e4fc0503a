#pragma once
/// \file
/// What ROS 2's dashboards are told of a beacon, once a second.

#include "observation/beacon_view.hpp"
#include <sonopose/ros2/messages/diagnostics.hpp>

#include <string>

namespace sonopose::ros2 {

/// `node` is the name before the colon. `before` is the view of the second before, for counters that rose.
/// ERROR: no fusion serves the beacon, its IMU is silent, or its bridge has told nothing for three seconds
/// (by its own clock against `now_ns`: those of two machines must agree). STALE: no pose for the whole
/// window, and nobody says why. WARN: doubts of the pose, and whatever was missed or lost in this second.
ros2::Diagnostic diagnostic_of(const std::string& node, const observation::BeaconView& view, const observation::BeaconView& before,
                               TimeNs now_ns);

}  // namespace sonopose::ros2
