#include "monitor/monitor_report.hpp"

#include "observation/status_words.hpp"
#include "observation/stream_state.hpp"
#include "observation/views.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <set>
#include <sstream>

namespace monitor_report_test {

using namespace sonopose;
using namespace sonopose::monitor;
using namespace sonopose::observation;
using Catch::Contains;
using Catch::StartsWith;
using namespace sonopose::test;

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST_CASE("every status bit has its own name") {
  CHECK(observation::status_words(0) == "ok");
  CHECK(observation::status_words(status_stale | status_low_trust) == "stale, low trust");
  CHECK(observation::status_words(status_stale | status_frozen_track) == "frozen track");
  std::set<std::string> words;
  for (std::uint32_t bit = status_initialising; bit <= status_fixes_inconsistent; bit <<= 1U) {
    const std::string word = observation::status_words(bit);
    CHECK(!word.empty());
    CHECK(word != "ok");
    words.insert(word);
  }
  CHECK(words.size() == 14);
}

SCENARIO("the table has a row for each beacon") {
  GIVEN("a beacon with poses and a silent one") {
    const std::string table = table_of({good_view(), silent_view()});
    THEN("a row has rates, position, heading, speed, latency in milliseconds, losses and status") {
      CHECK(lines_in(table) >= 3);
      const std::size_t begin = table.find('\n') + 1;
      const std::string row = table.substr(begin, table.find('\n', begin) - begin);
      for (const char* part : {"7", "100.0", "99.5", "12.0", "1.500", "-2.250", "0.750", "90.0°", "5.00",
                               "0.12", "0.34", "17", "ok"}) {
        CHECK_THAT(row, Contains(part));
      }
      CHECK_THAT(table, Contains("    21  ") && Contains("silent"));
    }
    THEN("what is not known of the silent one is marked, not zero") {
      const std::string row = table.substr(table.find("    21  "));
      CHECK_THAT(
          row.substr(0, row.find('\n')),
          StartsWith("    21    0.0/    –/   –        –       –       –       –°") && !Contains("0.00"));
    }
    THEN("the latency segments and the slowest pose follow, in milliseconds") {
      CHECK_THAT(table, Contains("1.00/2.00") && Contains("0.05/0.11") && Contains("0.01/0.02") &&
                            Contains("0.06/0.21") && Contains("2.00 = 0.50 + 0.25 + 1.25 (event 812)"));
    }
    THEN("the problem counters of each process follow, without processes that counted none") {
      CHECK_THAT(table,
                 Contains("7  bridge: 4 damaged frames\n") &&
                     Contains("7  fusion: 2 fixes too late, 3 IMU deadlines missed, 17 events lost\n") &&
                     Contains("7  here: 8 pose deadlines missed, 2 pose stream losses\n") &&
                     !Contains("21  here"));
    }
  }
  GIVEN("a beacon whose fusion estimates the sensors") {
    BeaconView view = good_view();
    view.estimate = estimate();
    const std::string table = table_of({view, silent_view()});
    THEN("each value has its unit and standard deviation, and what is not estimated is listed") {
      CHECK_THAT(table,
                 Contains("beacon  estimated                        x               y               z\n"
                          "     7  gyro bias            0.0010±0.0004  -0.0020±0.0004   0.0305±0.0004 rad/s\n"
                          "     7  accelerometer bias   0.0500±0.0100   0.0000±0.0100   0.0000±0.0100 m/s²\n"
                          "     7  lever arm            0.1000±0.0030  0.0200±10.2500 -12.5000±0.0030 m\n"
                          "     7  fix noise                   0.0210 m\n"
                          "     7  heading noise        1.0000±0.1000 deg\n"
                          "     7  not estimated: delay\n"));
    }
    THEN("no line of it is longer than 80 columns, even without any value") {
      view.estimate = Estimate{};
      const std::string nothing = table_of({view});
      for (const std::string& text : {table, nothing}) {
        std::istringstream lines(text.substr(text.find("beacon  estimated")));
        for (std::string line; std::getline(lines, line) && !line.empty();) {
          CAPTURE(line);
          const auto is_first_byte = [](char byte) {
            return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
          };
          CHECK(std::count_if(line.begin(), line.end(), is_first_byte) <= 80);
        }
      }
      CHECK_THAT(nothing, Contains("     7  not estimated: gyro bias, accelerometer bias, lever arm, delay,\n"
                                   "          fix noise, heading noise\n"));
    }
  }
  GIVEN("a beacon without a pose writer, and one with a silent IMU") {
    BeaconView lost = good_view();
    lost.lost = true;
    BeaconView silent = good_view();
    silent.fusion->imu_silent = true;
    BeaconView mixed = good_view();
    mixed.bridge->other_bridges = 1;
    BeaconView played = good_view();
    played.segments[0] = observation::percentiles_of({});
    BeaconView overhead = good_view();
    overhead.wrong_tilt_rad = 3.1;
    THEN("the status column shows it, as it does several bridges") {
      CHECK_THAT(table_of({mixed}), Contains("several bridges") && !Contains("several bridges, ok") &&
                                        Contains("bridge: 4 damaged frames, 1 other bridge\n"));
      CHECK(severity_of(mixed) >= observation::bad_severity);
      CHECK_THAT(table_of({played}), Contains("– old stamps"));
      CHECK_THAT(table_of({lost}), Contains("17  lost\n"));
      CHECK_THAT(table_of({silent}), Contains("IMU silent"));
      CHECK_THAT(table_of({overhead}), Contains("IMU upside down") && !Contains("down, ok"));
      CHECK(severity_of(overhead) > 0);
      CHECK(severity_of(overhead) < observation::bad_severity);
    }
  }
  GIVEN("a beacon with a standby") {
    BeaconView view = good_view();
    view.fusions.front().role = FusionRole::serving;
    view.fusions.front().strength = 200;
    FusionStatus standby;
    standby.role = FusionRole::serving;
    standby.strength = 100;
    standby.imu_gaps = 1;
    view.fusions.push_back(standby);
    THEN("the counters of each fusion are listed with its strength") {
      CHECK_THAT(table_of({view}), Contains("fusion of strength 200 (serving): 2 fixes too late, 3 IMU") &&
                                       Contains("fusion of strength 100 (serving): 1 IMU gap\n"));
    }
  }
}

SCENARIO("the summary describes a run") {
  THEN("a run with a beacon: rates, latency, error, fixes and losses") {
    const std::string summary = summary_of({good_view()});
    CHECK_THAT(summary, Contains("beacon 7") && Contains("100.0 Hz") && Contains("p50 0.12 ms") &&
                            Contains("p99 0.34 ms") && Contains("2.1 cm RMS") && Contains("5.5 cm at most") &&
                            Contains("110 used, 9 of them down-weighted, 6 rejected (2 too late)") &&
                            Contains("17 events") && Contains("8 pose deadlines"));
  }
  THEN("a beacon without ground truth: no error") {
    CHECK_THAT(summary_of({silent_view()}), Contains("beacon 21") && !Contains("error"));
  }
  THEN("a run without a beacon") {
    CHECK(summary_of({}) == "no pose received\n");
  }
}

}  // namespace monitor_report_test
