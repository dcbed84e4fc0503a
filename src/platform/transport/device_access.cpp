#include "transport/device_access.hpp"

#include <array>
#include <grp.h>
#include <sys/stat.h>

namespace sonopose::transport {
namespace {

/// Returns the number of a group without a name.
std::string name_of(gid_t id) {
  std::array<char, 4096> buffer{};
  struct group entry {};
  struct group* found = nullptr;
  const bool known = ::getgrgid_r(id, &entry, buffer.data(), buffer.size(), &found) == 0 && found != nullptr;
  return known ? std::string(found->gr_name) : std::to_string(id);
}

}  // namespace

std::string access_remedy(const std::string& device) {
  struct stat status {};
  if (::stat(device.c_str(), &status) != 0) return "a folder on its path may not be entered";
  const std::string group = name_of(status.st_gid);
  constexpr mode_t read_and_write = S_IRGRP | S_IWGRP;
  if ((status.st_mode & read_and_write) != read_and_write) {
    return "its group " + group + " may not use it either: a udev rule can change that";
  }
  return "join its group: sudo usermod -aG " + group + " $USER, and log in again";
}

}  // namespace sonopose::transport
