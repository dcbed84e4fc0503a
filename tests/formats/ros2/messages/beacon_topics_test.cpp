#include <sonopose/ros2/messages/beacon_topics.hpp>

#include <catch2/catch.hpp>

#include <stdexcept>
#include <string>
#include <vector>

namespace beacon_topics_test {

using namespace sonopose::ros2;
using Catch::Contains;

NameResolver resolver(const std::vector<std::string>& rules = {}) {
  std::vector<RemapRule> parsed;
  for (const std::string& rule : rules) parsed.push_back(parse_remap_rule(rule));
  return NameResolver({}, parsed);
}

const std::string usual = "hedge_{address}";

TEST_CASE("A beacon's topics stand behind its prefix, and in the node's namespace where there is none") {
  CHECK(topic_prefix(usual, 7) == "hedge_7/");
  CHECK(topic_prefix("tag", 7) == "tag/");
  const NameResolver robot({.name_space = "/robot", .name = "locator"});
  CHECK(robot.topic(topic_prefix("", 7) + "odom") == "/robot/odom");
  CHECK(has_topics_per_beacon(usual));
  CHECK_FALSE(has_topics_per_beacon("tag"));
  CHECK_FALSE(has_topics_per_beacon(""));
}

TEST_CASE("A beacon namespace is refused where any beacon's topics would be none of ROS 2's") {
  struct Bad {
    std::string pattern;
    std::string why;
  };
  // Makes "/" + prefix + "/imu/data_raw" 247 characters long, the maximum.
  const std::string longest(233, 'n');
  for (const Bad& bad : std::vector<Bad>{{"bad ns", "contains ' '"},
                                         {"bad-{address}", "contains '-'"},
                                         {"{address}", "begin with a digit"},
                                         {"{adress}", "contains '{'"},
                                         {"hedge_{address}/", "two '/'"},
                                         {"/", "two '/'"},
                                         {longest + "n", "247"},
                                         {longest.substr(1) + "{address}", "247"}}) {
    CAPTURE(bad.pattern);
    CHECK_THROWS_AS(check_beacon_namespace(resolver(), bad.pattern), std::invalid_argument);
    CHECK_THROWS_WITH(check_beacon_namespace(resolver(), bad.pattern),
                      Contains("imu/data_raw") && Contains(bad.why));
  }
  for (const std::string& good : {usual, std::string(), longest, std::string("/hall/tag{address}"),
                                  std::string("~/tag{address}"), longest.substr(5) + "{address}"}) {
    CAPTURE(good);
    CHECK_NOTHROW(check_beacon_namespace(resolver(), good));
  }
}

TEST_CASE("Remap rules that give two topics the same name are rejected, for any beacon") {
  struct Bad {
    std::string rule;
    std::string pattern;
    std::string both;
  };
  for (const Bad& bad : std::vector<Bad>{{"/hedge_7/pose:=/hedge_7/odom", usual, "/hedge_7/odom"},
                                         {"/hedge_65534/pose:=/hedge_65534/fix", usual, "/hedge_65534/fix"},
                                         {"x1231/fix:=x1231/pose", "x1{address}", "/x1231/pose"},
                                         {"pose:=odom", "", "/odom"},
                                         {"hedge_7/odom:=/tf", usual, "/tf"},
                                         {"/tf_static:=/tf", usual, "/tf"}}) {
    CAPTURE(bad.rule);
    CHECK_THROWS_AS(check_outputs_differ(resolver({bad.rule}), bad.pattern), std::invalid_argument);
    CHECK_THROWS_WITH(check_outputs_differ(resolver({bad.rule}), bad.pattern),
                      Contains("the topic '" + bad.both + "'"));
  }
  using Rules = std::vector<std::string>;
  for (const Rules& good : {Rules{}, Rules{"/hedge_7/odom:=/odom"}, Rules{"/other/pose:=/hedge_7/odom"},
                            Rules{"/hedge_7/odom:=/hedge_7/pose", "/hedge_7/pose:=/hedge_7/odom"}}) {
    CHECK_NOTHROW(check_outputs_differ(resolver(good), usual));
  }
}

}  // namespace beacon_topics_test
