#pragma once
/// \file
/// Hashes by which ROS 2 (Iron and later) compares type definitions: RIHS01 of REP-2011, generated from
/// `idl/ros2` at build time.

#include <string>

namespace sonopose::ros2 {

/// Hash "RIHS01_<64 hexadecimal digits>" of a type, given by its name in DDS
/// ("sensor_msgs::msg::dds_::Imu_"). Throws std::invalid_argument for a type that is not in `idl/ros2`.
std::string type_hash(const std::string& dds_type_name);

}  // namespace sonopose::ros2
