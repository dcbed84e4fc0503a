#pragma once
/// \file
/// Poses as ArduPilot's AP_DDS takes them: the transform from odom to base_link on /ap/tf, where the odom
/// frame is north, west, up. Source: ArduPilot, AP_DDS_External_Odom.cpp.

#include "autopilot/external_odometry.hpp"
#include "autopilot/external_vision_gate.hpp"
#include <sonopose/ros2/messages/idl_types.hpp>

#include <string>

namespace sonopose::autopilot {

/// Names of the frames, which a message borrows.
struct ArduPilotFrames {
  std::string parent = "odom";
  std::string child = "base_link";
};

/// Reason why ArduPilot gets no pose: it would take NaN into its filter. `with_velocity`: the message has
/// one.
NotSent ardupilot_not_sent(const ExternalOdometry& odometry, bool with_velocity);

/// The pose with a known yaw. `measured_ns`: its time since the start of the autopilot.
ros2::TransformStamped ardupilot_transform(const ExternalOdometry& odometry, TimeNs measured_ns,
                                           const ArduPilotFrames& frames);

}  // namespace sonopose::autopilot
