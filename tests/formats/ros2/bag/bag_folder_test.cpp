/// Folders of rosbag2.

#include "ros2/bag/bag_folder.hpp"

#include "bus_log/recording_files.hpp"
#include "bus_log/sensor_log.hpp"
#include "ros2/bag/drives.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

namespace bag_folder_test {

using namespace sonopose;
using Catch::Contains;
using ros2::bag::read_metadata;
using test::write_text;

std::string metadata(const std::string& files, const std::string& mode = "") {
  return "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  relative_file_paths:\n" +
         files + "  compression_format: zstd\n  compression_mode: \"" + mode + "\"\n";
}

SCENARIO("the folder of a recording says what belongs to it") {
  const test::TemporaryFolder folder;
  const auto events = test::walk_events(2.0);
  GIVEN("two files that it lists, of which one is missing") {
    test::write_bag(folder / "drive_0.mcap", test::messages_of(events));
    write_text(folder / "metadata.yaml", metadata("    - drive_0.mcap\n    - drive/drive_1.mcap\n"));
    THEN("the missing one is named, and the other one is read") {
      REQUIRE(read_metadata(folder.path()).missing.size() == 1);
      CHECK_THAT(read_metadata(folder.path()).missing[0],
                 Contains("lacks drive/drive_1.mcap, which metadata.yaml lists"));
      CHECK(test::difference(bus_log::read_sensor_log(folder.path()).events, events) == "");
    }
  }
  GIVEN("a file that it does not list, and one in SQLite beside it") {
    test::write_bag(folder / "drive_0.mcap", test::messages_of(events));
    test::write_bag(folder / "other.mcap", test::messages_of(test::walk_events(1.0)));
    write_text(folder / "drive_0.db3", std::string("SQLite format 3\0", 16));
    THEN("what it lists is read") {
      write_text(folder / "metadata.yaml", metadata("    - drive_0.mcap\n"));
      CHECK(bus_log::recording_files({folder.path()}) == std::vector{folder / "drive_0.mcap"});
      CHECK(test::difference(bus_log::read_sensor_log(folder.path()).events, events) == "");
    }
    THEN("a listed file in SQLite counts for more than the others in MCAP") {
      write_text(folder / "metadata.yaml", metadata("    - drive_0.db3\n"));
      CHECK(bus_log::recording_files({folder.path()}) == std::vector{folder / "drive_0.db3"});
      CHECK(bus_log::is_in_sqlite({folder.path()}));
    }
  }
  GIVEN("a number of messages that the files do not have") {
    test::write_bag(folder / "drive_0.mcap", test::messages_of(events));
    write_text(folder / "metadata.yaml", metadata("    - drive_0.mcap\n  message_count: 1000000\n"));
    THEN("both numbers are named") {
      const auto text = bus_log::fewer_than_listed({folder.path()}, events.size());
      REQUIRE(text);
      CHECK_THAT(*text, Contains("of the 1000000 messages that metadata.yaml counts"));
      CHECK_FALSE(bus_log::fewer_than_listed({folder.path()}, 1'000'000));
    }
    THEN("one that is no number is an error with file, line and value") {
      write_text(folder / "metadata.yaml", metadata("    - drive_0.mcap\n  message_count: many\n"));
      CHECK_THROWS_WITH(read_metadata(folder.path()),
                        Contains("metadata.yaml, line 6: message_count: 'many' is no number"));
    }
  }
  GIVEN("files that are compressed as a whole") {
    write_text(folder / "drive_0.mcap.zstd", "(\xb5/\xfd");
    write_text(folder / "metadata.yaml", metadata("    - drive_0.mcap.zstd\n", "FILE"));
    THEN("the error says how to expand them") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(folder.path()),
                        Contains("drive_0.mcap.zstd: is compressed as a whole") && Contains("zstd -d "));
    }
    THEN("it says so without metadata too, and for one of the files") {
      std::filesystem::remove(folder / "metadata.yaml");
      CHECK_THROWS_WITH(bus_log::read_sensor_log(folder.path()), Contains("is compressed as a whole"));
      CHECK_THROWS_WITH(bus_log::read_sensor_log(folder / "drive_0.mcap.zstd"),
                        Contains("is compressed as a whole") && Contains("zstd -d "));
    }
    THEN("one that the metadata do not list is not left out silently") {
      write_text(folder / "metadata.yaml", metadata("    - drive_1.mcap\n"));
      test::write_bag(folder / "drive_1.mcap", test::messages_of(events));
      const auto unread = read_metadata(folder.path()).missing;
      REQUIRE(unread.size() == 1);
      CHECK_THAT(unread.front(), Contains("drive_0.mcap.zstd: is compressed") && Contains("not read"));
    }
    THEN("an empty file is said to be empty") {
      write_text(folder / "drive_1.db3", "");
      CHECK_THROWS_WITH(bus_log::read_sensor_log(folder / "drive_1.db3"), Contains("drive_1.db3: is empty"));
    }
    THEN("the expanded ones are read") {
      test::write_bag(folder / "drive_0.mcap", test::messages_of(events));
      CHECK(read_metadata(folder.path()).missing.empty());
      CHECK(test::difference(bus_log::read_sensor_log(folder.path()).events, events) == "");
    }
  }
  GIVEN("metadata that are no YAML") {
    write_text(folder / "metadata.yaml", "a: [\n");
    THEN("the error names the file and the line") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(folder.path()), Contains("metadata.yaml, line "));
    }
  }
  GIVEN("a log folder with a file of this name") {
    write_text(folder / "metadata.yaml", "a: 1\n");
    write_text(folder / "imu.csv", "");
    THEN("it stays a log folder") {
      CHECK_FALSE(ros2::bag::is_bag_folder(folder.path()));
    }
  }
}

}  // namespace bag_folder_test
