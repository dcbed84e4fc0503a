/// Recordings of rosbag2 in SQLite.

#include "bus_log/sensor_log.hpp"
#include "evaluation/report/exported.hpp"
#include "mcap/reader.hpp"
#include "ros2/bag/drives.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <iostream>
#ifdef SONOPOSE_HAS_SQLITE
#include <sqlite3.h>
#endif

namespace sqlite_storage_test {

using namespace sonopose;
using Catch::Contains;
using sonopose::test::RosMessage;
using sonopose::test::TemporaryFolder;

#ifdef SONOPOSE_HAS_SQLITE

/// Writes the tables of rosbag2 that a reader needs.
void write_db3(const std::filesystem::path& file, const std::vector<RosMessage>& messages) {
  sqlite3* database = nullptr;
  REQUIRE(sqlite3_open(file.c_str(), &database) == SQLITE_OK);
  const auto execute = [database](const char* sql) {
    REQUIRE(sqlite3_exec(database, sql, nullptr, nullptr, nullptr) == SQLITE_OK);
  };
  execute(
      "PRAGMA journal_mode=WAL;"
      "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
      " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,"
      " data BLOB NOT NULL);"
      "BEGIN");
  sqlite3_stmt* topic = nullptr;
  sqlite3_stmt* row = nullptr;
  sqlite3_prepare_v2(database, "INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')", -1, &topic, nullptr);
  sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", -1, &row,
                     nullptr);
  std::map<std::string, int> ids;
  for (const RosMessage& message : messages) {
    const auto [id, is_new] = ids.try_emplace(message.topic, static_cast<int>(ids.size()) + 1);
    if (is_new) {
      sqlite3_bind_int(topic, 1, id->second);
      sqlite3_bind_text(topic, 2, message.topic.c_str(), -1, SQLITE_TRANSIENT);
      sqlite3_bind_text(topic, 3, message.type.c_str(), -1, SQLITE_TRANSIENT);
      REQUIRE(sqlite3_step(topic) == SQLITE_DONE);
      sqlite3_reset(topic);
    }
    sqlite3_bind_int(row, 1, id->second);
    sqlite3_bind_int64(row, 2, message.received_ns);
    sqlite3_bind_blob(row, 3, message.data.data(), static_cast<int>(message.data.size()), SQLITE_TRANSIENT);
    REQUIRE(sqlite3_step(row) == SQLITE_DONE);
    sqlite3_reset(row);
  }
  sqlite3_finalize(topic);
  sqlite3_finalize(row);
  execute("COMMIT");
  sqlite3_close(database);
}

SCENARIO("a recording of rosbag2 in SQLite is an input") {
  const TemporaryFolder folder;
  GIVEN("a drive in two files of a folder, whose name has special characters") {
    const auto bag = folder / "a drive?#50%";
    std::filesystem::create_directories(bag);
    const auto events = test::walk_events(4.0);
    const auto messages = test::messages_of(events);
    const auto half = messages.begin() + static_cast<std::ptrdiff_t>(messages.size() / 2);
    write_db3(bag / "drive_9.db3", {messages.begin(), half});
    write_db3(bag / "drive_10.db3", {half, messages.end()});
    THEN("the folder has all events, and each file its own") {
      CHECK(test::difference(bus_log::read_sensor_log(bag).events, events) == "");
      CHECK(bus_log::read_sensor_log(bag / "drive_9.db3").events.size() == messages.size() / 2);
      CHECK(test::difference(bus_log::read_sensor_log({bag / "drive_9.db3", bag / "drive_10.db3"}).events,
                             events)
                .empty());
      CHECK(bus_log::read_imu_log(bag).size() == 400);
    }
    THEN("files in another order than their messages are read by time") {
      CHECK(test::difference(bus_log::read_sensor_log({bag / "drive_10.db3", bag / "drive_9.db3"}).events,
                             events)
                .empty());
    }
    THEN("messages of an unknown topic are counted") {
      sqlite3* database = nullptr;
      REQUIRE(sqlite3_open((bag / "drive_9.db3").c_str(), &database) == SQLITE_OK);
      sqlite3_exec(database, "UPDATE messages SET topic_id = 77 WHERE id < 4", nullptr, nullptr, nullptr);
      sqlite3_close(database);
      const auto warnings = bus_log::read_sensor_log(bag).warnings;
      REQUIRE_FALSE(warnings.empty());
      CHECK_THAT(warnings.front(), Contains("drive_9.db3: 3 messages not read: the table of topics lacks"));
    }
    THEN("it is exported, and a reader of MCAP names its format") {
      const auto exported = evaluation::export_recording({bag}, {}, folder / "log");
      CHECK(exported.events == events.size());
      CHECK_THROWS_WITH(mcap::Reader(std::vector{bag / "drive_9.db3"}), Contains("is in SQLite"));
    }
    THEN("nothing is written beside the files") {
      bus_log::read_sensor_log(bag);
      const std::filesystem::directory_iterator files(bag);
      CHECK(std::distance(begin(files), end(files)) == 2);
    }
  }
  GIVEN("messages in another order than they were received in") {
    const auto events = test::walk_events(1.0);
    auto messages = test::messages_of(events);
    std::ranges::reverse(messages);
    write_db3(folder / "drive.db3", messages);
    THEN("they are read by time") {
      CHECK(test::difference(bus_log::read_sensor_log(folder / "drive.db3").events, events) == "");
    }
  }
}

SCENARIO("files of SQLite that are no such recording") {
  const TemporaryFolder folder;
  const auto file = folder / "drive.db3";
  GIVEN("a file that is cut") {
    write_db3(file, test::messages_of(test::walk_events(4.0)));
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    THEN("the error names the file and the reason of SQLite") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file), Contains("drive.db3: ") && Contains("malformed"));
    }
  }
  GIVEN("other tables, or views in the place of tables") {
    sqlite3* database = nullptr;
    sqlite3_open(file.c_str(), &database);
    const bool has_view = GENERATE(false, true);
    sqlite3_exec(
        database,
        has_view
            ? "CREATE VIEW topics AS SELECT 1 AS id, 'a' AS name, 'b' AS type, 'cdr' AS serialization_format"
            : "CREATE TABLE other(id INTEGER)",
        nullptr, nullptr, nullptr);
    sqlite3_close(database);
    THEN("the error names the file") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file), Contains("drive.db3: ") && Contains("topics"));
    }
  }
}

#else

TEST_CASE("a recording of rosbag2 in SQLite is an input") {
  std::cout << "skipped: built without SQLite; install libsqlite3-dev (scripts/setup build)\n";
}

#endif

}  // namespace sqlite_storage_test
