/// The program sonopose-attitude.

#include "support/checked_run.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace attitude_test {

using namespace sonopose::test;
using Catch::Contains;
using nlohmann::json;

/// Simulates a walk, which has no magnetometer, and returns its folder.
std::string walk_in(const TemporaryFolder& folder) {
  std::string log = (folder / "walk").string();
  output_of(SONOPOSE_TEST_SIMULATE, {"walk", "--out", log, "--seed", "3", "--duration", "30"});
  return log;
}

std::string refusal(const std::vector<std::string>& arguments) {
  return refusal_of(SONOPOSE_TEST_ATTITUDE, arguments);
}

double inclination_of(const std::vector<std::string>& arguments) {
  return json::parse(output_of(SONOPOSE_TEST_ATTITUDE, arguments))
      .at("mean")
      .at("inclination_rmse_deg")
      .get<double>();
}

SCENARIO("each filter processes a log, is scored and writes its trajectory") {
  const TemporaryFolder folder;
  const std::string log = walk_in(folder);
  for (const char* const filter : {"adaptive", "mahony", "complementary", "ahrs", "gyro"}) {
    INFO(filter);
    CHECK(inclination_of({log, "--filter", filter, "--json"}) < 8.0);
  }
  CHECK(inclination_of({log, "--filter", "mahony", "--json"}) ==
        inclination_of({log, "--set", "documented.attitude.filter=mahony", "--json"}));
  CHECK(inclination_of({log, "--filter", "mahony", "--set", "documented.attitude.mahony.kp=2", "--json"}) !=
        inclination_of({log, "--filter", "mahony", "--json"}));
  THEN("settings of another beacon are named, and those of the Kalman engine are no mistake") {
    const Result result = run(SONOPOSE_TEST_ATTITUDE, {log, "--set", "kalman.twist.std_mps=0.07", "--set",
                                                       "beacon.9.documented.attitude.mahony.kp=2"});
    REQUIRE(result.code == 0);
    CHECK_THAT(result.error,
               Contains("not used: the settings of beacon 9") && !Contains("kalman.twist.std_mps"));
  }
  THEN("it also writes the trajectory on request") {
    const std::string out = (folder / "out").string();
    const std::string report = output_of(SONOPOSE_TEST_ATTITUDE, {log, "--out", out});
    CHECK_THAT(report, Contains("inclination") && Contains("walk"));
    std::istringstream lines(read_text(folder / "out/walk.tum"));
    std::string line;
    std::getline(lines, line);
    REQUIRE(std::getline(lines, line));
    std::istringstream row(line);
    double time_s = 0;
    double x = 1;
    double y = 1;
    double z = 1;
    std::array<double, 4> q{};
    row >> time_s >> x >> y >> z >> q[0] >> q[1] >> q[2] >> q[3];
    CHECK(!row.fail());
    CHECK(std::abs(x) + std::abs(y) + std::abs(z) == 0.0);
    CHECK(std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])) == Approx(1.0));
  }
}

SCENARIO("a log without a true attitude is named") {
  const TemporaryFolder folder;
  const std::string log = walk_in(folder);
  std::filesystem::remove(folder / "walk/truth.csv");
  const Result result = run(SONOPOSE_TEST_ATTITUDE, {log});
  CHECK(result.code == 1);
  CHECK_THAT(result.error, Contains("walk: not scored: no sample has a true attitude; --out"));
  CHECK(run(SONOPOSE_TEST_ATTITUDE, {log, "--out", (folder / "out").string()}).code == 0);
}

SCENARIO("sonopose-attitude refuses invalid requests") {
  const TemporaryFolder folder;
  const std::string log = walk_in(folder);
  CHECK_THAT(refusal({log, "--magnetometer", "on"}), Contains("imu.csv") && Contains("no magnetometer"));
  CHECK_THAT(refusal({log, "--filter", "kalman"}), Contains("kalman") && Contains("mahony"));
  CHECK_THAT(refusal({(folder / "nowhere").string()}), Contains("nowhere: does not exist"));
  CHECK_THAT(refusal({log, log, "--out", (folder / "out").string()}),
             Contains("two logs have the name walk"));
  CHECK_THAT(refusal({log, "--set", "documented.attitude.ahrs.gain=11"}),
             Contains("documented.attitude.ahrs.gain") && Contains("0 … 10"));
}

}  // namespace attitude_test
