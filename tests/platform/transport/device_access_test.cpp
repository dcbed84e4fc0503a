/// Advice to a user who may not open a device.

#include "transport/device_access.hpp"

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

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

}  // namespace device_access_test
