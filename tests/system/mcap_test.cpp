/// The program sonopose-mcap, and the programs that take its files.

#include "bus_log/recorded.hpp"
#include "sim/simulator.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <sstream>

namespace mcap_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
using Path = std::filesystem::path;

/// Twenty seconds of a walk, of each of these beacons.
void record_walks(const Path& file, const std::vector<BeaconAddress>& addresses) {
  BusRecording recording(file);
  for (Event event : sim::record(sim::find_scenario("walk"), {.duration_s = 20.0}).events) {
    for (const BeaconAddress address : addresses) {
      std::visit([address](auto& sample) { sample.address = address; }, event);
      recording.write(event, static_cast<std::uint64_t>(available_at_ns(event)));
    }
  }
}

std::string state_hash_of(const Result& replay) {
  const std::string name = "state hash";
  const std::size_t at = replay.output.find(name);
  REQUIRE(at != std::string::npos);
  return replay.output.substr(at + name.size());
}

Result mcap(const std::vector<std::string>& arguments) {
  return run(SONOPOSE_TEST_MCAP, arguments);
}

SCENARIO("a recording of the bus is shown, selected and exported") {
  const TemporaryFolder folder;
  const std::string file = folder / "run.mcap";
  record_walks(file, {7, 12});
  GIVEN("sonopose-mcap info") {
    const Result result = mcap({"info", file});
    THEN("it lists the topics") {
      CHECK(result.code == 0);
      CHECK_THAT(result.output, Contains("sonopose/imu") && Contains("4000"));
    }
  }
  GIVEN("sonopose-mcap cat of one beacon and topic") {
    const Result result = mcap({"cat", file, "--topics", "fix", "--beacon", "12", "--end", "1"});
    THEN("each line is a message as JSON") {
      CHECK(result.code == 0);
      std::istringstream lines(result.output);
      std::string line;
      int count = 0;
      while (std::getline(lines, line)) {
        const auto json = nlohmann::json::parse(line);
        CHECK(json["topic"] == "sonopose/fix");
        CHECK(json["message"]["address"] == 12);
        ++count;
      }
      CHECK(count > 5);
      CHECK(count < 20);
    }
  }
  GIVEN("filter, merge and export") {
    CHECK(mcap({"filter", file, "--beacon", "7", "--out", folder / "a.mcap"}).code == 0);
    CHECK(
        mcap({"filter", file, "--beacon", "12", "--out", folder / "b.mcap", "--compression", "zstd"}).code ==
        0);
    CHECK(mcap({"merge", folder / "a.mcap", folder / "b.mcap", "--out", folder / "both.mcap"}).code == 0);
    CHECK(mcap({"export", folder / "both.mcap", "--beacon", "12", "--out", folder / "log"}).code == 0);
    THEN("all replays of the beacon end in the same state") {
      const auto expected = state_hash_of(run(SONOPOSE_TEST_REPLAY, {file, "--beacon", "12"}));
      CHECK(state_hash_of(run(SONOPOSE_TEST_REPLAY, {folder / "b.mcap"})) == expected);
      CHECK(state_hash_of(run(SONOPOSE_TEST_REPLAY, {folder / "log"})) == expected);
    }
  }
  GIVEN("a cut file") {
    write_text(folder / "cut.mcap", read_text(file).substr(0, 50'000));
    const Result result = mcap({"recover", folder / "cut.mcap", "--out", folder / "good.mcap"});
    THEN("what it has is saved, and what is lost is told") {
      CHECK(result.code == 0);
      CHECK_THAT(result.error,
                 Contains("cut.mcap: byte ") && Contains("it was cut, or is damaged from here on"));
      CHECK_THAT(result.output, Contains("messages"));
      CHECK(mcap({"info", folder / "good.mcap"}).code == 0);
    }
  }
}

SCENARIO("errors of recordings name what is wrong") {
  const TemporaryFolder folder;
  const std::string file = folder / "run.mcap";
  record_walks(file, {7, 12});
  const auto refused = [](const Result& result) { return result.code == 1 ? result.error : "code is not 1"; };
  CHECK_THAT(refused(mcap({"info", folder / "none.mcap"})), Contains("none.mcap: does not exist"));
  CHECK_THAT(refused(mcap({"cat", file, "--topics", "imus"})), Contains("has no topic imus"));
  CHECK_THAT(refused(run(SONOPOSE_TEST_REPLAY, {file})), Contains("choose one with --beacon: 7, 12"));
  CHECK_THAT(refused(run(SONOPOSE_TEST_EVALUATE, {file})), Contains("choose one with --beacon: 7, 12"));
  CHECK_THAT(refused(run(SONOPOSE_TEST_CALIBRATE, {"gyroscope", file})),
             Contains("choose one with --beacon: 7, 12"));
  CHECK(run(SONOPOSE_TEST_EVALUATE, {file, "--beacon", "12"}).code == 0);
  CHECK_THAT(refused(run(SONOPOSE_TEST_CALIBRATE, {"gyroscope", file, "--beacon", "13"})),
             Contains("run.mcap"));
  write_text(folder / "text.mcap", "not MCAP at all");
  CHECK_THAT(refused(mcap({"info", folder / "text.mcap"})),
             Contains("text.mcap: byte 0: is not an MCAP file"));
  CHECK_THAT(refused(run(SONOPOSE_TEST_REPLAY, {folder / "text.mcap"})), Contains("is not an MCAP file"));
}

}  // namespace mcap_test
