/// The program sonopose-mcap, and programs that read its files.

#include "bus_log/recorded.hpp"
#include "mcap/reader.hpp"
#include "sim/simulator.hpp"
#include "support/checked_run.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <sstream>

namespace mcap_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
using Path = std::filesystem::path;

/// Records twenty seconds of a walk for each of these beacons.
void record_walks(const Path& file, const std::vector<BeaconAddress>& addresses) {
  BusRecording recording(file);
  for (Event event : sim::record(sim::find_scenario("walk"), {.duration_s = 20.0}).events) {
    for (const BeaconAddress address : addresses) {
      std::visit([address](auto& sample) { sample.address = address; }, event);
      recording.write(event, static_cast<std::uint64_t>(available_at_ns(event)));
    }
  }
}

/// Output of a replay from its state hash on.
std::string state_hash_of(const std::vector<std::string>& arguments) {
  const std::string output = output_of(SONOPOSE_TEST_REPLAY, arguments);
  const std::size_t at = output.find("state hash");
  REQUIRE(at != std::string::npos);
  return output.substr(at);
}

Result mcap(const std::vector<std::string>& arguments) {
  return run(SONOPOSE_TEST_MCAP, arguments);
}

SCENARIO("a recording of the bus is shown, selected and exported") {
  static const TemporaryFolder recorded;
  const std::string file = recorded / "run.mcap";
  if (!std::filesystem::exists(file)) record_walks(file, {7, 12});
  const TemporaryFolder folder;
  GIVEN("sonopose-mcap info") {
    const Result result = mcap({"info", file});
    THEN("it lists the topics") {
      CHECK(result.code == 0);
      // 20 s of two beacons at 100 Hz each.
      const std::size_t line_at = result.output.find("sonopose/imu ");
      REQUIRE(line_at != std::string::npos);
      const std::string line = result.output.substr(line_at, result.output.find('\n', line_at) - line_at);
      CHECK_THAT(line, Contains(" 4000 ") && Contains("sonopose::ImuSample"));
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
      const auto expected = state_hash_of({file, "--beacon", "12"});
      CHECK(state_hash_of({folder / "b.mcap"}) == expected);
      CHECK(state_hash_of({folder / "log"}) == expected);
    }
  }
  GIVEN("times of the day and of the log") {
    const auto times = sonopose::mcap::Reader(file).statistics().log_times;
    const auto filtered = [&](const std::vector<std::string>& arguments) {
      std::filesystem::remove(folder / "part.mcap");
      std::vector<std::string> all{"filter", file, "--out", folder / "part.mcap"};
      all.insert(all.end(), arguments.begin(), arguments.end());
      const Result result = mcap(all);
      return result.code == 0 ? result.output : result.error;
    };
    THEN("they select like the seconds after the first message") {
      const std::string from_ten = filtered({"--start", "10"});
      REQUIRE_THAT(from_ten, Contains(" of "));
      CHECK(filtered({"--start", std::to_string(times.start_ns + 10'000'000'000)}) == from_ten);
    }
    THEN("they are understood as info prints them") {
      const std::string info = mcap({"info", file}).output;
      const std::size_t at = info.find("begins    ") + 10;
      const std::string begin = info.substr(at, info.find('\n', at) - at);
      CHECK(filtered({"--start", begin}) == filtered({}));
      std::string iso = begin.substr(0, begin.find(" UTC")) + "Z";
      iso[iso.find(' ')] = 'T';
      CHECK(filtered({"--start", iso}) == filtered({}));
    }
    THEN("others are refused") {
      CHECK_THAT(filtered({"--start", "2026-13-01T00:00"}),
                 Contains("--start") && Contains("nor a UTC time"));
      CHECK_THAT(filtered({"--start", "-1"}), Contains("--start"));
      CHECK_THAT(filtered({"--start", "5", "--end", "2"}),
                 Contains("the end, 2 s, is before the start, 5 s"));
    }
  }
  GIVEN("a filter that selects nothing") {
    const Result result = mcap({"filter", file, "--start", "100000", "--out", folder / "nothing.mcap"});
    THEN("it fails, and leaves no file") {
      CHECK(result.code == 1);
      CHECK_THAT(result.error, Contains("run.mcap: none of its ") && Contains(" messages is selected"));
      CHECK_FALSE(std::filesystem::exists((folder / "nothing.mcap")));
      const Result shown = mcap({"cat", file, "--start", "100000"});
      CHECK(shown.code == 1);
      CHECK(shown.output.empty());
      CHECK_THAT(shown.error, Contains("run.mcap: none of its ") && Contains(" messages is selected"));
    }
    THEN("cat fails for a gap inside the recording, too") {
      const Result shown =
          mcap({"cat", file, "--topics", "imu", "--start", "1.0030001", "--end", "1.0030002"});
      CHECK(shown.code == 1);
      CHECK_THAT(shown.error, Contains("run.mcap: none of its ") && Contains(" messages is selected"));
    }
  }
  GIVEN("a cut file") {
    write_text(folder / "cut.mcap", read_text(file).substr(0, 3 * std::filesystem::file_size(file) / 4));
    const Result result = mcap({"recover", folder / "cut.mcap", "--out", folder / "good.mcap"});
    THEN("what it has is saved, and losses are reported") {
      CHECK(result.code == 0);
      CHECK_THAT(result.error,
                 Contains("cut.mcap: byte ") && Contains("it was cut, or is damaged from here on"));
      CHECK_THAT(result.output, Contains(" of ") && Contains(" messages"));
      CHECK(mcap({"info", "--verify", folder / "good.mcap"}).code == 0);
    }
  }
}

SCENARIO("the files of a recorder are one recording") {
  const TemporaryFolder folder;
  const std::string whole = folder / "whole.mcap";
  record_walks(whole, {7});
  const std::string first = folder / "run_001.mcap";
  const std::string second = folder / "run_002.mcap";
  REQUIRE(mcap({"filter", whole, "--end", "10", "--out", first}).code == 0);
  REQUIRE(mcap({"filter", whole, "--start", "10.000001", "--out", second}).code == 0);
  THEN("a replay has the same result as that of one file") {
    CHECK(state_hash_of({first, second}) == state_hash_of({whole}));
  }
  THEN("a part of them is that of one file") {
    const auto part_of = [](std::vector<std::string> files) {
      std::vector<std::string> arguments{"cat", "--topics=/fix", "--start=9", "--end=11"};
      arguments.insert(arguments.begin() + 1, files.begin(), files.end());
      const Result result = mcap(arguments);
      REQUIRE(result.code == 0);
      return result.output;
    };
    CHECK(part_of({first, second}) == part_of({whole}));
    const std::string part = folder / "part.mcap";
    REQUIRE(mcap({"filter", first, second, "--start", "9", "--out", part}).code == 0);
    CHECK(sonopose::mcap::Reader(part).statistics().log_times.start_ns >=
          sonopose::mcap::Reader(whole).statistics().log_times.start_ns + 9'000'000'000);
  }
  THEN("they are one case, and others are cases of their own") {
    const std::string rows = output_of(SONOPOSE_TEST_EVALUATE, {first, second, whole, "--json"});
    CHECK(nlohmann::json::parse(rows).size() == 2);
    CHECK_THAT(rows, Contains("run_001.mcap and 1 more"));
  }
}

SCENARIO("the exit code says whether a file is sound") {
  const TemporaryFolder folder;
  const std::string file = folder / "run.mcap";
  record_walks(file, {7});
  const std::string whole = read_text(file);
  const auto verify = [&folder](const std::string& text) {
    const std::string damaged = folder / "damaged.mcap";
    write_text(damaged, text);
    CHECK(mcap({"info", damaged}).code == 0);  // shows the readable part
    return mcap({"info", "--verify", damaged});
  };
  GIVEN("a sound file") {
    const Result result = verify(whole);
    CHECK(result.code == 0);
    CHECK_THAT(result.output, !Contains("damaged: "));
  }
  GIVEN("a cut one") {
    const Result result = verify(whole.substr(0, whole.size() / 2));
    CHECK(result.code == 1);
    CHECK_THAT(result.output, Contains("damaged: "));
  }
  GIVEN("another byte in a chunk, which the index does not show") {
    std::string text = whole;
    const auto chunk = sonopose::mcap::Reader(file).contents().blocks.front();
    text[chunk.offset + chunk.length / 2] ^= 0x10;
    const Result result = verify(text);
    CHECK(result.code == 1);
    CHECK_THAT(result.output, Contains("damaged: "));
  }
}

SCENARIO("programs take recordings of other forms") {
  const TemporaryFolder folder;
  GIVEN("a recording of two beacons") {
    const std::string file = folder / "run.mcap";
    record_walks(file, {7, 12});
    THEN("a search scores settings on one of them") {
      const Result result = run(SONOPOSE_TEST_TUNE, {file, "--beacon", "12", "--rounds", "2", "--vary",
                                                     "documented.alignment.yaw_noise_mps=0.2..1", "--set",
                                                     "fusion.engine=documented"});
      CAPTURE(result.error);
      CHECK(result.code == 0);
      CHECK_THAT(result.output, Contains("Geometric mean"));
    }
  }
  GIVEN("a CSV log of the Dashboard: two seconds at rest") {
    std::string text;
    for (int ms = 0; ms < 2000; ms += 10) {
      text += fmt::format("T2024_03_01__12000{}_{:03},user,41,131,7,0,0,1000,0,0,0,na,na,na\n", ms / 1000,
                          ms % 1000);
      if (ms % 100 != 50) continue;
      text += fmt::format("T2024_03_01__12000{}_{:03},user,41,129,7,1.000,2.000,0.500,2,8192,50\n", ms / 1000,
                          ms % 1000);
    }
    write_text(folder / "Marvelmind_log.csv", text);
    THEN("it is replayed") {
      CHECK(state_hash_of({folder / "Marvelmind_log.csv"}).size() > 26);
    }
  }
}

SCENARIO("errors of recordings name what is wrong") {
  const TemporaryFolder folder;
  const std::string file = folder / "run.mcap";
  record_walks(file, {7, 12});
  CHECK_THAT(refusal_of(SONOPOSE_TEST_MCAP, {"info", folder / "none.mcap"}),
             Contains("none.mcap: does not exist"));
  CHECK_THAT(refusal_of(SONOPOSE_TEST_MCAP, {"cat", file, "--topics", "imus"}),
             Contains("has no topic imus"));
  CHECK_THAT(refusal_of(SONOPOSE_TEST_REPLAY, {file}), Contains("choose one with --beacon: 7, 12"));
  CHECK_THAT(refusal_of(SONOPOSE_TEST_EVALUATE, {file}), Contains("choose one with --beacon: 7, 12"));
  CHECK_THAT(refusal_of(SONOPOSE_TEST_CALIBRATE, {"gyroscope", file}),
             Contains("choose one with --beacon: 7, 12"));
  CHECK(run(SONOPOSE_TEST_EVALUATE, {file, "--beacon", "12"}).code == 0);
  CHECK_THAT(refusal_of(SONOPOSE_TEST_CALIBRATE, {"gyroscope", file, "--beacon", "13"}),
             Contains("run.mcap"));
  write_text(folder / "text.mcap", "not MCAP at all");
  CHECK_THAT(refusal_of(SONOPOSE_TEST_MCAP, {"info", folder / "text.mcap"}),
             Contains("text.mcap: byte 0: is not an MCAP file"));
  CHECK_THAT(refusal_of(SONOPOSE_TEST_REPLAY, {folder / "text.mcap"}), Contains("is not an MCAP file"));
}

}  // namespace mcap_test
