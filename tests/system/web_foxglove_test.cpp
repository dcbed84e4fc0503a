/// Foxglove's protocol as served by the program sonopose-web.

#include "support/bus.hpp"
#include "web_process.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <map>
#include <sstream>
#include <vector>

namespace web_foxglove_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
using Catch::StartsWith;
using nlohmann::json;

SCENARIO("a page elsewhere may use Foxglove's protocol, but not change settings") {
  const Bus bus;
  Web web(bus, {"--listen", "127.0.0.1:0", "--allow-changes", "--allow-origin", "https://app.example.com/"});
  const std::string allowed = "Origin: https://app.example.com\r\n";
  Page foxglove(web, "/", "foxglove.sdk.v1", allowed);
  foxglove.wait_for("serverInfo");
  const auto refused = [&web](const std::string& protocol, const std::string& origin) {
    HttpSocket socket(web.port());
    socket.send(upgrade_request("/ws", protocol, web.host_line() + origin));
    return socket.read_all();
  };
  CHECK_THAT(refused("sonopose.v1", allowed), StartsWith("HTTP/1.1 400 ") && Contains("sonopose.v1"));
  CHECK_THAT(refused("foxglove.sdk.v1", "Origin: https://other.example.com\r\n"),
             StartsWith("HTTP/1.1 403 "));
  CHECK(web.process().wait_for_line(Stream::error, "--allow-origin https://other.example.com"));
}

SCENARIO("a client of Foxglove's protocol receives what it subscribes to") {
  const Bus bus;
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--source", "sim"});
  const Web web(bus, {"--listen", "127.0.0.1:0"});
  Page client(web, "/", "foxglove.websocket.v1");
  CHECK(client.wait_for("serverInfo")["capabilities"] == json{"time"});
  std::map<std::string, json> channels;
  const json advertised = client.wait_for("advertise");
  for (const json& channel : advertised["channels"]) channels[channel["topic"]] = channel;
  REQUIRE(channels.count("sonopose/pose") == 1);
  const json& pose = channels["sonopose/pose"];
  CHECK(pose["encoding"] == "cdr");
  CHECK(pose["schemaEncoding"] == "omgidl");
  constexpr int subscription = 0x01020304;
  // Head of a message: its kind, then the subscription in little-endian order.
  const std::string head{"\x01\x04\x03\x02\x01", 5};
  const auto next_status = [&client] {
    while (true) {
      const std::string text = client.next();
      if (text.starts_with("{")) return json::parse(text)["message"].get<std::string>();
    }
  };
  const auto subscribe = [&](int id, const json& channel) {
    client.send({{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel}}}}});
  };
  subscribe(subscription, pose["id"]);
  for (int messages = 0; messages < 20;) {
    const std::string message = client.next();
    if (!message.starts_with(head)) continue;  // other messages, such as the time
    CHECK(message.size() > 100);
    ++messages;
  }
  subscribe(subscription, channels["sonopose/report"]["id"]);
  CHECK_THAT(next_status(), Contains("exists already"));
  subscribe(5, pose["id"]);
  CHECK_THAT(next_status(), Contains("has a subscription already"));
  subscribe(6, 99999);
  CHECK_THAT(next_status(), Contains("no channel 99999"));
  client.send({{"op", "unsubscribe"}, {"subscriptionIds", {subscription}}});
  client.send({{"op", "unsubscribe"}, {"subscriptionIds", {subscription}}});
  CHECK_THAT(next_status(), Contains("no subscription"));
  for (int times = 0; times < 2;) {  // two seconds without a pose
    const std::string message = client.next();
    CHECK_FALSE(message.starts_with(head));
    if (message.starts_with("\x02")) ++times;
  }
}

SCENARIO("a client of Foxglove that is not ours decodes the poses") {
  const Result has_packages =
      run("/usr/bin/env", {"node", "-e",
                           "require('@foxglove/ws-protocol'); require('@foxglove/omgidl-parser'); "
                           "require('@foxglove/omgidl-serialization'); require('ws')"});
  if (has_packages.code != 0) {
    std::cout << "skipped: no node with Foxglove's packages; npm install @foxglove/ws-protocol "
                 "@foxglove/omgidl-parser @foxglove/omgidl-serialization ws, and set "
                 "NODE_PATH=$PWD/node_modules\n";
    return;
  }
  const Bus bus;
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--source", "sim"});
  const Web web(bus, {"--listen", "127.0.0.1:0"});
  for (const std::string protocol : {"foxglove.sdk.v1", "foxglove.websocket.v1"}) {
    CAPTURE(protocol);
    const Result client = run(
        "/usr/bin/env",
        {"node", (std::filesystem::path(SONOPOSE_SOURCE_DIR) / "tests/interop/foxglove_client.cjs").string(),
         "ws://" + web.host(), protocol});
    CAPTURE(client.error);
    REQUIRE(client.code == 0);
    std::istringstream lines(client.output);
    std::string line;
    std::map<std::string, std::vector<json>> by_kind;
    while (std::getline(lines, line)) {
      const json read = json::parse(line);
      by_kind[read["kind"]].push_back(read);
    }
    CHECK(by_kind["info"].at(0)["protocol"] == protocol);
    CHECK(by_kind["info"].at(0)["capabilities"] == json{"time"});
    CHECK_THAT(by_kind["status"].at(0)["message"].get<std::string>(), Contains("99999"));
    double latest_s = 0;
    for (const json& each : by_kind["message"]) {
      if (each["topic"] != "sonopose/pose") continue;
      const json& pose = each["message"];
      CHECK(pose["address"] == 7);
      CHECK(std::hypot(pose["orientation"]["w"].get<double>(), pose["orientation"]["x"].get<double>(),
                       std::hypot(pose["orientation"]["y"].get<double>(),
                                  pose["orientation"]["z"].get<double>())) == Approx(1.0));
      latest_s = std::stod(each["timestamp"].get<std::string>()) * 1e-9;
    }
    CHECK(by_kind["message"].size() >= 11);  // includes the settings
    CHECK(latest_s == Approx(static_cast<double>(std::time(nullptr))).margin(300));
    CHECK(by_kind["end"].at(0)["posesAfterwards"].get<int>() < 50);  // poses in transit; 2 s would be 200
  }
}

}  // namespace web_foxglove_test
