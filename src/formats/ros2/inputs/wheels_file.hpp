#pragma once
/// \file
/// A file about the wheels of a differential drive.

#include <sonopose/ros2/messages/twist_input.hpp>

#include <filesystem>

namespace sonopose::ros2 {

/// Reads a TOML file with left_joints, right_joints, radius_m and track_m. Throws files::IoError with file,
/// line and key.
Wheels read_wheels(const std::filesystem::path& file);

}  // namespace sonopose::ros2
