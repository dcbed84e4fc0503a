#include "bus_log/recording_files.hpp"

#include "bus_log/recorded.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

namespace recording_files_test {

using namespace sonopose::bus_log;
using Catch::Contains;
using sonopose::test::BusRecording;
using sonopose::test::TemporaryFolder;
using sonopose::test::write_text;
using Path = std::filesystem::path;

SCENARIO("a folder of MCAP files is a recording") {
  const TemporaryFolder folder;
  GIVEN("files of a long recording, the part of the last one, and other files") {
    for (const char* const name : {"day_10.mcap", "day_9.mcap", "day_11.mcap.part", "a1"}) {
      BusRecording(folder / name).close();
    }
    write_text(folder / "notes.txt", "no recording");
    THEN("they are in the order of their numbers") {
      std::vector<std::string> names;
      for (const Path& file : mcap_files_in(folder.path())) names.push_back(file.filename().string());
      CHECK(names == std::vector<std::string>{"a1", "day_9.mcap", "day_10.mcap", "day_11.mcap.part"});
    }
    THEN("the folder counts as they do, and each file once") {
      CHECK(recording_files({folder.path()}).size() == 4);
      CHECK(recording_files({folder / "a1", folder.path()}).size() == 4);
      std::filesystem::create_symlink(folder / "a1", folder / "latest.mcap");
      CHECK(recording_files({folder.path()}).size() == 4);
      CHECK(is_in_mcap({folder.path()}));
      CHECK_FALSE(is_log_folder(folder.path()));
    }
    THEN("with the files of a log folder, it is one") {
      write_text(folder / "imu.csv", "");
      CHECK(is_log_folder(folder.path()));
      CHECK_FALSE(is_in_mcap({folder.path()}));
      CHECK_THROWS_WITH(recording_files({folder.path()}),
                        Contains("is a log folder") &&
                            Contains("sonopose-bridge --source log --input " + folder.path().string()));
    }
  }
  GIVEN("a folder without MCAP files") {
    THEN("it is no such recording") {
      CHECK(is_log_folder(folder.path()));
      CHECK_THROWS_WITH(recording_files({folder.path()}), Contains(": has no MCAP file"));
    }
  }
}

}  // namespace recording_files_test
