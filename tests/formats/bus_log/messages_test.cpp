#include "bus_log/messages.hpp"

#include <sonopose/dds/psm/cdr.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <catch2/catch.hpp>

#include <string>

namespace messages_test {

using namespace sonopose;
using Catch::Contains;
using Catch::EndsWith;

mcap::Message message_of(const std::string& text) {
  return {1, 1, 5, 5, std::as_bytes(std::span(text))};
}

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

TEST_CASE("JSON that is nested a million deep comes in hexadecimal digits") {
  const mcap::Channel channel{1, 0, "t", "json", {}};
  constexpr int depth = 1'000'000;
  const std::string open = GENERATE(std::string("["), std::string("{\"a\":"));
  const std::string close = open == "[" ? "]" : "}";
  const std::string text = repeated(open, depth) + "1" + repeated(close, depth);
  CHECK_THAT(bus_log::json_of(channel, message_of(text)), Contains(R"("data":")"));
  const std::string flat = R"({"a":[[1,{"b":2}],3]})";
  CHECK_THAT(bus_log::json_of(channel, message_of(flat)), EndsWith(R"("message":)" + flat + "}"));
}

TEST_CASE("a stationary beacon is of the map of all beacons, whatever its own address") {
  const mcap::Channel channel{1, 0, "sonopose/stationary_beacon", "cdr", {}};
  sonopose_StationaryBeacon beacon{};
  beacon.address = 7;
  const auto bytes = sonopose::dds::write_cdr(beacon);
  const mcap::Message message{1, 1, 5, 5, bytes};
  CHECK(bus_log::beacon_of(channel, message) == all_beacons);
}

TEST_CASE("the end of an instance has the beacon of its key") {
  const mcap::Channel channel{1, 0, "sonopose/instance_ends", "json", {}};
  const auto beacon_of_address = [&channel](const std::string& address) {
    const std::string text = R"({"topic":"sonopose/imu","key":{"address":)" + address + "}}";
    return bus_log::beacon_of(channel, message_of(text));
  };
  CHECK(beacon_of_address("7") == BeaconAddress{7});
  CHECK(beacon_of_address("65535") == BeaconAddress{65535});
  CHECK_FALSE(beacon_of_address("65543"));  // 7 in 16 bits
  CHECK_FALSE(beacon_of_address("-7"));
  CHECK_FALSE(beacon_of_address(repeated("[", 1'000'000) + repeated("]", 1'000'000)));
}

}  // namespace messages_test
