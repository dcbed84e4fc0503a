#include "transport/device_access.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <grp.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <system_error>
#include <unistd.h>
#include <vector>

namespace sonopose::transport {
namespace {

namespace fs = std::filesystem;

/// Returns the number of a group without a name.
std::string name_of(gid_t id) {
  std::array<char, 4096> buffer{};
  struct group entry {};
  struct group* found = nullptr;
  const bool known = ::getgrgid_r(id, &entry, buffer.data(), buffer.size(), &found) == 0 && found != nullptr;
  return known ? std::string(found->gr_name) : std::to_string(id);
}

/// Returns the first line of a file; empty if it cannot be read.
std::string first_line(const fs::path& file) {
  std::string line;
  std::ifstream stream(file);
  std::getline(stream, line);
  return line;
}

/// Returns the sorted paths in a folder; none if it cannot be read.
std::vector<fs::path> paths_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (fs::directory_iterator each(folder, error), end; !error && each != end; each.increment(error)) {
    paths.push_back(each->path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

bool has_open(const fs::path& process, dev_t device) {
  const auto files = paths_in(process / "fd");
  return std::any_of(files.begin(), files.end(), [device](const fs::path& file) {
    struct stat status {};
    return ::stat(file.c_str(), &status) == 0 && S_ISCHR(status.st_mode) && status.st_rdev == device;
  });
}

/// Returns true for names such as ttyACM0, but not for the consoles tty0 … and for the four ports that the
/// kernel lists whether they exist or not.
bool is_serial_name(const std::string& name) {
  const auto is = [&name](std::size_t at, int (*kind)(int)) {
    return kind(static_cast<unsigned char>(name[at])) != 0;
  };
  if (name.size() < 5 || !name.starts_with("tty") || !is(3, std::isalpha)) return false;
  constexpr const char* unknown_type = "0";
  return is(name.size() - 1, std::isdigit) && first_line("/sys/class/tty/" + name + "/type") != unknown_type;
}

void append(std::string& list, const std::string& item) {
  list += (list.empty() ? "" : ", ") + item;
}

}  // namespace

bool is_other_device(const std::string& device) {
  struct stat status {};
  if (::stat(device.c_str(), &status) != 0 || !S_ISCHR(status.st_mode)) return false;
  // Numbers of Linux (devices.txt): /dev/null and the like, consoles, /dev/tty and /dev/ptmx.
  constexpr unsigned memory = 1;
  constexpr unsigned terminals = 4;
  constexpr unsigned first_serial_line = 64;
  constexpr unsigned other_terminals = 5;
  const unsigned kind = major(status.st_rdev);
  const bool is_line = minor(status.st_rdev) >= first_serial_line;
  if (kind == memory || ((kind == terminals || kind == other_terminals) && !is_line)) return true;
  std::error_code unknown;
  const fs::path subsystem = fs::read_symlink("/sys/dev/char/" + std::to_string(major(status.st_rdev)) + ":" +
                                                  std::to_string(minor(status.st_rdev)) + "/subsystem",
                                              unknown)
                                 .filename();
  return !subsystem.empty() && subsystem != "tty";
}

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

std::string users_of(const std::string& device) {
  std::string users;
  struct stat status {};
  if (::stat(device.c_str(), &status) != 0) return users;
  for (const fs::path& process : paths_in("/proc")) {
    const std::string id = process.filename();
    const bool is_process =
        std::all_of(id.begin(), id.end(), [](unsigned char c) { return std::isdigit(c); });
    if (!is_process || id == std::to_string(::getpid()) || !has_open(process, status.st_rdev)) continue;
    append(users, first_line(process / "comm") + " (process " + id + ")");
  }
  return users;
}

std::string serial_devices(const fs::path& folder) {
  std::string devices;
  std::vector<std::string> linked;
  for (const fs::path& link : paths_in(folder / "serial/by-id")) {
    std::error_code dangling;
    linked.push_back(fs::canonical(link, dangling).filename());
    if (!dangling) append(devices, link.string() + " (" + linked.back() + ")");
  }
  for (const fs::path& path : paths_in(folder)) {
    const std::string name = path.filename();
    const bool is_linked = std::find(linked.begin(), linked.end(), name) != linked.end();
    if (is_serial_name(name) && !is_linked) append(devices, path.string());
  }
  return devices.empty() ? "there is no serial device" : "serial devices: " + devices;
}

}  // namespace sonopose::transport
