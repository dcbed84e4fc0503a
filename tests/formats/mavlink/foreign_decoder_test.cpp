/// A decoder that is not ours reads our messages.

#include "formats/mavlink/flying.hpp"
#include "mavlink/messages.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace mavlink_foreign_decoder_test {

using namespace sonopose;
using namespace sonopose::test;
using nlohmann::json;

SCENARIO("node-mavlink decodes every message that we send") {
  if (run("/usr/bin/env", {"node", "-e", "require('node-mavlink')"}).code != 0) {
    std::cout << "skipped: no node with node-mavlink; npm install node-mavlink, and set "
                 "NODE_PATH=$PWD/node_modules\n";
    return;
  }
  constexpr mavlink::Identity own{5, mavlink::own_component};
  const mavlink::PoseMessageFields fields{
      .time_ns = flying::stamp_ns, .in_ned = true, .reset_counter = 200, .quality_percent = 100};
  auto without_yaw = flying::odometry();
  without_yaw.q_body_to_frame.reset();
  mavlink::Frame request{.message_id = 111, .sender = {5, 1}};
  request.payload[8] = 77;
  const std::vector frames{mavlink::heartbeat(own), mavlink::odometry(flying::odometry(), own, fields),
                           mavlink::odometry(without_yaw, own, fields),
                           mavlink::vision_position_estimate(flying::odometry(), own, fields),
                           *timesync_answer(request, own, flying::stamp_ns)};
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "sent.bin";
  {
    std::ofstream out(file, std::ios::binary);
    std::uint8_t sequence = 250;
    for (const auto& frame : frames) {
      for (const std::uint8_t byte : encode(frame, sequence++)) out.put(static_cast<char>(byte));
    }
  }
  const Result result =
      run("/usr/bin/env", {"node", SONOPOSE_SOURCE_DIR "/tests/interop/mavlink_lines.cjs", file.string()});
  CAPTURE(result.output, result.error);
  REQUIRE(result.code == 0);
  std::vector<json> read;
  std::istringstream lines(result.output);
  for (std::string line; std::getline(lines, line);) read.push_back(json::parse(line));
  REQUIRE(read.size() == frames.size());
  for (const json& each : read) {
    CHECK(each["magic"] == 0xFD);
    CHECK(each["sysid"] == 5);
    CHECK(each["compid"] == 197);
  }
  CHECK(read[0]["name"] == "HEARTBEAT");
  CHECK(read[0]["data"]["autopilot"] == 8);
  CHECK(read[0]["data"]["type"] == 18);

  const json& odometry = read[1]["data"];
  CHECK(read[1]["name"] == "ODOMETRY");
  CHECK(odometry["timeUsec"] == "1700000000123456");
  CHECK(odometry["frameId"] == 1);
  CHECK(odometry["childFrameId"] == 12);
  CHECK(odometry["x"] == 1);
  CHECK(odometry["z"] == -3);
  CHECK(odometry["vy"] == 5);
  CHECK(odometry["yawspeed"].get<double>() == Approx(0.9));
  CHECK(odometry["q"][0].get<double>() == Approx(flying::odometry().q_body_to_frame->w()));
  CHECK(odometry["q"][3].get<double>() == Approx(flying::odometry().q_body_to_frame->z()));
  CHECK(odometry["poseCovariance"][20] == 56);
  CHECK(odometry["velocityCovariance"][11].get<double>() == Approx(0.3));
  CHECK(odometry["resetCounter"] == 200);
  CHECK(odometry["estimatorType"] == 2);  // MAV_ESTIMATOR_TYPE_VISION
  CHECK(odometry["quality"] == 100);
  CHECK(read[2]["data"]["q"][0] == "NaN");

  const json& vision = read[3]["data"];
  CHECK(read[3]["name"] == "VISION_POSITION_ESTIMATE");
  CHECK(vision["roll"].get<double>() == Approx(0.1));
  CHECK(vision["pitch"].get<double>() == Approx(0.2));
  CHECK(vision["yaw"].get<double>() == Approx(0.3));
  CHECK(vision["covariance"][0] == 1);
  CHECK(vision["resetCounter"] == 200);

  CHECK(read[4]["name"] == "TIMESYNC");
  CHECK(read[4]["data"]["tc1"] == std::to_string(flying::stamp_ns));
  CHECK(read[4]["data"]["ts1"] == "77");
  CHECK(read[4]["data"]["targetComponent"] == 1);
}

}  // namespace mavlink_foreign_decoder_test
