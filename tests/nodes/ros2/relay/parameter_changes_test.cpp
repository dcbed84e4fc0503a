#include "ros2/relay/parameter_changes.hpp"

#include "support/test_domain.hpp"
#include <sonopose/ros2/messages/borrow.hpp>

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace parameter_changes_test {

using namespace sonopose;
using namespace sonopose::ros2::relay;
using ros2::borrow_string;

/// A parameter that borrows `name`.
ros2::Parameter integer(const std::string& name, std::int64_t value) {
  static const std::string none;
  ros2::Parameter parameter{};
  parameter.name = borrow_string(name);
  parameter.value.type = 2;
  parameter.value.integer_value = value;
  parameter.value.string_value = borrow_string(none);
  return parameter;
}

SCENARIO("a request for parameters is bounded by names and bytes") {
  CHECK(excess_of(max_names, max_text_bytes).empty());
  CHECK(excess_of(1001, 1) == "the request has 1001 names, the limit is 1000");
  CHECK(excess_of(1, 262'145) ==
        "the names and values of the request have 262145 bytes, the limit is 262144");
  const std::string text(300'000, 'x');
  const std::string name = "a";
  std::vector<ros2::Parameter> parameters{integer(name, 1)};
  CHECK(excess_of(parameters).empty());
  parameters.front().value.string_value = borrow_string(text);
  CHECK_FALSE(excess_of(parameters).empty());
}

SCENARIO("changes of parameters end at the stop") {
  GIVEN("no fusion, and parameters of several beacons") {
    const test::TestDomain domain;
    settings_client::SettingsClient client({.domain_id = domain.id()}, {});
    ParameterChanges changes(client);
    std::vector<std::string> names;
    for (int i = 1; i <= 5; ++i) names.push_back("beacon_" + std::to_string(i) + ".documented.trust.n_min");
    std::vector<ros2::Parameter> parameters;
    for (const std::string& name : names) parameters.push_back(integer(name, 4));
    WHEN("the stop comes while the first one waits for the fusion") {
      int calls = 0;
      const auto errors = changes.set(parameters, [&calls] { return ++calls > 10; });
      THEN("none waits any longer") {
        CHECK(errors == std::vector<std::string>(5, "the relay ends"));
      }
    }
    WHEN("the stop came before") {
      THEN("nothing is changed") {
        CHECK(changes.set_atomically(parameters, [] { return true; }) == "the relay ends");
      }
    }
    WHEN("nobody replies") {
      THEN("each parameter has the reason") {
        const auto errors = changes.set(parameters, [] { return false; });
        CHECK(errors == std::vector<std::string>(5, "no fusion replied within 2 s"));
      }
    }
    WHEN("a name is too long to be compared with the others") {
      const std::string name(300, 'x');
      THEN("it is refused by its size") {
        const std::vector<ros2::Parameter> one{integer(name, 1)};
        CHECK_THAT(changes.set(one, [] { return false; }).front(),
                   Catch::Contains("the name has 300 bytes, the limit is 256"));
      }
    }
  }
}

}  // namespace parameter_changes_test
