#pragma once
/// \file
/// The hashes by which ROS 2 (Iron and later) compares the definitions of types: RIHS01 of REP-2011, made
/// from `idl/ros2` when this is built.

#include <string>

namespace sonopose::ros2 {

/// "RIHS01_<64 hexadecimal digits>" of a type by its name in DDS ("sensor_msgs::msg::dds_::Imu_").
/// Throws std::invalid_argument for a type that `idl/ros2` does not hold.
std::string type_hash(const std::string& dds_type_name);

}  // namespace sonopose::ros2
