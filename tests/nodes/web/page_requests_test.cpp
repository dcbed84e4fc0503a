#include "web/page_requests.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace page_requests_test {

using namespace sonopose;
using namespace sonopose::web;
using Catch::Contains;

SCENARIO("a page asks for changes, resets and examinations") {
  const auto change = parse_page_request(
      R"({"op":"change","id":5,"address":7,"assignments":{"documented.drift.jump_alpha":"0.5","fusion.engine":"kalman"}})");
  REQUIRE(std::holds_alternative<ChangeRequest>(change));
  CHECK(std::get<ChangeRequest>(change).id == 5);
  CHECK_FALSE(std::get<ChangeRequest>(change).is_reset);
  CHECK(std::get<ChangeRequest>(change).settings.address == 7);
  CHECK(std::get<ChangeRequest>(change).settings.assignments ==
        std::vector<SettingAssignment>{{"documented.drift.jump_alpha", "0.5"}, {"fusion.engine", "kalman"}});

  const auto reset = parse_page_request(R"({"op":"reset","id":6,"address":"all"})");
  REQUIRE(std::holds_alternative<ChangeRequest>(reset));
  CHECK(std::get<ChangeRequest>(reset).is_reset);
  CHECK(std::get<ChangeRequest>(reset).settings.address == all_beacons);

  const auto examine = parse_page_request(R"({"op":"examine","seconds":3.5})");
  REQUIRE(std::holds_alternative<ExamineRequest>(examine));
  CHECK(std::get<ExamineRequest>(examine).seconds == 3.5);
}

SCENARIO("what a page must not ask is refused with the reason and its id") {
  const auto refusal_of = [](const std::string& text) {
    const auto request = parse_page_request(text);
    return std::holds_alternative<RefusedRequest>(request) ? std::get<RefusedRequest>(request)
                                                           : RefusedRequest{0, "accepted"};
  };
  for (const char* const text : {"", "{", "[1]", "{}", R"({"op":7})", "\xff"}) {
    CAPTURE(text);
    CHECK_THAT(refusal_of(text).reason, Contains("JSON object"));
  }
  CHECK(refusal_of(R"({"op":"dance","id":9})").id == 9);
  CHECK_THAT(refusal_of(R"({"op":"dance","id":9})").reason, Contains("'dance'"));
  for (const char* const address : {"-1", "65535", "65536", "1.5", "\"7\"", "null", "[7]"}) {
    CAPTURE(address);
    const std::string text = R"({"op":"reset","id":2,"address":)" + std::string(address) + "}";
    CHECK_THAT(refusal_of(text).reason, Contains("address"));
  }
  for (const char* const assignments : {"{}", "[]", "1", "null"}) {
    CAPTURE(assignments);
    const std::string text =
        R"({"op":"change","id":2,"address":7,"assignments":)" + std::string(assignments) + "}";
    CHECK_THAT(refusal_of(text).reason, Contains("assignments"));
  }
  CHECK_THAT(refusal_of(R"({"op":"change","id":2,"address":7,"assignments":{"a.b":1}})").reason,
             Contains("a.b") && Contains("not a text"));
  for (const char* const seconds : {"0", "121", "-1", "\"8\"", "1e400"}) {
    CAPTURE(seconds);
    CHECK(refusal_of(R"({"op":"examine","seconds":)" + std::string(seconds) + "}").reason != "accepted");
  }
}

}  // namespace page_requests_test
