#pragma once
/// \file
/// Explains why a device cannot be used.

#include <filesystem>
#include <string>

namespace sonopose::transport {

/// Returns true if the kernel knows the path as a character device that is no terminal, such as /dev/null.
/// Pseudo-terminals and absent devices are not known.
bool is_other_device(const std::string& device);

/// Returns a remedy for a device that this user may not open: the group to join, or that no group may.
std::string access_remedy(const std::string& device);

/// Returns the other processes that have the device open, such as "ModemManager (process 812)". Without
/// privileges only the user's own ones are visible. Takes milliseconds.
std::string users_of(const std::string& device);

/// Returns the serial devices in the folder, first the names that stay when a device is plugged in again
/// (serial/by-id), or that there are none.
std::string serial_devices(const std::filesystem::path& folder = "/dev");

}  // namespace sonopose::transport
