/// meta.toml of a log folder: its effect on the samples, and refusals.

#include "recording/log_meta.hpp"

#include "recording/attitude_log.hpp"
#include "recording/log_folder.hpp"
#include "recording/log_writer.hpp"
#include "samples_at.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <string>

namespace log_meta_test {

using namespace sonopose;
using namespace sonopose::recording;
using Catch::Contains;
using sonopose::test::fix_at;
using sonopose::test::heading_at;
using sonopose::test::imu_at;
using sonopose::test::read_text;
using sonopose::test::TemporaryFolder;
using sonopose::test::write_text;

/// A folder with one sample of each kind and this meta.toml.
class Folder {
public:
  Folder() {
    write_text(folder_ / "imu.csv", "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n1,0,0,0,0,0,9.8\n");
    write_text(folder_ / "ultrasonic.csv", "#timestamp [ns],received [ns],x,y,z,quality\n1,2,0,0,0,90\n");
    write_text(folder_ / "heading.csv", "#timestamp [ns],received [ns],heading [deg]\n1,2,45\n");
    write_text(folder_ / "truth.csv", "#timestamp,p_x,p_y,p_z,q_w,q_x,q_y,q_z\n1,0,0,0,1,0,0,0\n");
  }
  explicit Folder(const std::string& meta) : Folder() { write_text(folder_ / "meta.toml", meta); }

  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }

private:
  TemporaryFolder folder_;
};

/// Error message of the readers, which must all give the same.
std::string refusal(const std::string& meta) {
  const Folder folder(meta);
  const auto said_by = [&folder](const auto& read) -> std::string {
    try {
      read(folder.path());
    } catch (const files::IoError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string said = said_by([](const auto& path) { read_sensor_log(path); });
  CHECK(said_by([](const auto& path) { read_imu_log(path); }) == said);
  CHECK(said_by([](const auto& path) { read_attitude_log(path); }) == said);
  return said;
}

SCENARIO("meta.toml says what the other files of a log do not") {
  GIVEN("a folder without the file") {
    const SensorLog log = read_sensor_log(Folder().path());
    THEN("the meaning is unknown and the address is the default") {
      CHECK(log.address == default_log_address);
      CHECK(std::get<ImuSample>(log.events.front()).meaning == ImuMeaning::unknown);
      for (const Event& event : log.events) CHECK(address_of(event) == default_log_address);
    }
  }
  GIVEN("a folder that names meaning and address") {
    const Folder folder("imu_meaning = \"mean\"\nbeacon_address = 65534\nprogram_version = \"0.1.0\"\n");
    THEN("every sample gets them") {
      const SensorLog log = read_sensor_log(folder.path());
      CHECK(log.address == 65534);
      REQUIRE(log.events.size() == 3);
      CHECK(std::get<ImuSample>(log.events.front()).meaning == ImuMeaning::mean_since_last);
      for (const Event& event : log.events) CHECK(address_of(event) == 65534);
      CHECK(log.truth.front().address == 65534);
      CHECK(read_imu_log(folder.path()).imu.front() == read_attitude_log(folder.path()).imu.front());
      CHECK(read_imu_log(folder.path()).imu.front().meaning == ImuMeaning::mean_since_last);
    }
    THEN("an address from the user replaces the log's") {
      const SensorLog log = read_sensor_log(folder.path(), 9);
      CHECK(log.address == 9);
      CHECK(address_of(log.events.front()) == 9);
    }
  }
  GIVEN("an empty file, and one with each word for the meaning") {
    THEN("they are read") {
      CHECK(read_log_meta(Folder("").path()) == LogMeta{});
      CHECK(read_log_meta(Folder("imu_meaning = 'unknown'").path()).imu_meaning == ImuMeaning::unknown);
      CHECK(read_log_meta(Folder("imu_meaning = 'instant'").path()).imu_meaning == ImuMeaning::instant);
    }
  }
}

TEST_CASE("a meta.toml with an error is refused with file, line, key, value and what is allowed") {
  CHECK_THAT(refusal("\nimu_meaning = \"average\""),
             Contains("/meta.toml:2: imu_meaning: \"average\" is not one of unknown, instant, mean"));
  CHECK_THAT(refusal("imu_meaning = 1"), Contains("imu_meaning: 1 is not one of unknown, instant, mean"));
  CHECK_THAT(refusal("beacon_address = 65535"),
             Contains("/meta.toml:1: beacon_address: 65535 is not a whole number from 0 to 65534"));
  CHECK_THAT(refusal("beacon_address = -1"), Contains("beacon_address: -1 is not a whole number"));
  CHECK_THAT(refusal("beacon_address = 7.0"), Contains("beacon_address: 7.0 is not a whole number"));
  CHECK_THAT(refusal("beacon_address = \"7\""), Contains("beacon_address: \"7\" is not a whole number"));
  CHECK_THAT(refusal("program_version = [1]"), Contains("program_version: this array is not a text"));
  CHECK_THAT(refusal("[imu]\nmeaning = \"mean\""),
             Contains("/meta.toml:2: imu.meaning: unknown key; the keys are imu_meaning, beacon_address, "
                      "program_version, settings.NAME"));
  CHECK_THAT(refusal("settings.seed = 3"), Contains("settings.seed: 3 is not a text"));
  CHECK_THAT(refusal("imu_meaning ="), Contains("/meta.toml:1: "));
}

SCENARIO("a recorder writes the meta.toml of its samples") {
  const TemporaryFolder folder;
  const auto meta = [&folder] { return read_log_meta(folder / "log"); };
  SensorLogWriter writer(folder / "log");
  ImuSample imu = imu_at(1, 12);
  imu.meaning = ImuMeaning::instant;
  THEN("without samples it has the version alone") {
    CHECK(meta() == LogMeta{.program_version = program_version()});
    CHECK_FALSE(program_version().empty());
  }
  WHEN("a fix comes first, and then IMU samples") {
    writer.write(fix_at(1, 12));
    CHECK(meta().beacon_address == 12);
    CHECK(meta().imu_meaning == ImuMeaning::unknown);
    writer.write(imu);
    THEN("address and meaning are there at once, without a flush") {
      CHECK(meta() == LogMeta{ImuMeaning::instant, 12, program_version(), {}});
      CHECK(read_text(folder / "log/meta.toml") ==
            "# What the other files of this folder do not say.\nimu_meaning = \"instant\"\n"
            "beacon_address = 12\nprogram_version = \"" +
                program_version() + "\"\n");
    }
  }
  WHEN("its source has settings") {
    const LogSettings settings{{"input", "a \"b\"\n\\c"}, {"source", "log"}};
    const SensorLogWriter set_writer(folder / "set", settings);
    THEN("they are read back") {
      CHECK(read_log_meta(folder / "set").settings == settings);
    }
  }
  WHEN("the meaning changes") {
    writer.write(imu);
    imu.meaning = ImuMeaning::mean_since_last;
    writer.write(imu);
    THEN("it is unknown, and stays so") {
      CHECK(meta().imu_meaning == ImuMeaning::unknown);
      writer.write(imu);
      CHECK(meta().imu_meaning == ImuMeaning::unknown);
    }
  }
  WHEN("another recorder is to use a folder that has only this file") {
    std::filesystem::create_directory(folder / "other");
    write_text(folder / "other/meta.toml", "imu_meaning = \"mean\"\n");
    THEN("it refuses, and the file is unchanged") {
      CHECK_THROWS_WITH(SensorLogWriter(folder / "other"), Contains("(meta.toml), which is not overwritten"));
      CHECK(meta().program_version == program_version());
      CHECK(read_log_meta(folder / "other").imu_meaning == ImuMeaning::mean_since_last);
    }
  }
}

SCENARIO("texts with quotes and line breaks are read as they were written") {
  const Folder folder;
  const std::string text = "a \"b\"\n\\c";
  const LogMeta meta{.program_version = text, .settings = {{"seed", text}}};
  write_log_meta(folder.path(), meta);
  CHECK(read_log_meta(folder.path()) == meta);
}

}  // namespace log_meta_test
