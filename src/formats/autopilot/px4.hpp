#pragma once
/// \file
/// Poses as PX4's messages.

#include "autopilot/external_odometry.hpp"
#include <sonopose/ros2/messages/idl_types.hpp>

#include <cstdint>

namespace sonopose::autopilot {

/// Message for /fmu/in/vehicle_visual_odometry. `measured_ns`, `now_ns`: the pose's time and the present in
/// the clock of PX4's stamps.
ros2::VehicleOdometry vehicle_odometry(const ExternalOdometry& odometry, TimeNs measured_ns, TimeNs now_ns,
                                       std::uint8_t reset_counter, std::uint8_t quality_percent);

}  // namespace sonopose::autopilot
