#include <sonopose/ros2/messages/names.hpp>

#include <catch2/catch.hpp>

#include <stdexcept>
#include <string>
#include <vector>

namespace names_test {

using namespace sonopose::ros2;

/// Resolver of a node /robot/locator with these rules.
NameResolver resolver(const std::vector<std::string>& rules = {}) {
  std::vector<RemapRule> parsed;
  for (const std::string& rule : rules) parsed.push_back(parse_remap_rule(rule));
  return NameResolver({.name_space = "/robot", .name = "locator"}, parsed);
}

TEST_CASE("Names stand in the namespace, below the node, or by themselves") {
  // Examples from design.ros2.org, "Topic and Service Names".
  CHECK(resolver().topic("ping") == "/robot/ping");
  CHECK(resolver().topic("ping/pong") == "/robot/ping/pong");
  CHECK(resolver().topic("/ping") == "/ping");
  CHECK(resolver().topic("~") == "/robot/locator");
  CHECK(resolver().topic("~/ping") == "/robot/locator/ping");
  const NameResolver in_root(NodeName{.name_space = "/", .name = "locator"});
  CHECK(in_root.topic("ping") == "/ping");
  CHECK(in_root.topic("~/ping") == "/locator/ping");
  CHECK(full_name(in_root.node()) == "/locator");
  CHECK(full_name(resolver().node()) == "/robot/locator");
  CHECK(name_in_dds("/hedge_7/odom") == "rt/hedge_7/odom");
}

TEST_CASE("A rule applies to the resolved name, in any notation") {
  for (const char* const rule : {"odom:=/car/odom", "/robot/odom:=/car/odom", "odom:=/car/odom"}) {
    CAPTURE(rule);
    CHECK(resolver({rule}).topic("odom") == "/car/odom");
    CHECK(resolver({rule}).topic("/robot/odom") == "/car/odom");
    CHECK(resolver({rule}).topic("/odom") == "/odom");
    CHECK(resolver({rule}).topic("odom/more") == "/robot/odom/more");
  }
  CHECK(resolver({"~/odom:=odom"}).topic("~/odom") == "/robot/odom");
  CHECK(resolver({"odom:=~/odom"}).topic("odom") == "/robot/locator/odom");
  SECTION("the first matching rule applies, and its result is not remapped again") {
    CHECK(resolver({"a:=b", "b:=c", "a:=d"}).topic("a") == "/robot/b");
  }
}

TEST_CASE("Rules rename the node, for one node or for all") {
  const NameResolver both = resolver({"__node:=kart", "__ns:=/hall/north"});
  CHECK(both.node() == NodeName{.name_space = "/hall/north", .name = "kart"});
  CHECK(both.topic("~/odom") == "/hall/north/kart/odom");
  CHECK(resolver({"__ns:=/"}).topic("odom") == "/odom");
  CHECK(resolver({"__name:=kart"}).node().name == "kart");
  CHECK(resolver({"other:odom:=car", "other:__ns:=/x"}).topic("odom") == "/robot/odom");
  CHECK(resolver({"locator:odom:=car"}).topic("odom") == "/robot/car");
  CHECK(resolver({"locator:__node:=kart", "odom:=~/odom"}).topic("odom") == "/robot/kart/odom");
}

TEST_CASE("Names that ROS 2 does not allow are rejected with name, reason and rule") {
  struct Bad {
    std::string name;
    std::string why;
  };
  const std::vector<Bad> bad_names{{"", "is empty"},
                                   {"/", "is empty"},
                                   {"a/", "ends with '/'"},
                                   {"a//b", "two '/'"},
                                   {"7a", "digit"},
                                   {"a/7", "digit"},
                                   {"a-b", "'-'"},
                                   {"a b", "' '"},
                                   {"a~b", "'~'"},
                                   {"/~/a", "'~'"},
                                   {"{node}/a", "'{'"},
                                   {"ä", "letters a-z"},
                                   {"/" + std::string(247, 'a'), "247"}};
  for (const Bad& bad : bad_names) {
    CAPTURE(bad.name);
    CHECK_THROWS_AS(resolver().topic(bad.name), std::invalid_argument);
    CHECK_THROWS_WITH(resolver().topic(bad.name), Catch::Contains(bad.name) && Catch::Contains(bad.why));
  }
  CHECK_NOTHROW(resolver().topic("/" + std::string(246, 'a')));
  CHECK_NOTHROW(resolver().topic("_a__b_/_9"));

  for (const char* const rule : {"a", "a=b", ":=b", "a:=", ":a:=b"}) {
    CAPTURE(rule);
    CHECK_THROWS_AS(parse_remap_rule(rule), std::invalid_argument);
    CHECK_THROWS_WITH(parse_remap_rule(rule), Catch::Contains(std::string("'") + rule + "'"));
  }
  for (const char* const rule : {"a:=b/", "1a:=b", "__node:=a/b", "__ns:=x", "__ns:=/x/", "__node:=9"}) {
    CAPTURE(rule);
    CHECK_THROWS_AS(resolver({rule}), std::invalid_argument);
    CHECK_THROWS_WITH(resolver({rule}), Catch::StartsWith(std::string("remap rule '") + rule + "'"));
  }
  CHECK_THROWS_WITH(NameResolver(NodeName{.name_space = "robot"}), Catch::Contains("namespace 'robot'"));
}

TEST_CASE("A node's name, its namespace and its enclave follow ROS's rules") {
  for (const char* const name : {"", "a b", "a/b", "/a", "7a", "{node}"}) {
    CAPTURE(name);
    CHECK_THROWS_WITH(check_node_name(name), Catch::StartsWith(std::string("node name '") + name + "'"));
  }
  CHECK_NOTHROW(check_node_name("_locator7"));
  CHECK_THROWS_AS(check_node_name(std::string(256, 'a')), std::invalid_argument);
  // Includes characters that would end the entry "enclave=…;" in a participant's user data.
  for (const char* const path : {"", "a", "/a/", "//a", "/a b", "/foo;bar", "/a=b", "foo;bar"}) {
    CAPTURE(path);
    CHECK_THROWS_WITH(check_enclave(path), Catch::StartsWith(std::string("enclave '") + path + "'"));
    CHECK_THROWS_WITH(check_namespace(path), Catch::StartsWith(std::string("namespace '") + path + "'"));
  }
  for (const char* const path : {"/", "/a", "/a/b_7"}) {
    CHECK_NOTHROW(check_enclave(path));
    CHECK_NOTHROW(check_namespace(path));
  }
}

TEST_CASE("Names of types in DDS are those of ROS 2 with other separators") {
  CHECK(type_name_in_ros("sensor_msgs::msg::dds_::Imu_") == "sensor_msgs/msg/Imu");
  CHECK(type_name_in_ros("std_srvs::srv::dds_::Trigger_Request_") == "std_srvs/srv/Trigger_Request");
  CHECK(type_name_in_ros("sonopose::FusedPose") == "sonopose::FusedPose");
}

}  // namespace names_test
