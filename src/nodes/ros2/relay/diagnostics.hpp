#pragma once
/// \file
/// Diagnostic of one beacon for ROS 2 dashboards, published once per second.

#include "observation/beacon_observer.hpp"
#include <sonopose/ros2/messages/diagnostics.hpp>

#include <string>

namespace sonopose::ros2::relay {

/// True if the latest status of the beacon's bridge is recent.
bool has_bridge(const observation::BeaconView& view, TimeNs now_ns);

/// `node`: part of the name before the colon. `before`: view of the previous second; later increases of
/// counters are reported. ERROR: no fusion serves the beacon, its IMU is silent, or its bridge has published
/// no status for three seconds (the bridge's timestamp against `now_ns`, so the clocks must agree). STALE: no
/// poses in the window, without a known cause. WARN: warnings in the pose's status, and increases of
/// counters.
ros2::Diagnostic diagnostic_of(const std::string& node, const observation::BeaconView& view,
                               const observation::BeaconView& before, TimeNs now_ns);

}  // namespace sonopose::ros2::relay
