#include "dds/dds_fixture.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace sonopose::dds::test::qos_overlay_test {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// A temporary file of a test.
class TemporaryFile {
public:
  TemporaryFile(const std::string& name, const std::string& content)
      : path(fs::temp_directory_path() / ("sonopose_" + std::to_string(getpid()) + "_" + name)) {
    std::ofstream(path) << content;
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { fs::remove(path); }
  const fs::path path;
};

/// A user's file with `content` from line 3, in the library of the project's profiles.
std::string user_file(const std::string& content) {
  return "<dds>\n<qos_library name=\"sonopose\">\n" + content + "\n</qos_library></dds>";
}

std::string history(const std::string& profile, int depth, const std::string& base = "") {
  const std::string policy =
      "<history><kind>KEEP_LAST_HISTORY_QOS</kind><depth>" + std::to_string(depth) + "</depth></history>";
  return "<qos_profile name=\"" + profile + "\"" + (base.empty() ? "" : " base_name=\"" + base + "\"") +
         "><datareader_qos>" + policy + "</datareader_qos></qos_profile>";
}

std::int32_t depth_of(const qos::Provider& qos, const std::string& profile) {
  return qos.datareader_qos(profile).policy<policy::History>()->depth();
}

qos::Provider overlaid(const std::string& content) {
  qos::Provider qos = project_qos();
  qos.merge(user_file(content), "user.xml");
  return qos;
}

TEST_CASE("The user's file is the requested one, otherwise the environment's, otherwise none") {
  const TemporaryFile a("a.xml", user_file(history("Imu", 701)));
  const TemporaryFile b("b.xml", user_file(history("Imu", 702)));
  {
    const Environment environment("SONOPOSE_QOS", b.path.c_str());
    CHECK(qos::overrides_file(a.path) == a.path);
    CHECK(qos::overrides_file() == b.path);
    CHECK(depth_of(qos::Provider(a.path), "sonopose::Imu") == 701);
    CHECK(depth_of(qos::Provider(), "sonopose::Imu") == 702);
  }
  for (const char* const none : {static_cast<const char*>(nullptr), ""}) {
    const Environment environment("SONOPOSE_QOS", none);
    CHECK(qos::overrides_file() == std::nullopt);
    CHECK(qos::project_file() == fs::path(SONOPOSE_SOURCE_DIR) / "qos/sonopose.xml");
    CHECK(depth_of(qos::Provider(), "sonopose::Imu") != 702);
  }
}

TEST_CASE("A requested QoS file that does not exist is an error, and is not replaced") {
  const Environment environment("SONOPOSE_QOS", "/nonexistent/env.xml");
  CHECK_THROWS_WITH(qos::Provider(), Catch::Contains("/nonexistent/env.xml: does not exist") &&
                                         Catch::Contains("SONOPOSE_QOS"));
  CHECK_THROWS_WITH(qos::Provider("/nonexistent/option.xml"),
                    Catch::Contains("/nonexistent/option.xml: does not exist"));
  CHECK_THROWS_AS(qos::Provider(fs::temp_directory_path()), qos::FileError);
}

TEST_CASE("Errors in a user's file name that file") {
  const TemporaryFile bad("bad.xml", "<dds>\n\n<oops/></dds>");
  CHECK_THROWS_WITH(qos::Provider(bad.path), bad.path.string() + ":3: <oops>: unknown element in <dds>");
}

SCENARIO("a user's file changes what it says and nothing else") {
  GIVEN("a file with the IMU reader's history alone") {
    const qos::Provider project = project_qos();
    const qos::Provider qos = overlaid(history("Imu", 700));
    THEN("that is changed") {
      CHECK(depth_of(qos, "sonopose::Imu") == 700);
    }
    THEN("the reader's other policies, and the writer, are the project's") {
      const Qos& reader = qos.datareader_qos("sonopose::Imu");
      CHECK(reader.policy<policy::Deadline>()->period() ==
            project.datareader_qos("sonopose::Imu").policy<policy::Deadline>()->period());
      CHECK(reader.policy<policy::Reliability>()->kind() == policy::ReliabilityKind::RELIABLE);
      CHECK(qos.datawriter_qos("sonopose::Imu").policy<policy::History>()->depth() ==
            project.datawriter_qos("sonopose::Imu").policy<policy::History>()->depth());
    }
    THEN("profiles that inherit from it in the project's file keep theirs") {
      for (const char* const heir : {"sonopose::Fix", "sonopose::Pose", "sonopose::Heading"}) {
        CHECK(depth_of(qos, heir) == depth_of(project, heir));
      }
    }
  }
}

TEST_CASE("base_name in a user's file merges a profile of the project over another one") {
  const qos::Provider qos = overlaid(R"(<qos_profile name="Report" base_name="Truth"/>)");
  CHECK(depth_of(qos, "sonopose::Report") == depth_of(project_qos(), "sonopose::Truth"));
}

TEST_CASE("base_name finds a profile of the user's file before the project's") {
  const qos::Provider qos =
      overlaid(history("Truth", 703) + R"(<qos_profile name="Report" base_name="Truth"/>)");
  CHECK(depth_of(qos, "sonopose::Report") == 703);
}

TEST_CASE(
    "A user's library may contain profiles to inherit from, which contribute only the policies that they "
    "set") {
  qos::Provider qos = project_qos();
  qos.merge("<dds><qos_library name=\"mine\">" + history("Deep", 704) +
                "</qos_library><qos_library name=\"sonopose\">"
                "<qos_profile name=\"Pose\" base_name=\"mine::Deep\"/></qos_library></dds>",
            "user.xml");
  CHECK(depth_of(qos, "sonopose::Pose") == 704);
  CHECK(qos.datareader_qos("sonopose::Pose").policy<policy::Ownership>()->kind() ==
        policy::OwnershipKind::EXCLUSIVE);
  CHECK_THROWS_AS(qos.datareader_qos("mine::Deep"), qos::FileError);
}

TEST_CASE("A copy of the project's whole file changes nothing") {
  const std::string copy = sonopose::test::read_text(qos::project_file());
  const qos::Provider project = project_qos();
  qos::Provider qos = project_qos();
  qos.merge(copy, "copy.xml");
  for (const std::string name : {"Imu", "Fix", "Pose", "Status", "Command", "LosslessReport"}) {
    CAPTURE(name);
    for (const auto member : {&qos::Provider::datawriter_qos, &qos::Provider::datareader_qos}) {
      CHECK(dds_qos_equal((qos.*member)("sonopose::" + name).get(),
                          (project.*member)("sonopose::" + name).get()));
    }
  }
}

TEST_CASE("A user's file with a contradiction is rejected and changes nothing") {
  struct Bad {
    std::string xml;
    const char* message;
  };
  const std::vector<Bad> cases{
      {user_file("\n" + history("Imuu", 3)),
       "user.xml:4: <qos_profile>: there is no profile 'sonopose::Imuu' to change; there are "
       "sonopose::Command, sonopose::Fix, "},
      {user_file("<qos_profile name='Pose' base_name='Posse'/>"),
       "user.xml:3: <qos_profile>: no profile 'sonopose::Posse' precedes it"},
      {user_file(history("Imu", 3) + "\n" + history("Imu", 3)),
       "user.xml:4: <qos_profile>: 'sonopose::Imu' occurs twice"},
      {user_file(history("Imu", 0)), "user.xml:3: <depth>: '0' is no whole number"},
      {"<dds><qos_library name='sonpose'>" + history("Imu", 3) + "</qos_library></dds>",
       "user.xml: changes no profile: no <qos_library> is called 'ros2' or 'sonopose'"},
      {user_file("<qos_profile name='Imu'><datareader_qos><resource_limits><max_samples_per_instance>8"
                 "</max_samples_per_instance></resource_limits></datareader_qos></qos_profile>"),
       "user.xml:3: <qos_profile>: the history is deeper than max_samples_per_instance"},
      {user_file("<qos_profile name='Imu'><datareader_qos><deadline><period><sec>0</sec><nanosec>50000000"
                 "</nanosec></period></deadline></datareader_qos></qos_profile>"),
       "user.xml:3: <qos_profile>: writer and reader of 'sonopose::Imu' would not match: deadline: offered "},
  };
  qos::Provider qos = project_qos();
  for (const Bad& bad : cases) {
    CAPTURE(bad.xml);
    CHECK_THROWS_WITH(qos.merge(bad.xml, "user.xml"), Catch::StartsWith(bad.message));
  }
  CHECK(depth_of(qos, "sonopose::Imu") == depth_of(project_qos(), "sonopose::Imu"));
}

TEST_CASE("A user's file is refused by its size before it is read") {
  const TemporaryFile file("huge.xml", user_file(history("Imu", 3)));
  fs::resize_file(file.path, 2'000'000);
  CHECK_THROWS_WITH(qos::Provider(file.path),
                    file.path.string() + ": has 2000000 bytes, the limit of a QoS file is 1048576");
}

TEST_CASE("A folder and a named pipe are no QoS files, and are not waited for") {
  const sonopose::test::TemporaryFolder folder;
  const fs::path pipe = folder / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);  // without a writer
  for (const fs::path& path : {folder.path(), pipe}) {
    CHECK_THROWS_WITH(qos::Provider(path), Catch::StartsWith(path.string() + ": is not a file"));
  }
}

}  // namespace sonopose::dds::test::qos_overlay_test
