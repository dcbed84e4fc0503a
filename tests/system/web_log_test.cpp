/// Lines of the other processes' logs on the page of sonopose-web.

#include "clocks/clocks.hpp"
#include "support/bus.hpp"
#include "support/wait_until.hpp"
#include "web_process.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <string>
#include <thread>

namespace sonopose::web_log_test {

using namespace sonopose::test;
using Catch::Contains;
using nlohmann::json;

bool is_of(const json& event, const std::string& program, const std::string& begin) {
  return event.value("program", "") == program && event["text"].get<std::string>().starts_with(begin);
}

/// Waits until the page has the bridge's line and the fusion's.
void wait_for_both(Page& page, const std::string& of_bridge, const std::string& of_fusion) {
  bool has_bridge = false;
  bool has_fusion = false;
  page.wait_for("event", [&](const json& event) {
    has_bridge = has_bridge || is_of(event, "sonopose-bridge", of_bridge);
    has_fusion = has_fusion || is_of(event, "sonopose-fusion", of_fusion);
    return has_bridge && has_fusion;
  });
}

SCENARIO("a page shows the logs of the other processes, each line once") {
  const auto began_s = static_cast<double>(std::time(nullptr));
  const Bus bus;
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--source", "sim"});
  REQUIRE(bridge->wait_for_line(Stream::error, "beacon 7: found"));
  const Web web(bus, {"--listen", "127.0.0.1:0"});
  Page page(web);
  THEN("those from before it was opened, with their process") {
    const json line = page.wait_for(
        "event", [](const json& event) { return is_of(event, "sonopose-bridge", "publishing from sim"); });
    CHECK(line["pid"] == bridge->pid());
    CHECK_FALSE(line["host"].get<std::string>().empty());
    CHECK(line["level"] == "info");
    CHECK(line["t"].get<double>() >= began_s - 1);
    CHECK(line["t"].get<double>() <= static_cast<double>(std::time(nullptr)) + 1);
    Page late(web);
    wait_for_both(late, "beacon 7: found", "serving");
  }
  THEN("new ones, and a change that the fusion logs only once") {
    wait_for_both(page, "beacon 7: found", "beacon 7: initialised");
    bridge->send(SIGSTOP);
    page.wait_for("event",
                  [](const json& event) { return is_of(event, "sonopose-fusion", "beacon 7: IMU silent"); });
    bridge->send(SIGCONT);
    page.wait_for("event",
                  [](const json& event) { return is_of(event, "sonopose-fusion", "beacon 7: IMU samples"); });
    for (int seconds = 0; seconds < 3;) {
      const json message = json::parse(page.next());
      if (message["op"] == "status") ++seconds;
      if (message["op"] != "event" || message.contains("program")) continue;
      CHECK_THAT(message["text"].get<std::string>(), Contains("no pose") || Contains("poses arrive again"));
    }
  }
}

SCENARIO("of a process that logs too much, a page gets a part and the number of the other lines") {
  const Bus bus;
  const Web web(bus, {"--listen", "127.0.0.1:0"});
  const auto participant = dds::ext::participant({.domain_id = bus.domain_id()});
  auto writer = dds::topics::make_writer(participant, dds::qos::Provider(), dds::topics::log);
  REQUIRE(wait_until([&] { return writer.publication_matched_status().current_count() == 1; }));
  std::uint64_t number = 0;
  const auto write = [&](const std::string& text) {
    writer.write(dds::topics::to_idl(LogLine{.host = "robot",
                                             .process_id = 1,
                                             .number = ++number,
                                             .time_ns = clocks::host_now(),
                                             .program = "flood",
                                             .text = text}));
  };
  Page page(web);
  page.wait_for("status");
  for (int burst = 0; burst < 40; ++burst) {
    for (int i = 0; i < 120; ++i) write("line");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the page's process reads every 40 ms
  }
  std::uint64_t shown = 0;
  std::uint64_t not_shown = 0;
  std::uint64_t most = 500;
  const auto count = [&](const json& message) {
    if (message["op"] == "status") most += 500;
    if (message["op"] != "event") return false;
    const auto text = message["text"].get<std::string>();
    if (message.value("program", "") == "flood") {
      ++shown;
      not_shown += message.value("missing", std::uint64_t{0});
    } else if (text.ends_with("left out: too many at a time")) {
      not_shown += std::stoull(text);
    }
    return text == "end";
  };
  for (int seconds = 0; seconds < 2;) {
    const json message = json::parse(page.next());
    count(message);
    if (message["op"] == "status") ++seconds;
  }
  write("end");
  while (!count(json::parse(page.next()))) continue;
  CHECK(shown <= most);
  CHECK(shown + not_shown == number);
}

}  // namespace sonopose::web_log_test
