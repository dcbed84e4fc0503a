/// Advice to a user who may not open a device.

#include "transport/device_access.hpp"

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <filesystem>
#include <grp.h>
#include <string>
#include <sys/stat.h>
#include <unistd.h>

namespace device_access_test {

using namespace sonopose::transport;
using Catch::Contains;

SCENARIO("a device that is not for this user names the group to join, with the command") {
  const sonopose::test::TemporaryFolder folder;
  const auto device = folder / "ttyACM0";
  sonopose::test::write_text(device, "");
  struct stat status {};
  REQUIRE(::stat(device.c_str(), &status) == 0);
  const auto* const entry = ::getgrgid(status.st_gid);
  const std::string group = entry != nullptr ? entry->gr_name : std::to_string(status.st_gid);
  WHEN("its group may use it") {
    REQUIRE(::chmod(device.c_str(), 0660) == 0);
    CHECK_THAT(access_remedy(device), Contains("sudo usermod -aG " + group + " $USER") && Contains("log in"));
  }
  WHEN("not even its group may") {
    REQUIRE(::chmod(device.c_str(), 0600) == 0);
    CHECK_THAT(access_remedy(device), Contains(group) && Contains("udev") && !Contains("usermod"));
  }
  WHEN("it cannot be seen") {
    CHECK_THAT(access_remedy(folder / "none/ttyACM0"), Contains("folder"));
  }
}

SCENARIO("the serial devices that exist are listed, first by the names that stay") {
  const sonopose::test::TemporaryFolder dev;
  CHECK(serial_devices(dev.path()) == "there is no serial device");
  for (const char* const name : {"ttyUSB0", "ttyACM0", "ttyACM1", "tty1", "null", "ttyprintk"}) {
    sonopose::test::write_text(dev / name, "");
  }
  const auto links = dev / "serial/by-id";
  std::filesystem::create_directories(links);
  std::filesystem::create_symlink("../../ttyACM1", links / "usb-Marvelmind_beacon");
  std::filesystem::create_symlink("../../ttyACM7", links / "usb-unplugged");
  const std::string folder = dev.path().string();
  CHECK(serial_devices(dev.path()) == "serial devices: " + folder +
                                          "/serial/by-id/usb-Marvelmind_beacon (ttyACM1), " + folder +
                                          "/ttyACM0, " + folder + "/ttyUSB0");
}

SCENARIO("only devices that the kernel knows as something else are other devices") {
  CHECK(is_other_device("/dev/null"));
  CHECK_FALSE(is_other_device("/dev/sonopose-no-such-device"));
  // It makes a new terminal for each process that opens it, which nothing ever writes to.
  CHECK(is_other_device("/dev/ptmx"));
  CHECK(is_other_device("/dev/tty"));
}

}  // namespace device_access_test
