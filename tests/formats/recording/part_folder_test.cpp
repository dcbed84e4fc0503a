#include "recording/part_folder.hpp"

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

namespace part_folder_test {

using Catch::Contains;
using sonopose::recording::PartFolder;
using sonopose::test::read_text;
using sonopose::test::TemporaryFolder;
using sonopose::test::write_text;
namespace fs = std::filesystem;

SCENARIO("a recording gets its name when it is complete") {
  const TemporaryFolder folder;
  GIVEN("a folder that is being written") {
    const PartFolder part(folder / "new/log/");
    write_text(part.part() / "imu.csv", "rows");
    THEN("it is called .part, and a second writer is refused") {
      CHECK(part.part() == folder / "new/log.part");
      CHECK_FALSE(exists(folder / "new/log"));
      CHECK_THROWS_WITH(PartFolder(folder / "new/log"), Contains("log.part: exists"));
    }
    WHEN("it is complete") {
      part.commit();
      THEN("it has its name, and is not overwritten") {
        CHECK(read_text(folder / "new/log/imu.csv") == "rows");
        CHECK_FALSE(exists(folder / "new/log.part"));
        CHECK_THROWS_WITH(PartFolder(folder / "new/log"), Contains("already contains a recording (imu.csv)"));
      }
    }
  }
  GIVEN("an empty folder, and a part with a single subfolder") {
    fs::create_directory(folder / "log");
    const PartFolder part(folder / "log");
    fs::create_directory(part.part() / "beacon_7");
    write_text(part.part() / "beacon_7" / "imu.csv", "rows");
    part.commit(part.part() / "beacon_7");
    THEN("the subfolder replaces it") {
      CHECK(read_text(folder / "log/imu.csv") == "rows");
      CHECK_FALSE(exists(folder / "log.part"));
    }
  }
  GIVEN("a folder with something else, and a file") {
    write_text(folder / "notes", "precious");
    THEN("they are refused and stay as they are") {
      CHECK_THROWS_WITH(PartFolder(folder.path()), Contains("is not empty; a recording needs a new folder"));
      CHECK_THROWS_WITH(PartFolder(folder / "notes"), Contains("is not a folder"));
      CHECK(read_text(folder / "notes") == "precious");
      CHECK_FALSE(exists(fs::path(folder.path().string() + ".part")));
    }
  }
}

}  // namespace part_folder_test
