/// The program sonopose-replay with faulty recordings.

#include "system/replay_run.hpp"

#include <sstream>

namespace replay_faults_test {

using namespace replay_run;
using Catch::Contains;
using nlohmann::json;

SCENARIO("impossible rows are counted and have no other effect") {
  const Recording recording;
  recording.append("imu.csv",
                   "1700000012000000000,nan,0,0,0,0,9.8\n1700000012010000000,0,0,inf,0,0,9.8\n"
                   "1700000012020000000,0,0,10000,0,0,9.8");
  recording.append("ultrasonic.csv", "1700000011950000000,1700000012005000000,1e6,nan,0,90");
  const json report = report_of({recording.log()});
  CHECK(report["samples_invalid"] == 3);
  CHECK(report["imu_samples"] == 1200);
  CHECK(report["fix_flags"]["invalid"] == 1);
  CHECK(report["position_max_m"].is_number());
}

SCENARIO("IMU stamps far ahead cost only their own samples, and are counted") {
  const Recording recording;
  const json clean = report_of({recording.log(), "--after", "6"});
  const auto imu = std::filesystem::path(recording.log()) / "imu.csv";
  std::string rows = read_text(imu);
  auto at = rows.find('\n') + 1;  // the first row, a single one, and two in a row
  for (const char* const stamp : {"", "17000000080", "17000000090", "17000000090"}) {
    at = rows.find(stamp, at);
    REQUIRE(at != std::string::npos);
    rows.replace(at++, 7, "1700003");  // 3000 s later
  }
  write_text(imu, rows);
  const json report = report_of({recording.log(), "--after", "6"});
  CHECK(report["imu_stamps_back"] == 0);
  CHECK(report["fixes_used"].get<int>() >= clean["fixes_used"].get<int>() - 2);
  CHECK(report["poses_scored"].get<int>() >= clean["poses_scored"].get<int>() - 10);
  const Result text = replay({recording.log(), "--after", "6"});
  CHECK_THAT(text.error, Contains("/log: 4 of 1200 IMU samples are left out"));
  CHECK(report_of({recording.log(), "--until", "10"})["imu_samples"].get<int>() > 980);
}

SCENARIO("a replay that used no fix says why and fails") {
  const Recording recording;
  const auto imu = std::filesystem::path(recording.log()) / "imu.csv";
  GIVEN("an IMU whose header names a unit of time that its stamps do not have") {
    std::string rows = read_text(imu);
    write_text(imu, rows.replace(rows.find("[ns]"), 4, "[ms]"));
    THEN("the stamps are refused, with the row") {
      CHECK_THAT(refusal({recording.log()}), Contains("/imu.csv:2: column 1 (timestamp [ms])") &&
                                                 Contains("is not a time between 1 and 2^62"));
    }
  }
  GIVEN("an IMU of another clock") {
    std::istringstream rows(read_text(imu));
    std::string earlier;
    for (std::string row; std::getline(rows, row);) {
      if (row.starts_with("17")) row.replace(0, 2, "16");
      earlier += row + "\n";
    }
    write_text(imu, earlier);
    const std::string error = refusal({recording.log()});
    THEN("both are said") {
      CHECK_THAT(error, Contains("most fixes are after the IMU samples, half of them by ") &&
                            Contains("/log: no fix was used, ") && Contains(" newer than the IMU samples"));
    }
  }
  GIVEN("no IMU sample") {
    write_text(imu, read_text(imu).substr(0, read_text(imu).find('\n') + 1));
    THEN("there is nothing to fuse") {
      CHECK_THAT(refusal({recording.log()}), Contains("there is no IMU sample"));
    }
  }
  GIVEN("no fix") {
    const auto fixes = std::filesystem::path(recording.log()) / "ultrasonic.csv";
    write_text(fixes, read_text(fixes).substr(0, read_text(fixes).find('\n') + 1));
    THEN("that is the cause") {
      CHECK_THAT(refusal({recording.log()}), Contains("/log: has no fix"));
    }
  }
}

SCENARIO("a replay that refused most fixes says why and fails") {
  const Recording recording;
  const auto fixes = std::filesystem::path(recording.log()) / "ultrasonic.csv";
  std::istringstream rows(read_text(fixes));
  std::string later;
  for (std::string row; std::getline(rows, row);) {
    const bool is_late = later.size() > 2000 && row.starts_with("17");
    later += (is_late ? "1800" + row.substr(4) : row) + "\n";
  }
  write_text(fixes, later);
  THEN("number, cause and the program that measures the clocks are named") {
    CHECK_THAT(refusal({recording.log()}), Contains(" fixes were refused: ") &&
                                               Contains(" newer than the IMU samples") &&
                                               Contains("`sonopose-calibrate delay "));
  }
}

SCENARIO("programs that run a recording name a wrong mount") {
  const Recording recording;
  const std::vector<std::string> wrong{recording.log(), "--set", "heading.mount_offset_deg=90"};
  const auto mount = Contains("calibration.axes=-y+x+z");
  CHECK_THAT(replay(wrong).error, mount);
  CHECK_THAT(run(SONOPOSE_TEST_EVALUATE, wrong).error, mount);
  CHECK(replay({recording.log(), "--after", "6"}).error.empty());
}

SCENARIO("a log whose clock was set back is replayed to its end") {
  const Recording recording;
  for (const char* const name : {"imu.csv", "ultrasonic.csv", "heading.csv"}) {
    const auto file = std::filesystem::path(recording.log()) / name;
    std::istringstream rows(read_text(file));
    std::string text;
    bool is_set = false;
    for (std::string row; std::getline(rows, row);) {
      const auto comma = row.find(',');
      const bool has_receipt = std::string(name) != "imu.csv";
      const auto available = row.substr(has_receipt ? comma + 1 : 0, 11);  // in units of 0.1 s
      is_set = is_set || (row.starts_with("17") && available >= "17000000060");
      if (is_set) row.replace(0, 8, "16999999");  // 100 s earlier
      if (is_set && has_receipt) row.replace(comma + 1, 8, "16999999");
      text += row + "\n";
    }
    write_text(file, text);
  }
  const json report = report_of({recording.log()});
  CHECK(report["imu_stamps_back"] == 1);
  const int fixes = report["fixes_used"].get<int>() + report["fixes_rejected"].get<int>();
  CHECK(report["fixes_used"].get<int>() > 0.8 * fixes);
}

SCENARIO("what a replay does not use is named") {
  const Recording recording;
  GIVEN("settings of another beacon than the recording's") {
    const Result other = replay({recording.log(), "--set", "beacon.9.admission.min_quality_percent=60"});
    const Result own = replay({recording.log(), "--set", "beacon.7.admission.min_quality_percent=60", "--set",
                               "beacon.9.admission.min_quality_percent=60"});
    THEN("they are named, unless the recording's beacon has its own too") {
      CHECK_THAT(other.error, Contains("not used: the settings of beacon 9; this is beacon 7"));
      CHECK_THAT(own.error, !Contains("not used"));
    }
  }
  GIVEN("an end before the first fix") {
    const Arguments arguments{recording.log(), "--until", "0"};
    THEN("there is no result, and the option is named") {
      CHECK_THAT(refusal(arguments), Contains("/log: has no fix until 0 s (--until)"));
    }
    THEN("its state can be saved nevertheless") {
      Arguments saving = arguments;
      saving.insert(saving.end(), {"--save-state", (recording / "state.json").string()});
      CHECK(replay(saving).code == 0);
    }
  }
  GIVEN("one table instead of its folder, and two folders") {
    THEN("the folder is named, and how many can be read") {
      CHECK_THAT(refusal({recording.log() + "/imu.csv"}), Contains("give the folder, " + recording.log()));
      CHECK_THAT(refusal({recording.log(), recording.log()}),
                 Contains("is a log folder, which is read alone"));
    }
  }
}

SCENARIO("a replay without a score says why and fails") {
  const Recording recording;
  GIVEN("a score that begins after the last pose") {
    THEN("the option is named") {
      CHECK_THAT(refusal({recording.log(), "--after", "60"}),
                 Contains("/log: no score: no pose comes 60 s (--after)"));
    }
    THEN("it is also without a truth, where poses and fixes would have been judged") {
      CHECK_THAT(refusal({Recording(false).log(), "--after", "60"}),
                 Contains("/log: no score: no pose comes 60 s (--after)"));
    }
  }
  GIVEN("a truth of another clock") {
    const auto truth = std::filesystem::path(recording.log()) / "truth.csv";
    write_text(truth, "timestamp [ns],p_x,p_y,p_z\n5,0,0,0\n");
    THEN("no pose has a true position") {
      CHECK_THAT(refusal({recording.log()}),
                 Contains("/log: no score: none of ") && Contains(" of one clock?"));
    }
  }
}

}  // namespace replay_faults_test
