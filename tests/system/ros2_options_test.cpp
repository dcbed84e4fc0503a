/// The relay's command line and environment: invalid values are refused at startup. The message names the
/// option, the value and the allowed values.

#include "support/bus.hpp"

namespace ros2_options_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;

struct Wrong {
  Arguments arguments;
  std::vector<std::string> said;
  Environment environment = {};
};

/// Checks that the program refuses; runs it in a private domain in case it starts.
void check_refused(const char* program, const Wrong& wrong) {
  const TestDomain domain;
  Environment environment = neutral;
  environment["ROS_DOMAIN_ID"] = std::to_string(domain.id());
  for (const char* const range :
       {"ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS"}) {
    environment[range] = "";
  }
  for (const auto& [name, value] : wrong.environment) environment[name] = value;
  const Result result = run(program, wrong.arguments, environment);
  CAPTURE(wrong.arguments, result.error);
  CHECK(result.code.value_or(0) > 0);
  for (const std::string& text : wrong.said) CHECK_THAT(result.error, Contains(text));
}

void check_all_refused(const std::vector<Wrong>& all) {
  for (const Wrong& wrong : all) check_refused(SONOPOSE_TEST_ROS2, wrong);
}

TEST_CASE("The relay refuses names that ROS 2 does not allow") {
  const std::string many(228, 'n');
  check_all_refused(
      {{{"--name", "a b"}, {"--name: node name 'a b'", "' '"}},
       {{"--name", ""}, {"--name: node name ''", "empty"}},
       {{"--namespace", "robot"}, {"--namespace: namespace 'robot'", "begin with '/'"}},
       {{"--namespace", ""}, {"--namespace: namespace ''"}},
       {{"--enclave", ""}, {"--enclave: enclave ''", "begin with '/'"}},
       {{"--enclave", "foo;bar"}, {"--enclave: enclave 'foo;bar'"}},
       {{"--enclave", "/foo;bar"}, {"--enclave: enclave '/foo;bar'", "';'"}},
       {{"--remap", "odom"}, {"--remap: remap rule 'odom'", "from:=to"}},
       {{"--remap", "a:=b c"}, {"--remap: remap rule 'a:=b c'", "' '"}},
       {{"--remap", "__node:=a/b"}, {"--remap: remap rule '__node:=a/b'"}},
       {{"--remap", "/hedge_7/pose:=/hedge_7/odom"}, {"--remap: ", "the topic '/hedge_7/odom'"}},
       {{"--beacon-namespace", "bad ns", "--addresses", "7"}, {"--beacon-namespace 'bad ns'", "' '"}},
       {{"--beacon-namespace", "bad-{address}"}, {"--beacon-namespace 'bad-{address}'", "'-'"}},
       {{"--beacon-namespace", many + "{address}", "--namespace", "/robot"},
        {"--beacon-namespace '" + many, "247"}},
       {{"--beacon-namespace", "tag"}, {"--beacon-namespace 'tag'", "{address}", "--addresses"}},
       {{"--beacon-namespace", "", "--addresses", "7-8"}, {"--beacon-namespace ''", "{address}"}}});
}

TEST_CASE("The relay refuses invalid frames, mounts and numbers") {
  check_all_refused(
      {{{"--map-frame", "/map"}, {"--map-frame: ", "'/map'", "must not begin with a slash"}},
       {{"--base-frame", "map"}, {"--base-frame: ", "has the same name as the map frame"}},
       {{"--base-frame", "b7", "--imu-frame", "b{address}"}, {"--imu-frame: ", "'b7'", "beacon 7"}},
       {{"--mount", "0", "0", "nan", "0", "0", "0"}, {"--mount: z is nan", "1000 m"}},
       {{"--mount", "0", "-1001", "0", "0", "0", "0"}, {"--mount: y is -1001", "1000 m"}},
       {{"--mount", "0", "0", "0", "0", "0", "inf"}, {"--mount: yaw is inf", "360 deg"}},
       {{"--mount-from-tf", "--tf-static", "on"}, {"--mount-from-tf: ", "--tf-static on"}},
       {{"--mount-from-tf", "--mount", "1", "0", "0", "0", "0", "0"}, {"--mount-from-tf: ", "--mount has"}},
       {{"--set-pose-in", "/set_pose:SetPose=7", "--services", "off"}, {"--set-pose-in", "--services off"}},
       {{"--set-pose-in", "/set_pose:Pose=7"}, {"'Pose' is not PoseWithCovarianceStamped or SetPose"}},
       {{"--set-pose-in", "/set_pose:SetPose=7", "--set-pose-in", "set_pose:SetPose=8"},
        {"--set-pose-in /set_pose=7 and --set-pose-in /set_pose=8: one service"}},
       {{"--fix-in", "/tag=7", "--fix-in", "tag=7"}, {"beacon 7 can have only one source of fixes"}},
       {{"--imu-in", "imu", "--imu-in", "/im u=7"}, {"--imu-in imu: expected TOPIC=ADDRESS"}},
       {{"--imu-in", "/im u=7"}, {"--imu-in /im u=7: ", "' '"}},
       {{"--odom-in", "/odom//x=7"}, {"--odom-in /odom//x=7: "}},
       {{"--px4", "a b"}, {"--px4: namespace '/a b'", "' '"}},
       {{"--ardupilot", "/ap/"}, {"--ardupilot: namespace '/ap/'"}},
       {{"--ardupilot", "/"}, {"--ardupilot /", "/tf", "--tf off"}},
       {{"--px4", "/", "--north", "nan"}, {"--north: ", "nan"}},
       {{"--px4", "/", "--north", "361"}, {"--north: ", "361", "360"}},
       {{"--north", "90"}, {"--north needs --px4 or --ardupilot"}},
       {{"--px4", "/", "--ardupilot", "/ap"}, {"--ardupilot", "--px4"}},
       {{"--gyro-std", "0"}, {"--gyro-std: ", "0", "1000"}},
       {{"--tilt-std", "181"}, {"--tilt-std: ", "181", "180"}},
       {{"--max-beacons", "1001"}, {"--max-beacons", "1001", "1000"}},
       {{"--addresses", "x"}, {"--addresses: 'x'", "65534"}},
       {{"--addresses", "7-3"}, {"--addresses: ", "'7-3'", "write the lower address first"}},
       {{"--imu-in", "/imu"}, {"--imu-in /imu"}},
       {{"--fix-in", "/tag=70000"}, {"'70000' is not an address"}},
       {{"--fix-in", "/tag=7", "--imu-meaning", "mean"}, {"--imu-meaning only works with --imu-in"}}});
}

TEST_CASE("An option with a fixed set of values refuses others and lists them") {
  check_all_refused({{{"--tf", "foo"}, {"--tf: 'foo'", "map_base, map_odom, off"}},
                     {{"--tf", "1"}, {"--tf: '1'", "map_base, map_odom, off"}},
                     {{"--topics", "odom,foo"}, {"--topics: 'foo'", "imu/data_raw, imu/data, imu/mag, odom"}},
                     {{"--rate", "-1"}, {"--rate: ", "-1"}},
                     {{"--tf-static", "foo"}, {"--tf-static: 'foo'", "on, off"}},
                     {{"--services", "foo"}, {"--services: 'foo'", "auto, on, off"}},
                     {{"--fix-message", "foo"}, {"--fix-message: 'foo'", "pose, point"}},
                     {{"--fix-message", "0"}, {"--fix-message: '0'", "pose, point"}},
                     {{"--imu-meaning", "average"}, {"--imu-meaning: 'average'", "unknown, instant, mean"}},
                     {{"--ros-distro", "humbug"}, {"--ros-distro: 'humbug'", "humble, iron, jazzy"}},
                     {{"--ros-distro", "1"}, {"--ros-distro: '1'", "humble, iron, jazzy"}},
                     {{"--network", "foo"}, {"--network: 'foo'", "loopback, lan"}},
                     {{"--network", "1"}, {"--network: '1'", "loopback, lan"}}});
  check_refused(SONOPOSE_TEST_MONITOR, {{"--network", "1"}, {"--network: '1'", "loopback, lan"}});
  check_refused(SONOPOSE_TEST_REPLAY,
                {{"log", "--engine", "1"}, {"--engine: '1'", "documented, kalman, strapdown"}});
  check_refused(SONOPOSE_TEST_REPLAY, {{"log", "--engine", "strapdown", "--integration", "1"},
                                       {"--integration: '1'", "previous, mean"}});
}

TEST_CASE("The relay's help states its network and its inputs") {
  const Result help = run(SONOPOSE_TEST_ROS2, {"--help-all"}, neutral);
  CHECK(help.code == 0);
  CHECK_THAT(help.output,
             Contains("loopback|lan ") && Contains("default: from the environment variables of ROS 2)"));
  CHECK_THAT(help.output, Contains("loopback: only this machine; lan:"));
  CHECK_THAT(help.output, Contains("map_base|map_odom|off") && Contains("default: map_base)"));
  CHECK_THAT(help.output, Contains("pose|point") && Contains("default: pose)"));
  CHECK_THAT(run(SONOPOSE_TEST_MONITOR, {"--help-all"}, neutral).output,
             Contains("loopback|lan ") && Contains("default: loopback)"));
}

TEST_CASE("The relay refuses invalid environment variables and names them") {
  check_all_refused({{{}, {"ROS_STATIC_PEERS is 'a b'", "not an address"}, {{"ROS_STATIC_PEERS", "a b"}}},
                     {{}, {"ROS_LOCALHOST_ONLY is '2'", "0 or 1"}, {{"ROS_LOCALHOST_ONLY", "2"}}}});
}

SCENARIO("The relay runs with an unknown ROS 2 distribution") {
  GIVEN("a relay with an unknown ROS_DISTRO") {
    const TestDomain domain;
    Environment environment = neutral;
    environment["ROS_DISTRO"] = "lyrical";
    const Arguments arguments{"--network", "loopback", "--domain", std::to_string(domain.id())};
    THEN("it runs, and reports the unknown variable and the option that helps") {
      Process relay(SONOPOSE_TEST_ROS2, arguments, environment);
      CHECK(relay.wait_for_line(Stream::error, "relaying as"));
      const bool warned = relay.wait_for_line(Stream::error, "warning: ROS_DISTRO is 'lyrical'");
      CHECK(warned);
      if (warned) CHECK_THAT(relay.lines(Stream::error).front(), Contains("--ros-distro"));
    }
    THEN("with the option it reports nothing") {
      Arguments all = arguments;
      all.insert(all.end(), {"--ros-distro", "kilted"});
      Process relay(SONOPOSE_TEST_ROS2, all, environment);
      CHECK(relay.wait_for_line(Stream::error, "relaying as"));
      CHECK(relay.lines(Stream::error).size() == 1);
    }
  }
}

}  // namespace ros2_options_test
