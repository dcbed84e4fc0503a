/// The program sonopose-replay: output, files and errors.

#include "system/replay_rows.hpp"
#include "system/replay_run.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace replay_test {

using namespace replay_run;
using Catch::Contains;
using nlohmann::json;

std::size_t lines_of(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

SCENARIO("a replay prints its result and writes three files") {
  const Recording recording;
  const std::string out = (recording / "new/out").string();
  const json report = report_of({recording.log(), "--after", "6", "--out", out});
  CHECK(report["position_rmse_m"].get<double>() < report["last_fix_rmse_m"].get<double>());
  CHECK(report["imu_samples"] == 1200);
  CHECK(report["duration_s"].get<double>() == Approx(12.0).margin(0.02));
  for (const char* field : {"position_p95_m", "position_max_m", "yaw_rmse_deg", "tilt_rmse_deg",
                            "velocity_rmse_mps", "extrapolated_rmse_m"}) {
    CAPTURE(field);
    CHECK(report[field].is_number());
  }
  CHECK(pose_rows(recording / "new/out/pose.csv").size() == 1200);
  const auto positions = lines_of(recording / "new/out/trajectory.tum") - 1;
  CHECK(positions > 1100);
  CHECK(positions < 1200);  // without those before the first fix
  const auto fixes = report["fixes_used"].get<std::size_t>() + report["fixes_rejected"].get<std::size_t>();
  CHECK(lines_of(recording / "new/out/fixes.csv") == fixes + 1);
  AND_THEN("a second run replaces them with the same bytes and has the same hash") {
    const std::string before = read_text(recording / "new/out/pose.csv");
    CHECK(report_of({recording.log(), "--out", out})["state_hash"] == report["state_hash"]);
    CHECK(read_text(recording / "new/out/pose.csv") == before);
  }
  AND_THEN("the text output contains the same values") {
    const Result text = replay({recording.log(), "--after", "6"});
    CHECK(text.code == 0);
    CHECK_THAT(text.output, Contains(report["state_hash"].get<std::string>()) && Contains("x real time"));
  }
}

SCENARIO("a smoothed replay prints the scores of both trajectories and writes covariances") {
  const Recording recording;
  const json plain = report_of({recording.log(), "--after", "6"});
  const json smoothed =
      report_of({recording.log(), "--after", "6", "--smooth", "--out", (recording / "out").string()});
  CHECK(plain["smoothing"].is_null());
  CHECK(smoothed["smoothing"]["unsmoothed_position_rmse_m"] == plain["position_rmse_m"]);
  CHECK(smoothed["position_rmse_m"].get<double>() < plain["position_rmse_m"].get<double>());
  CHECK(smoothed["state_hash"] == plain["state_hash"]);
  CHECK(lines_of(recording / "out/covariance.csv") == 1 + smoothed["poses"].get<std::size_t>());
  CHECK(lines_of(recording / "out/pose.csv") == 1 + smoothed["poses"].get<std::size_t>());
  CHECK_THAT(refusal({recording.log(), "--smooth", "--engine", "documented"}),
             Contains("only the Kalman engine can be smoothed"));
  CHECK_THAT(refusal({recording.log(), "--smooth", "--set", "kalman.delay.estimate=true"}),
             Contains("kalman.delay.estimate"));
  CHECK_THAT(refusal({recording.log(), "--smooth", "--load-state", "state.json"}), Contains("--load-state"));
}

SCENARIO("two files of settings are compared, in one picture") {
  const Recording recording;
  const std::string good = (recording / "good.toml").string();
  const std::string turned = (recording / "turned.toml").string();
  const auto picture = recording / "both.svg";
  write_text(good, "[heading]\nmount_offset_deg = 0.0\n");
  write_text(turned, "[heading]\nmount_offset_deg = 60.0\n");
  GIVEN("a right and a wrong mount") {
    WHEN("they are compared") {
      const Result text =
          replay({recording.log(), "--after", "6", "--compare", good, turned, "--plot", picture.string()});
      THEN("the results follow their names, and the picture has both") {
        CHECK(text.code == 0);
        const auto first = text.output.find(good);
        const auto second = text.output.find(turned);
        REQUIRE(first != std::string::npos);
        REQUIRE(second != std::string::npos);
        CHECK(first < second);
        CHECK_THAT(read_text(picture), Contains("<svg") && Contains("good.toml") && Contains("turned.toml"));
      }
    }
    WHEN("the wrong one is compared with itself") {
      const Result twice = replay({recording.log(), "--after", "6", "--compare", turned, turned});
      THEN("what both show is said once") {
        const auto first = twice.error.find("mount offset is wrong");
        REQUIRE(first != std::string::npos);
        CHECK(twice.error.find("mount offset is wrong", first + 1) == std::string::npos);
      }
    }
    WHEN("they are compared as JSON") {
      const Result json_text = replay({recording.log(), "--after", "6", "--json", "--compare", good, turned});
      THEN("there is an object for each, and the right mount has the smaller error") {
        REQUIRE(json_text.code == 0);
        std::istringstream objects(json_text.output);
        json of_good;
        json of_turned;
        objects >> of_good >> of_turned;
        CHECK(of_good["position_rmse_m"] ==
              report_of({recording.log(), "--after", "6", "--config", good})["position_rmse_m"]);
        CHECK(of_good["yaw_rmse_deg"].get<double>() < of_turned["yaw_rmse_deg"].get<double>());
      }
    }
  }
  GIVEN("a file that is no TOML, or is missing") {
    const auto bad = recording / "bad.toml";
    write_text(bad, "[heading]\nmount_offset_deg = = 1\n");
    THEN("the error names it, and there is no picture") {
      CHECK_THAT(refusal({recording.log(), "--compare", good, bad.string(), "--plot", picture.string()}),
                 Contains("bad.toml:2"));
      CHECK_THAT(refusal({recording.log(), "--compare", good, "/nowhere.toml"}), Contains("/nowhere.toml"));
      CHECK_THAT(refusal({recording.log(), "--compare", good}), Contains("--compare"));
      CHECK_FALSE(exists(picture));
    }
  }
}

SCENARIO("the trajectory is in TUM format") {
  const Recording recording;
  REQUIRE(replay({recording.log(), "--out", (recording / "out").string(), "--until", "0.5"}).code == 0);
  std::istringstream lines(read_text(recording / "out/trajectory.tum"));
  std::string line;
  REQUIRE(std::getline(lines, line));
  CHECK(line.starts_with("#"));
  REQUIRE(std::getline(lines, line));
  CHECK(line.starts_with("1700000000."));
  CHECK(std::count(line.begin(), line.end(), ' ') == 7);
}

SCENARIO("settings come from file and command line, for all beacons or for one") {
  const Recording recording;
  const auto hash = [&recording](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {recording.log(), "--set", "fusion.engine=documented"});
    return report_of(arguments)["state_hash"];
  };
  const auto plain = hash({});
  const auto changed = hash({"--set", "documented.attitude.adaptive.accel_time_s=10"});
  CHECK(plain != changed);
  write_text(recording / "own.toml", "[beacon.9.documented.attitude.adaptive]\naccel_time_s = 10\n");
  const std::string config = (recording / "own.toml").string();
  CHECK(hash({"--config", config}) == plain);
  // No file and no hash contains the address: only its settings make a difference.
  CHECK(hash({"--config", config, "--beacon", "9"}) == changed);
  CHECK(hash({"--config", config, "--beacon", "9", "--set",
              "beacon.9.documented.attitude.adaptive.accel_time_s=20"}) != changed);
}

SCENARIO("the beacon that a log names is the one whose settings apply") {
  const Recording recording;
  const auto hash = [&recording](const std::vector<std::string>& arguments) {
    std::vector<std::string> all{recording.log()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return report_of(all)["state_hash"].get<std::string>();
  };
  const std::vector<std::string> own{"--set", "beacon.12.heading.mount_offset_deg=5"};
  const std::string unchanged = hash({});
  CHECK(hash(own) == unchanged);  // the simulator's beacon is 7
  write_text(recording / "log/meta.toml", "imu_meaning = \"instant\"\nbeacon_address = 12\n");
  CHECK(hash({}) == unchanged);
  CHECK(hash(own) != unchanged);
  CHECK(hash({"--set", "beacon.12.heading.mount_offset_deg=5", "--beacon", "7"}) == unchanged);
  CHECK(hash({"--set", "beacon.12.fusion.engine=kalman", "--engine", "documented"}) ==
        hash({"--engine", "documented"}));
  std::filesystem::remove(recording / "log/meta.toml");
  for (const std::string engine : {"documented", "kalman"}) {
    const std::string without = hash({"--engine", engine});
    write_text(recording / "log/meta.toml", "imu_meaning = \"instant\"\n");
    CHECK(hash({"--engine", engine}) == without);  // both engines treat unknown samples as instantaneous
    write_text(recording / "log/meta.toml", "imu_meaning = \"mean\"\n");
    CHECK((hash({"--engine", engine}) == without) == (engine == "documented"));
    std::filesystem::remove(recording / "log/meta.toml");
  }
}

SCENARIO("a run continues seamlessly from a saved state") {
  const Recording recording;
  const std::string engine = GENERATE("documented", "kalman");
  const std::string state = (recording / "state.json").string();
  const std::string end = (recording / "end.json").string();
  const std::string whole_end = (recording / "whole.json").string();
  const auto out = [&recording](const char* name) { return (recording / name).string(); };
  const auto replay_part = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {recording.log(), "--engine", engine});
    report_of(std::move(arguments));
  };
  replay_part({"--out", out("whole"), "--save-state", whole_end});
  replay_part({"--out", out("first"), "--until", "6.5", "--save-state", state});
  replay_part({"--out", out("second"), "--load-state", state, "--save-state", end});
  auto halves = pose_rows(recording / "first/pose.csv");
  const auto second = pose_rows(recording / "second/pose.csv");
  CHECK(second.size() > 100);
  halves.insert(halves.end(), second.begin(), second.end());
  CHECK((halves == pose_rows(recording / "whole/pose.csv")));
  CHECK(read_text(end) == read_text(whole_end));
  AND_THEN("a damaged state is refused with file and field") {
    if (engine != "documented") return;  // the field belongs to its state
    std::string text = read_text(state);
    text.replace(text.find("\"trust.trust\""), 13, "\"trust.truth\"");
    write_text(state, text);
    CHECK_THAT(refusal({recording.log(), "--load-state", state}),
               Contains("state.json: state: trust.trust: is missing"));
    CHECK_THAT(refusal({recording.log(), "--load-state", out("none.json")}),
               Contains("none.json: does not exist"));
  }
}

SCENARIO("pure integration starts from the truth") {
  const Recording recording;
  const json previous = report_of({recording.log(), "--engine", "strapdown", "--init", "truth"});
  CHECK(previous["fixes_used"] == 0);
  CHECK(previous["position_rmse_m"].is_number());
  const json mean =
      report_of({recording.log(), "--engine", "strapdown", "--init", "truth", "--integration", "mean"});
  CHECK(mean["state_hash"] != previous["state_hash"]);
  const std::string state = (recording / "state.json").string();
  CHECK_THAT(refusal({recording.log(), "--engine", "strapdown", "--save-state", state}),
             Contains("--save-state: strapdown"));
  report_of({recording.log(), "--until", "2", "--save-state", state});
  CHECK_THAT(refusal({recording.log(), "--engine", "strapdown", "--load-state", state}),
             Contains("another kind of estimator"));
  const Recording without_truth(false);
  CHECK_THAT(refusal({without_truth.log(), "--engine", "strapdown", "--init", "truth"}),
             Contains("strapdown") && Contains("truth.csv"));
  const json fused = report_of({without_truth.log()});
  CHECK(fused["position_rmse_m"].is_null());
  CHECK(fused["fixes_used"].get<int>() > 0);
}

SCENARIO("errors are named, and the exit code is 1") {
  const Recording recording;
  const std::string log = recording.log();
  CHECK_THAT(refusal({(recording / "nowhere").string()}), Contains("nowhere: does not exist"));
  CHECK_THAT(refusal({log, "--set", "drift.no_such_key=1"}), Contains("drift.no_such_key"));
  CHECK_THAT(refusal({log, "--set", "documented.attitude.mahony.kp=11"}),
             Contains("kp") && Contains("out of range"));
  CHECK_THAT(refusal({log, "--config", "/nowhere.toml"}), Contains("/nowhere.toml"));
  CHECK_THAT(refusal({log, "--until", "-1"}), Contains("--until"));
  CHECK_THAT(refusal({log, "--engine", "magic"}), Contains("--engine"));
  CHECK_THAT(refusal({log, "--out", "/dev/null/out"}), Contains("/dev/null/out: cannot be created"));
  CHECK_THAT(refusal({log, "--plot", "picture.pdf"}), Contains("ends in .svg or .png"));
  CHECK_THAT(refusal({log, "--plot", (recording / "a.svg").string()}, {{"PATH", "/nowhere"}}),
             Contains("gnuplot-nox"));
  std::filesystem::create_directory(recording / "full");
  std::filesystem::create_symlink("/dev/full", recording / "full/fixes.csv");
  CHECK_THAT(refusal({log, "--out", (recording / "full").string()}),
             Contains("fixes.csv: cannot be written: No space left"));
  const std::string out = (recording / "out").string();
  const std::vector<std::string> everything{log,
                                            "--out",
                                            out,
                                            "--plot",
                                            (recording / "picture.svg").string(),
                                            "--save-state",
                                            (recording / "state.json").string()};
  REQUIRE(replay(everything).code == 0);
  const auto results = [&recording] {
    std::string text;
    for (const char* name :
         {"out/trajectory.tum", "out/pose.csv", "out/fixes.csv", "picture.svg", "state.json"})
      text += read_text(recording / name);
    return text;
  };
  const std::string before = results();
  recording.append("imu.csv", "1800000000000000000,0,0,zero,0,0,9.8");
  CHECK_THAT(refusal({log}), Contains("imu.csv:1202: column 4 (w_z [rad s^-1]): \"zero\" is not a number"));
  refusal(everything);
  CHECK((results() == before));
  write_text(recording / "log/imu.csv", "#timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n");
  write_text(recording / "log/ultrasonic.csv", "#timestamp,received,x,y,z,quality\n");
  std::filesystem::remove(recording / "log/heading.csv");
  CHECK_THAT(refusal(everything), Contains("no samples"));
  CHECK((results() == before));
  CHECK_FALSE(exists(recording / "out/pose.csv.part"));
}

SCENARIO("a replay opens no DDS domain") {
  GIVEN("a configuration with which no domain can be opened") {
    const Environment environment{
        {"CYCLONEDDS_URI", "<CycloneDDS><Domain><NoSuchElement/></Domain></CycloneDDS>"}};
    THEN("a recording is replayed") {
      const Recording recording;
      CHECK(replay({recording.log(), "--after", "6"}, environment).code == 0);
    }
  }
}

}  // namespace replay_test
