#include "web/foxglove/protocol.hpp"
#include "web/foxglove/requests.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <array>

namespace foxglove_test {

using namespace sonopose::web::foxglove;
using Catch::Contains;
using nlohmann::json;

std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) text += static_cast<char>(value);
  return text;
}

SCENARIO("the server's messages are those of the protocol") {
  const json info = json::parse(server_info("sonopose", "17"));
  CHECK(info["op"] == "serverInfo");
  CHECK(info["capabilities"] == json{"time"});
  CHECK(info["sessionId"] == "17");

  const std::array channels{Channel{.id = 3,
                                    .topic = "sonopose/pose",
                                    .encoding = "cdr",
                                    .schema_name = "sonopose::FusedPose",
                                    .schema = "module \"x\"",
                                    .schema_encoding = "omgidl"}};
  const json advertised = json::parse(advertise(channels));
  CHECK(advertised["op"] == "advertise");
  CHECK(advertised["channels"] == json::array({{{"id", 3},
                                                {"topic", "sonopose/pose"},
                                                {"encoding", "cdr"},
                                                {"schemaName", "sonopose::FusedPose"},
                                                {"schema", "module \"x\""},
                                                {"schemaEncoding", "omgidl"}}}));

  CHECK(json::parse(status(StatusLevel::error, "why")) ==
        json{{"op", "status"}, {"level", 2}, {"message", "why"}});
  CHECK_NOTHROW(json::parse(status(StatusLevel::info, "not UTF-8: \xff")));
}

SCENARIO("binary messages are little-endian") {
  CHECK(time(0x0102030405060708) == bytes({2, 8, 7, 6, 5, 4, 3, 2, 1}));
  const std::array payload{std::byte{0xAA}, std::byte{0}, std::byte{0xBB}};
  CHECK(message_data(0x01020304, 0x1122334455667788, payload) ==
        bytes({1, 4, 3, 2, 1, 0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11, 0xAA, 0, 0xBB}));
}

SCENARIO("a client subscribes and unsubscribes") {
  const auto subscribed = parse_request(
      R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":4294967295,"channelId":5}]})");
  REQUIRE(std::holds_alternative<Subscribe>(subscribed));
  const auto& items = std::get<Subscribe>(subscribed).items;
  REQUIRE(items.size() == 2);
  CHECK(items[0].id == 0);
  CHECK(items[0].channel_id == 3);
  CHECK(items[1].id == 4294967295);

  const auto unsubscribed = parse_request(R"({"op":"unsubscribe","subscriptionIds":[0,7]})");
  REQUIRE(std::holds_alternative<Unsubscribe>(unsubscribed));
  CHECK(std::get<Unsubscribe>(unsubscribed).ids == std::vector<SubscriptionId>{0, 7});
}

SCENARIO("what cannot be read is refused with the reason") {
  const auto reason_of = [](std::string_view text) {
    const auto request = parse_request(text);
    return std::holds_alternative<Refused>(request) ? std::get<Refused>(request).reason : "";
  };
  for (const char* const text : {"", "{", "[]", "1", "null", "{}", R"({"op":1})", "\xff\xff"}) {
    CAPTURE(text);
    CHECK_THAT(reason_of(text), Contains("JSON object with an op"));
  }
  CHECK_THAT(reason_of(R"({"op":"subscribe"})"), Contains("subscriptions"));
  CHECK_THAT(reason_of(R"({"op":"subscribe","subscriptions":{}})"), Contains("subscriptions"));
  for (const char* const id : {"-1", "4294967296", "1.5", "\"1\"", "null", "1e3", "18446744073709551616"}) {
    CAPTURE(id);
    CHECK_THAT(
        reason_of(R"({"op":"subscribe","subscriptions":[{"id":)" + std::string(id) + R"(,"channelId":1}]})"),
        Contains("32 bits"));
    CHECK_THAT(reason_of(R"({"op":"unsubscribe","subscriptionIds":[)" + std::string(id) + "]}"),
               Contains("32 bits"));
  }
  CHECK_THAT(reason_of(R"({"op":"advertise","channels":[]})"), Contains("'advertise' is not supported"));
}

}  // namespace foxglove_test
