/// The relay started like a node by `ros2 launch`.

#include "support/ros2.hpp"
#include "support/ros2_graph.hpp"
#include "support/temporary_folder.hpp"

#include <string>

namespace sonopose::ros2_arguments_test {

using namespace sonopose::test;
namespace topics = dds::topics;

/// Temporary file that launch_ros writes for `parameters=[{…}]`.
const std::string launch_parameters = R"(/**:
  ros__parameters:
    use_sim_time: false
    map_frame: hall
    fix_message: point
    addresses: '7'
    delay: {processing_s: 0.07}
/other:
  ros__parameters:
    map_frame: elsewhere
)";

SCENARIO("ros2 launch starts the relay like any node") {
  GIVEN("a chain, and a relay with the arguments of a launch file") {
    const Bus bus;
    const TemporaryFolder folder;
    const auto file = folder / "parameters.yaml";
    write_text(file, launch_parameters);
    RosReader<ros2::Odometry> odom(bus, "/robot/way");
    RosReader<ros2::PointStamped> fix(bus, "/robot/hedge_7/fix");
    Consumer<sonopose_EffectiveSettings> settings(bus, topics::settings);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    const auto relay = bus.ros2({"--ros-args", "-r", "__node:=kart", "-r", "__ns:=/robot", "-r",
                                 "hedge_7/odom:=way", "-p", "beacon_7.delay.processing_s:=0.05",
                                 "--params-file", file.string(), "--log-level", "info", "--"});
    THEN("name, namespace, remapping and options apply") {
      CHECK(relay->wait_for_line(Stream::error, "relaying as /robot/kart"));
      std::string frame;
      REQUIRE(odom.wait_for_count(1, [&](const auto& message) { frame = message.header.frame_id; }));
      CHECK(frame == "hall");
      CHECK(fix.wait_for_count(1, [](const auto&) {}));
      CHECK(relay->text(Stream::error).find("is neither") == std::string::npos);
    }
    THEN("parameters with the name of a setting reach the fusion") {
      const auto has = [](const EffectiveSettings& one, const SettingAssignment& wanted) {
        return std::find(one.values.begin(), one.values.end(), wanted) != one.values.end();
      };
      CHECK(settings.wait_for([&](const EffectiveSettings& one) {
        return one.address == 7 && has(one, {"delay.processing_s", "0.05"});
      }));
      CHECK(settings.wait_for([&](const EffectiveSettings& one) {
        return one.address == all_beacons && has(one, {"delay.processing_s", "0.07"});
      }));
    }
  }
}

SCENARIO("parameters are values, not words of a command line") {
  GIVEN("a file with an empty text, a list with negative numbers, and a parameter of every node of Jazzy") {
    const Bus bus;
    const TemporaryFolder folder;
    const auto file = folder / "parameters.yaml";
    write_text(file, R"(/**:
  ros__parameters:
    beacon_namespace: ''
    addresses: 7
    mount: [0.1, 0, 0, 0, 0, -90.0]
    topics: [odom, fix]
    start_type_description_service: true
)");
    RosReader<ros2::Odometry> odom(bus, "/odom");
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    const auto relay = bus.ros2({"--ros-args", "--params-file", file.string(), "--"});
    THEN("the relay runs with them, without a warning") {
      CHECK(odom.wait_for_count(1, [](const auto&) {}));
      CHECK(relay->text(Stream::error).find("is neither") == std::string::npos);
    }
  }
}

Result refused(const Arguments& ros_arguments) {
  const TestDomain domain;
  Arguments arguments{"--domain", std::to_string(domain.id()), "--ros-args"};
  arguments.insert(arguments.end(), ros_arguments.begin(), ros_arguments.end());
  return run(SONOPOSE_TEST_ROS2, arguments, neutral);
}

TEST_CASE("The relay refuses invalid ROS 2 arguments and parameters, and names them") {
  const auto check_refused = [](const Arguments& arguments, const std::vector<std::string>& said) {
    const Result result = refused(arguments);
    CAPTURE(arguments, result.error);
    CHECK(result.code.value_or(0) > 0);
    for (const std::string& text : said) CHECK_THAT(result.error, Catch::Contains(text));
  };
  check_refused({"-p", "tf"}, {"-p tf: it must be NAME:=VALUE"});
  check_refused({"-p", "tf:=sideways"}, {"--tf", "'sideways'", "map_base, map_odom, off"});
  check_refused({"-p", "use_sim_time:=5"}, {"-p use_sim_time:=5", "must be true or false"});
  check_refused({"-p", "documented.trust.n_min:=-1"},
                {"-p documented.trust.n_min:=-1", "documented.trust.n_min"});
  check_refused({"-r", "__node:=a/b"}, {"--remap: remap rule '__node:=a/b'"});
  check_refused({"--tf", "off"}, {"--ros-args: --tf is unknown"});
}

SCENARIO("options of the command line have precedence over parameters, and unknown parameters are reported") {
  GIVEN("a relay with both") {
    const Bus bus;
    RosReader<ros2::Odometry> odom(bus, "/hedge_7/odom");
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    const auto relay = bus.ros2({"--map-frame", "mine", "--ros-args", "-p", "map_frame:=theirs", "-p",
                                 "mount:=[1, 0, 0, 0, 0, -90]", "-p", "robot_radius:=0.3", "--"});
    THEN("the option counts, and the relay runs") {
      std::string frame;
      REQUIRE(odom.wait_for_count(1, [&](const auto& message) { frame = message.header.frame_id; }));
      CHECK(frame == "mine");
      CHECK(relay->wait_for_line(Stream::error, "warning: -p robot_radius:=0.3: robot_radius is neither"));
    }
  }
}

}  // namespace sonopose::ros2_arguments_test
