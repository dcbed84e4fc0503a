/// Names and texts of strangers on the bus and in files, in everything that the programs print.

#include "clocks/clocks.hpp"
#include "mcap/file_sink.hpp"
#include "mcap/writer.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"
#include "system/doctor_run.hpp"

#include <nlohmann/json.hpp>

#include <csignal>
#include <sstream>

namespace sonopose::foreign_text_test {

using namespace sonopose::test;
using Catch::Contains;
namespace topics = dds::topics;

/// Sets the title of a terminal, rings its bell, and continues with a line of another program. Followed by
/// bytes that are not UTF-8, a control character of C1, and DEL.
const std::string hostile = "x\x1b]0;owned\a\nsonopose-fusion: error: forged\r\nforged\xff\xc3\xc2\x9b\x7f";
constexpr double huge = 1e308;

/// Checks that a text is UTF-8 without control characters, and that no line is that of the stranger.
void check_printed(const std::string& text) {
  CAPTURE(text);
  CHECK_NOTHROW(nlohmann::json(text).dump());  // throws unless it is UTF-8
  bool has_control = text.find('\x7f') != std::string::npos;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    has_control = has_control || (byte < ' ' && byte != '\n' && byte != '\t');
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : ' ');
    has_control = has_control || (byte == 0xc2 && next >= 0x80 && next <= 0x9f);
  }
  CHECK_FALSE(has_control);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    CHECK_FALSE(line.starts_with("forged"));
    CHECK_FALSE(line.starts_with("sonopose-fusion: error"));
  }
}

void check_printed(const Process& process) {
  check_printed(process.text(Stream::output));
  check_printed(process.text(Stream::error));
}

void check_printed(const Result& result) {
  check_printed(result.output);
  check_printed(result.error);
}

/// Writes hostile texts and huge numbers to the topics of reports.
class Stranger {
public:
  explicit Stranger(const Bus& bus) : participant_(dds::ext::participant({.domain_id = bus.domain_id()})) {
    for (std::uint64_t i = 0; i < 6; ++i) {
      line_.write(topics::to_idl(LineStatus{.name = std::to_string(i) + hostile,
                                            .bridge_id = 1,
                                            .time_ns = clocks::host_now(),
                                            .state = static_cast<LineState>(i),
                                            .text = hostile}));
    }
    log_.write(topics::to_idl(LogLine{.host = hostile,
                                      .process_id = 1,
                                      .number = 1,
                                      .time_ns = clocks::host_now(),
                                      .program = hostile,
                                      .level = LogLevel::error,
                                      .text = hostile}));
    const EffectiveSettings settings{.address = all_beacons, .time_ns = 1, .values = {{hostile, hostile}}};
    settings_.write(topics::to_idl(settings).sample());
    BeaconStatus bridge;
    bridge.address = 7;
    bridge.battery_v = bridge.rssi_dbm = huge;
    bridge.imu_rate_hz = bridge.fix_rate_hz = bridge.clock_offset_s = bridge.clock_jitter_s = -huge;
    bridge_.write(topics::to_idl(bridge));
    FusedPose pose;
    pose.address = 7;
    pose.time_ns = clocks::host_now();
    pose.position_world_m = pose.velocity_world_mps = Vector3d::Constant(huge);
    pose.since_valid_fix_s = pose.trust = huge;
    pose_.write(topics::to_idl(pose));
  }

private:
  dds::domain::DomainParticipant participant_;
  dds::qos::Provider qos_;
  dds::pub::DataWriter<sonopose_LineStatus> line_ =
      topics::make_writer(participant_, qos_, topics::line_status);
  dds::pub::DataWriter<sonopose_LogLine> log_ = topics::make_writer(participant_, qos_, topics::log);
  dds::pub::DataWriter<sonopose_EffectiveSettings> settings_ =
      topics::make_writer(participant_, qos_, topics::settings);
  dds::pub::DataWriter<sonopose_BeaconStatus> bridge_ =
      topics::make_writer(participant_, qos_, topics::beacon_status);
  dds::pub::DataWriter<sonopose_FusedPose> pose_ = topics::make_writer(participant_, qos_, topics::pose);
  /// Without one the doctor searches other domains.
  dds::pub::DataWriter<sonopose_ImuSample> imu_ = topics::make_writer(participant_, qos_, topics::imu);
};

SCENARIO("no text of a stranger on the bus is a command for a terminal, or a line of its own") {
  GIVEN("a stranger on the bus") {
    const Bus bus;
    const Stranger stranger(bus);
    THEN("the monitor prints tables") {
      const auto monitor = bus.monitor({});
      REQUIRE(monitor->wait_for_line(Stream::output, "forged"));
      monitor->end_by(SIGINT);
      check_printed(*monitor);
    }
    THEN("the monitor prints JSON") {
      const auto monitor = bus.monitor({"--json"});
      REQUIRE(monitor->wait_for_line(Stream::output, "forged"));
      monitor->end_by(SIGINT);
      check_printed(*monitor);
      for (const std::string& line : monitor->lines(Stream::output)) {
        CHECK(nlohmann::json::parse(line).is_object());
      }
    }
    THEN("the monitor prints samples, whose texts are those of the stranger") {
      for (const std::string topic : {"line_status", "log", "settings"}) {
        const auto echo = bus.monitor({"--echo", topic, "--count", "1"});
        CHECK(echo->wait_for_exit() == 0);
        check_printed(*echo);
        REQUIRE(echo->lines(Stream::output).size() == 1);
        const auto sample = nlohmann::json::parse(echo->lines(Stream::output).front());
        const auto text =
            (topic == "settings" ? sample["values"][0]["key"] : sample["text"]).get<std::string>();
        CHECK(text.starts_with("x\x1b]0;owned\a\nsonopose-fusion: error: forged\r\nforged"));
      }
    }
    THEN("the doctor reports findings") {
      for (const Arguments& more : {Arguments{}, Arguments{"--verbose"}, Arguments{"--json"}}) {
        Arguments arguments{"--duration", "1"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Result result = look_for("forged", bus.domain_id(), arguments);
        check_printed(result);
        CHECK_THAT(result.output, Contains("forged"));
      }
    }
    THEN("settings are printed") {
      for (const Arguments& arguments : {Arguments{"get"}, Arguments{"get", "--json"}}) {
        const Result result = bus.settings(arguments);
        check_printed(result);
        CHECK_THAT(result.output, Contains("forged"));
      }
    }
  }
}

SCENARIO("no text in an MCAP file is a command for a terminal, or a line of its own") {
  const TemporaryFolder folder;
  const std::string file = folder / "run.mcap";
  {
    mcap::FileSink sink(file);
    mcap::Writer writer(sink, {.profile = hostile, .library = hostile});
    const auto schema = writer.add_schema(hostile, hostile, hostile);
    for (const std::string& topic : {hostile, std::string("sonopose/imu")}) {
      const auto channel = writer.add_channel(schema, topic, hostile, {{hostile, hostile}});
      writer.write(
          {.channel_id = channel, .sequence = 1, .log_time_ns = 1, .publish_time_ns = 1, .data = {}});
    }
    writer.write_metadata({.name = hostile, .values = {{hostile, hostile}}});
    writer.close();
  }
  for (const Arguments& arguments :
       {Arguments{"info", file}, Arguments{"info", file, "--json"}, Arguments{"info", file, "--verify"}}) {
    const Result result = run(SONOPOSE_TEST_MCAP, arguments);
    check_printed(result);
    CHECK_THAT(result.output, Contains("forged"));
  }
  for (const Arguments& arguments : {Arguments{"cat", file}, Arguments{"cat", file, "--topics", "none"},
                                     Arguments{"filter", file, "--out", folder / "a.mcap"},
                                     Arguments{"export", file, "--out", folder / "log"}}) {
    check_printed(run(SONOPOSE_TEST_MCAP, arguments));
  }
  check_printed(run(SONOPOSE_TEST_REPLAY, {file}));
  const Bus bus;
  const auto play = bus.play({file});
  CHECK(play->wait_for_exit() == 1);
  check_printed(*play);
  CHECK_THAT(play->text(Stream::error), Contains("forged"));
}

SCENARIO("no cell of a table is a command for a terminal, or a line of its own") {
  const TemporaryFolder folder;
  const std::string cell = "x\x1b]0;owned\a\xff\xc2\x9b\x7f";
  const std::string header = "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z";
  const std::string imu = GENERATE_COPY(header + "," + cell + "\n1,0,0,0,0,0,9.8,0\n",  //
                                        header + "\n1,0,0,0,0,0," + cell + "\n",        //
                                        cell + "\n1\n",                                 //
                                        header + "\n1,0,0,0,1e308,0,9.8\n");
  write_text(folder / "imu.csv", imu);
  write_text(folder / "ultrasonic.csv", "#timestamp [ns],received [ns],x,y,z,quality\n1,2,0,0,0,90\n");
  write_text(folder / "heading.csv", "#timestamp [ns],received [ns],heading [deg]\n1,2,45\n");
  const Result replay = run(SONOPOSE_TEST_REPLAY, {folder.path().string()});
  check_printed(replay);
  if (imu.find('\x1b') != std::string::npos) {
    CHECK_THAT(replay.output + replay.error, Contains("csv") && Contains("x\\x1b"));
  }
  check_printed(run(SONOPOSE_TEST_EVALUATE, {folder.path().string()}));
  write_text(folder / "meta.toml", R"("x\u001b" = "\u0007\u009b")");
  const Result of_meta = run(SONOPOSE_TEST_REPLAY, {folder.path().string()});
  check_printed(of_meta);
  CHECK_THAT(of_meta.error, Contains(R"(x\x1b: unknown key)"));
}

}  // namespace sonopose::foreign_text_test
