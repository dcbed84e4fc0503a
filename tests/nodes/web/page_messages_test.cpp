#include "web/page_messages.hpp"

#include <sonopose/samples/pose.hpp>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <map>

namespace page_messages_test {

using namespace sonopose;
using namespace sonopose::web;
using Catch::Contains;
using nlohmann::json;

SCENARIO("text from the bus cannot break a message") {
  const std::string nasty = "\"}<script>\xff\n";
  const json reply = json::parse(text_of(Reply{.id = 3, .accepted = false, .reason = nasty}));
  CHECK(reply["op"] == "reply");
  CHECK(reply["id"] == 3);
  CHECK_THAT(reply["reason"].get<std::string>(), Contains("\"}<script>"));
  const json settings =
      json::parse(settings_text({.address = 7, .from_sequence = 12, .values = {{nasty, nasty}}}));
  CHECK(settings["address"] == 7);
  CHECK(settings["from_event"] == 12);
  CHECK(json::parse(settings_text({.address = all_beacons, .values = {}}))["address"] == "all");
  CHECK(json::parse(event_text(1'500'000'000, "warning", nasty))["t"] == 1.5);
  const json event = json::parse(event_text({.host = nasty,
                                             .process_id = 42,
                                             .time_ns = 1'500'000'000,
                                             .program = nasty,
                                             .level = LogLevel::failure,
                                             .text = nasty},
                                            0));
  CHECK(event["op"] == "event");
  CHECK(event["t"] == 1.5);
  CHECK(event["level"] == "error");
  CHECK(event["pid"] == 42);
  CHECK_FALSE(event.contains("missing"));
  CHECK(json::parse(event_text(LogLine(), 3))["missing"] == 3);
  for (const char* const name : {"host", "program", "text"}) {
    CHECK_THAT(event[name].get<std::string>(), Contains("\"}<script>"));
  }
}

SCENARIO("reports become messages with an op") {
  CHECK(
      json::parse(findings_text(R"({"ok":true,"findings":[]})")) ==
      json{{"op", "findings"}, {"running", false}, {"share", 1}, {"ok", true}, {"findings", json::array()}});
  CHECK(json::parse(examining_text(0.25))["share"] == 0.25);
  CHECK(json::parse(status_text(R"({"beacons":[]})")) == json{{"op", "status"}, {"beacons", json::array()}});
  CHECK(json::parse(gone_text(9)) == json{{"op", "gone"}, {"a", 9}});
  CHECK(json::parse(dropped_text(4)) == json{{"op", "dropped"}, {"frames", 4}});
  CHECK(json::parse(stationary_text({{12, {1, 2, 3}}}))["beacons"][0] ==
        json{{"a", 12}, {"x", 1.0}, {"y", 2.0}, {"z", 3.0}});
}

SCENARIO("the bits of the status have the words and the order of the monitor") {
  const json table = json::parse(status_table_json());
  std::map<std::uint32_t, json> by_bit;
  for (const json& row : table) by_bit[row["bit"]] = row;
  CHECK(by_bit.size() == 14);
  CHECK(by_bit.at(status_stale)["word"] == "stale");
  CHECK(by_bit.at(status_stale)["severity"] > by_bit.at(status_converging)["severity"]);
  CHECK(by_bit.at(status_predicted)["severity"] == 0);
  CHECK(by_bit.at(status_stale)["hidden_by"] == status_frozen_track);
  CHECK(by_bit.at(status_frozen_track)["hidden_by"] == 0);
}

SCENARIO("the table of settings has what a form needs") {
  const json table = json::parse(settings_table_json());
  bool has_choice = false;
  bool has_range = false;
  for (const json& row : table) {
    CAPTURE(row);
    CHECK_THAT(row["key"].get<std::string>(), Contains(row["group"].get<std::string>() + "."));
    CHECK_FALSE(row["sentence"].get<std::string>().empty());
    if (row["type"] == "choice") has_choice = has_choice || row["choices"].size() > 1;
    if (row["type"] == "double") has_range = has_range || row["min"].get<double>() < row["max"].get<double>();
  }
  CHECK(has_choice);
  CHECK(has_range);
}

}  // namespace page_messages_test
