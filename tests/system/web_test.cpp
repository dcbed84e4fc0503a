/// The program sonopose-web on a bus with the other programs.

#include "bus_log/recorded.hpp"
#include "sim/simulator.hpp"
#include "support/bus.hpp"
#include "support/matches.hpp"
#include "support/temporary_folder.hpp"
#include "support/wait_until.hpp"
#include "web_process.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <csignal>

namespace web_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
using Catch::StartsWith;
using nlohmann::json;
using Path = std::filesystem::path;

/// Distance between the positions in a frame's arrays, m.
double distance(const json& pose, const json& truth) {
  const auto difference = [&](std::size_t i) { return pose[i].get<double>() - truth[i].get<double>(); };
  return std::hypot(difference(1), difference(2), difference(3));
}

const json change{
    {"op", "change"}, {"id", 5}, {"address", 7}, {"assignments", {{"outage.stale_after_s", "1.5"}}}};

/// Reply to a request, which is sent again while a busy fusion is too slow for the answer.
json answer_to(Page& page, const json& request) {
  json reply;
  REQUIRE(wait_until([&] {
    page.send(request);
    reply = page.wait_for("reply");
    return reply.dump().find("no fusion answered") == std::string::npos;
  }));
  return reply;
}

SCENARIO("two pages see the poses near the truth") {
  const Bus bus;
  const Web web(bus, {"--listen", "127.0.0.1:0"});
  Page page(web);
  Page other(web);
  const json hello = page.wait_for("hello");
  CHECK(hello["mode"] == "live");
  CHECK(hello["allow_changes"] == false);
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--source", "sim", "--scenario", "walk", "--beacons", "2"});
  const auto is_settled = [](const json& frame) {
    // A frame's poses are within a few milliseconds of its truth; a walker moves 1 mm per millisecond.
    return frame["beacons"].size() == 2 &&
           std::all_of(frame["beacons"].begin(), frame["beacons"].end(), [](const json& beacon) {
             if (!beacon.contains("pose") || !beacon.contains("truth")) return false;
             const json& pose = beacon["pose"];
             if (pose[1].is_null()) return false;  // before the first fix
             return distance(pose, beacon["truth"]) < 0.1;
           });
  };
  page.wait_for("frame", is_settled);
  other.wait_for("frame", is_settled);
  WHEN("a page asks for a change of a setting") {
    page.send(change);
    THEN("it is refused with the option that allows it") {
      const json reply = page.wait_for("reply");
      CHECK(reply["id"] == 5);
      CHECK(reply["accepted"] == false);
      CHECK_THAT(reply["reason"].get<std::string>(), Contains("--allow-changes"));
    }
  }
}

SCENARIO("a page that may changes a setting, and every page sees it") {
  const Bus bus;
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--source", "sim"});
  const Web web(bus, {"--listen", "127.0.0.1:0", "--allow-changes"});
  Page page(web);
  Page other(web);
  CHECK(page.wait_for("hello")["allow_changes"] == true);
  page.wait_for("settings", [](const json& settings) { return settings["address"] == 7; });
  const json reply = answer_to(page, change);
  CAPTURE(reply);
  CHECK(reply["accepted"] == true);
  other.wait_for("settings", [](const json& settings) {
    return settings["address"] == 7 && settings["values"]["outage.stale_after_s"] == "1.5";
  });
  json wrong = change;
  wrong["assignments"] = {{"outage.stale_after_s", "-1"}};
  const json refused = answer_to(page, wrong);
  CHECK(refused["accepted"] == false);
  CHECK_THAT(refused.dump(), Contains("outage.stale_after_s"));
}

SCENARIO("other machines need the token that the program prints") {
  const Bus bus;
  Web web(bus, {"--listen", "0.0.0.0:0"});
  REQUIRE(web.token().size() >= 32);
  CHECK_THAT(web.process().text(Stream::error), !Contains(web.token()));
  for (const char* const secret :
       {"/ws", "/settings.json", "/map.json", "/status.json", "/floor-plan", "/x"}) {
    CAPTURE(secret);
    CHECK_THAT(web.get(secret), StartsWith("HTTP/1.1 401 "));
  }
  CHECK_THAT(web.get("/map.json?token=" + web.token()), StartsWith("HTTP/1.1 200 "));
  // A browser requests the page's parts without the token.
  const std::string page = web.get("/?token=" + web.token());
  CHECK_THAT(page, StartsWith("HTTP/1.1 200 ") && Contains("<title>"));
  const auto links = all_matches(page, R"re((?:src|href)="([^":]+)")re");
  for (const auto& link : links) {
    CAPTURE(link[1]);
    CHECK_THAT(web.get("/" + link[1]), StartsWith("HTTP/1.1 200 "));
  }
  CHECK(links.size() >= 12);
  WHEN("another one listens on the same port") {
    const Result second = run(SONOPOSE_TEST_WEB, {"--listen", web.host()});
    THEN("it fails with the address and the option") {
      CHECK(second.code == 1);
      CHECK_THAT(second.error, Contains(web.host()) && Contains("--listen"));
    }
  }
  CHECK(web.process().end_by(SIGTERM).code == 0);
}

SCENARIO("a recording is served without a bus") {
  const TemporaryFolder folder;
  const Path file = folder / "run.mcap";
  {
    BusRecording recording(file);
    for (const Event& event : sim::record(sim::find_scenario("walk"), {.duration_s = 10.0}).events) {
      recording.write(event, static_cast<std::uint64_t>(available_at_ns(event)));
    }
  }
  const Web web({file.string(), "--listen", "127.0.0.1:0"});
  Page page(web);
  const json hello = page.wait_for("hello");
  CHECK(hello["mode"] == "recording");
  CHECK(hello["title"] == file.string());
  const std::string reply = web.get("/recording.json");
  CHECK_THAT(reply, StartsWith("HTTP/1.1 200 "));
  const json recording = json::parse(reply.substr(reply.find("\r\n\r\n") + 4));
  CHECK(recording["beacons"][0]["poses"]["t"].size() > 100);
}

SCENARIO("wrong options of the web process are named") {
  const auto fails = [](const Arguments& arguments, const std::string& named, const std::string& why) {
    CAPTURE(arguments);
    const Result result = run(SONOPOSE_TEST_WEB, arguments);
    REQUIRE(result.code);  // not killed
    CHECK(*result.code != 0);
    CHECK_THAT(result.error, Contains(named) && Contains(why));
  };
  fails({"--listen", "nowhere"}, "'nowhere'", "127.0.0.1:8080");
  fails({"--listen", "127.0.0.1:99999"}, "'127.0.0.1:99999'", "65535");
  fails({"--geofence", "/nonexistent.csv"}, "/nonexistent.csv", "does not exist");
  fails({"--floor-plan", "/nonexistent.png", "--floor-plan-area", "0", "0", "1", "1"}, "/nonexistent.png",
        "does not exist");
  fails({"--floor-plan-area", "0", "0", "1", "1"}, "--floor-plan-area", "requires --floor-plan");
  fails({"--max-clients", "0"}, "--max-clients", "1000");
  fails({"/nonexistent.mcap"}, "/nonexistent.mcap", "does not exist");
  fails({"--beacon", "7"}, "--beacon", "requires recording");
  fails({"--token", "short"}, "token", "16");
  fails({"--token", "0123456789abcdef&x"}, "token", "A-Z");
  fails({"--allow-origin", "app.foxglove.dev"}, "'app.foxglove.dev'", "https://app.foxglove.dev");
  for (const Arguments& of_bus :
       {Arguments{"--allow-changes"}, Arguments{"--domain", "3"}, Arguments{"--max-beacons", "5"}}) {
    Arguments arguments{"/nonexistent.mcap"};
    arguments.insert(arguments.end(), of_bus.begin(), of_bus.end());
    fails(arguments, of_bus[0], "excludes");
  }
}

SCENARIO("a wrong file of the page's map is named with its line, and no service manager tries again") {
  const TemporaryFolder folder;
  const std::string file = (folder / "web.toml").string();
  const std::string picture = (folder / "hall.svg").string();
  write_text(picture, "<svg/>");
  const auto ends_with_origin = [&file](const std::string& line, const std::string& key) {
    write_text(file, "\n" + line);
    const Result result = run(SONOPOSE_TEST_WEB, {"--config", file});
    CHECK(result.code == 78);
    CHECK_THAT(result.error, Contains(": " + file + ":2: " + key + ": --" + key));
  };
  ends_with_origin("geofence = \"/no/such.csv\"", "geofence");
  ends_with_origin("floor-plan = \"/no/such.png\"\nfloor-plan-area = [0, 0, 1, 1]", "floor-plan");
  ends_with_origin("floor-plan = \"" + picture + "\"", "floor-plan");
  ends_with_origin("floor-plan-area = [1, 0, 0, 1]\nfloor-plan = \"" + picture + "\"", "floor-plan-area");
}

SCENARIO("a page resets estimators, runs the doctor, and learns that no fusion answers") {
  const Bus bus;
  const Web web(bus, {"--listen", "127.0.0.1:0", "--allow-changes"});
  Page page(web);
  Page other(web);
  const json reset{{"op", "reset"}, {"id", 9}, {"address", "all"}};
  WHEN("a page asks for both without a fusion, and again for a reset with one") {
    page.send({{"op", "examine"}, {"id", 10}, {"seconds", 3}});
    page.send(reset);
    json reply;
    json findings;
    bool was_running = false;
    while (reply.is_null() || findings.is_null()) {
      const json message = json::parse(page.next());
      if (message["op"] == "reply") reply = message;
      if (message["op"] != "findings") continue;
      if (message["running"] == false) findings = message;
      was_running = was_running || findings.is_null();
    }
    THEN("both pages receive progress and findings, and the one that asked learns that no fusion answers") {
      CHECK(was_running);
      CHECK_FALSE(findings["findings"].empty());
      CHECK(reply["id"] == 9);
      CHECK(reply["accepted"] == false);
      CHECK_THAT(reply["reason"].get<std::string>(), Contains("no fusion answered"));
      other.wait_for("findings", [](const json& message) { return message["running"] == true; });
      CHECK(other.wait_for("findings", [](const json& message) { return message["running"] == false; }) ==
            findings);
      for (int seconds = 0; seconds < 2;) {  // no message claims that it is still running
        const json message = json::parse(other.next());
        CHECK(message["op"] != "findings");
        if (message["op"] == "status") ++seconds;
      }
      const auto fusion = bus.fusion();
      const auto bridge = bus.bridge({"--source", "sim"});
      page.wait_for("frame");
      CHECK(answer_to(page, reset)["accepted"] == true);
    }
  }
}

/// Lowest severity of a beacon whose pose stream is silent, or lost because a busy fusion missed its lease.
constexpr int severity_without_poses = 95;

SCENARIO("a page that opens late sees a beacon that has stopped, as without poses") {
  const Bus bus;
  const auto fusion = bus.fusion();
  auto bridge = bus.bridge({"--source", "sim"});
  const Web web(bus, {"--listen", "127.0.0.1:0"});
  json last;
  {
    Page page(web);
    last = page.wait_for("frame", [](const json& frame) { return frame["beacons"][0].contains("pose"); });
    bridge.reset();
    const json without = page.wait_for("status", [](const json& status) {
      return status["beacons"].empty() || status["beacons"][0]["severity"] >= severity_without_poses;
    });
    if (without["beacons"].empty()) {
      WARN("skipped: this machine is so busy that the fusion was taken for dead");
      return;
    }
  }
  Page late(web);
  const json frame = late.wait_for("frame");
  CHECK(frame["beacons"][0]["pose"][0].get<double>() >= last["beacons"][0]["pose"][0].get<double>());
  const json status = late.wait_for("status");
  CHECK(status["beacons"][0]["severity"] >= severity_without_poses);
}

SCENARIO("a page that reads nothing loses frames, and others see the latest pose") {
  const Bus bus;
  const auto fusion = bus.fusion();
  auto bridge = bus.bridge({"--source", "sim", "--beacons", "100", "--imu-rate", "25"});
  const Web web(bus, {"--listen", "127.0.0.1:0"});
  Page slow(web, "/ws", "sonopose.v1", "", 4096);
  Page other(web);
  const auto latest_s = [](const json& frame) {
    double latest = 0;
    for (const json& beacon : frame["beacons"]) {
      if (beacon.contains("pose")) latest = std::max(latest, beacon["pose"][0].get<double>());
    }
    return latest;
  };
  WHEN("it has left 2.5 MB, and the beacons stop") {  // its socket buffers 0.4 MB, and the server 1 MB
    json lost_by_other = 0;
    for (std::size_t bytes = 0; bytes < 2'500'000;) {
      const std::string text = other.next();
      bytes += text.size();
      if (text.size() < 1000 && Contains("\"dropped\"").match(text)) {
        lost_by_other = json::parse(text)["frames"];
      }
    }
    bridge.reset();
    THEN("the other page sees the same as a new one, and the slow one learns how many frames it has lost") {
      Page fresh(web);
      const double last_s = latest_s(fresh.wait_for("frame"));
      CHECK(last_s > 0);
      other.wait_for("frame", [&](const json& frame) { return latest_s(frame) >= last_s; });
      CHECK(slow.wait_for("dropped")["frames"] > lost_by_other);
    }
  }
}

SCENARIO("the page's URL is printed whatever is logged") {
  const Bus bus;
  Process web(SONOPOSE_TEST_WEB, {"--listen", "0.0.0.0:0", "--log-level", "warning", "--domain",
                                  std::to_string(bus.domain_id())});
  CHECK(web.wait_for_line(Stream::output, "/?token="));
  CHECK(web.end_by(SIGTERM).code == 0);
  CHECK_THAT(web.text(Stream::error), !Contains("token="));
}

}  // namespace web_test
