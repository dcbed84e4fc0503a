/// Arguments that `ros2 run` and `ros2 launch` pass to every node.

#include "ros2/arguments/arguments.hpp"

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace arguments_test {

using namespace sonopose::ros2::arguments;
using Words = std::vector<std::string>;
using Catch::Contains;
using sonopose::logging::Level;

/// Node pattern, name and comma-separated values.
using Row = std::vector<std::string>;

std::vector<Row> rows(const std::vector<Parameter>& parameters) {
  std::vector<Row> all;
  for (const Parameter& parameter : parameters) {
    std::string values;
    for (const std::string& value : parameter.values) values += (values.empty() ? "" : ",") + value;
    all.push_back({parameter.node, parameter.name, values});
  }
  return all;
}

TEST_CASE("Arguments of ROS 2 are taken out of those of the program") {
  const Arguments found = split({"--tf",
                                 "off",
                                 "--ros-args",
                                 "-r",
                                 "__node:=kart",
                                 "--remap",
                                 "odom:=way",
                                 "-p",
                                 "tf:=off",
                                 "--log-level",
                                 "warn",
                                 "-e",
                                 "/x",
                                 "--disable-rosout-logs",
                                 "--disable-stdout-logs",
                                 "--",
                                 "--path",
                                 "5",
                                 "--ros-args",
                                 "--log-level",
                                 "kart:=DEBUG"});
  CHECK(found.own == Words{"--tf", "off", "--path", "5"});
  CHECK(found.remap == Words{"__node:=kart", "odom:=way"});
  CHECK(rows(found.parameters) == std::vector<Row>{{"/**", "tf", "off"}});
  CHECK(found.log_rules == std::vector<LogRule>{{"", Level::warning}, {"kart", Level::debug}});
  CHECK(found.enclave == "/x");
  CHECK_FALSE(found.rosout);
}

TEST_CASE("Without --ros-args all arguments are the program's") {
  const Words words{"-r", "a:=b", "--"};
  CHECK(split(words).own == words);
  CHECK(split({"--ros-args"}).own.empty());
}

TEST_CASE("Arguments that ROS 2 refuses are refused with the reason") {
  CHECK_THROWS_WITH(split({"--ros-args", "-p"}), Contains("-p") && Contains("value is missing"));
  CHECK_THROWS_WITH(split({"--ros-args", "--tf", "off"}), Contains("--tf is unknown") && Contains("before"));
  CHECK_THROWS_WITH(split({"--ros-args", "-p", "tf"}), Contains("-p tf: it must be NAME:=VALUE"));
  CHECK_THROWS_WITH(split({"--ros-args", "-p", ":=1"}), Contains("no name"));
  CHECK_THROWS_WITH(split({"--ros-args", "--log-level", "loud"}), Contains("debug, info, warn"));
  CHECK_THROWS_WITH(split({"--ros-args", "--params-file", "/no/file.yaml"}), Contains("/no/file.yaml"));
}

TEST_CASE("A single parameter has a YAML value, and may name its node") {
  CHECK(rows({parse_parameter("delay.processing_s:=0.07")}) ==
        std::vector<Row>{{"/**", "delay.processing_s", "0.07"}});
  CHECK(rows({parse_parameter("kart:mount:=[0.2, 0, -0.5, 0, 0, 90]")}) ==
        std::vector<Row>{{"/kart", "mount", "0.2,0,-0.5,0,0,90"}});
  CHECK(rows({parse_parameter("flag:=True")}) == std::vector<Row>{{"/**", "flag", "true"}});
  CHECK_THROWS_WITH(parse_parameter("a:=[1"), Contains("-p a:=[1"));
  for (const std::string text : {"a:=", "a:={b: 1}", "a:=[[1]]"}) {
    CHECK_THROWS_AS(parse_parameter(text), std::invalid_argument);
  }
}

TEST_CASE("A pattern selects nodes by the parts of their names") {
  CHECK(selects("/**", "/robot/kart"));
  CHECK(selects("/robot/*", "/robot/kart"));
  CHECK(selects("/**/kart", "/kart"));
  CHECK(selects("/**/kart", "/a/b/kart"));
  CHECK_FALSE(selects("/*", "/robot/kart"));
  CHECK_FALSE(selects("/kart", "/robot/kart"));
  CHECK_FALSE(selects("/robot/kart", "/robot"));
}

/// A parameter file with this content.
class File {
public:
  explicit File(const std::string& content) { std::ofstream(path()) << content; }
  [[nodiscard]] std::string path() const { return (folder_.path() / "robot.yaml").string(); }

private:
  sonopose::test::TemporaryFolder folder_;
};

TEST_CASE("A parameter file has nodes, namespaces, wildcards and nested names") {
  const File file(R"(
/**:
  ros__parameters:
    use_sim_time: false
    delay: {processing_s: 0.07, nested: {deep: "off"}}
robot:
  kart:
    ros__parameters:
      imu_in: [/imu/data=42, /other=43]
/robot/*: {ros__parameters: {tf: off}}
)");
  CHECK(rows(read_parameter_file(file.path())) ==
        std::vector<Row>{{"/**", "use_sim_time", "false"},
                         {"/**", "delay.processing_s", "0.07"},
                         {"/**", "delay.nested.deep", "off"},
                         {"/robot/kart", "imu_in", "/imu/data=42,/other=43"},
                         {"/robot/*", "tf", "off"}});
  CHECK(read_parameter_file(File("").path()).empty());
}

TEST_CASE("A parameter file that cannot be read is refused with file, line and reason") {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"a: [1", "line 1: end of sequence"},
      {"sonopose: 5", "line 1: expected node names"},
      {"ros__parameters: {a: 1}", "belongs below the name of a node"},
      {"/**:\n  ros__parameters: 7", "line 2: ros__parameters must contain names and values"},
      {"/**:\n  ros__parameters:\n    a: [[1]]", "line 3: a list may contain only single values"},
      {"/**:\n  ros__parameters:\n    a:", "a parameter needs a value"}};
  for (const auto& [content, reason] : wrong) {
    const File file(content);
    CAPTURE(content);
    CHECK_THROWS_WITH(read_parameter_file(file.path()), Contains(file.path()) && Contains(reason));
  }
}

}  // namespace arguments_test
