/// Invalid input is refused at startup with a message that locates the error.

#include "mcap/file_sink.hpp"
#include "mcap/writer.hpp"
#include "support/bus.hpp"
#include "support/checked_run.hpp"
#include "support/temporary_folder.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace refusal_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;

/// Runs a program in a private domain that must exit with an error; returns its message.
std::string refusal(const char* program, const Arguments& arguments, const Environment& changes = {}) {
  const TestDomain domain;
  Environment environment = neutral;
  environment["ROS_DOMAIN_ID"] = std::to_string(domain.id());
  for (const auto& [name, value] : changes) environment[name] = value;
  return refusal_of(program, arguments, environment);
}

/// Runs the fusion with an invalid configuration file; returns the message.
std::string refused_config(const std::string& toml) {
  const TemporaryFolder folder;
  write_text(folder / "fusion.toml", toml);
  std::string said = refusal(SONOPOSE_TEST_FUSION, {"--config", (folder / "fusion.toml").string()});
  CHECK_THAT(said, Contains((folder / "fusion.toml").string()));
  return said;
}

/// Runs the fusion with the project's QoS file in which one text is replaced; returns the message.
std::string refused_qos(const std::string& right, const std::string& wrong) {
  const TemporaryFolder folder;
  std::string xml = read_text(std::filesystem::path(SONOPOSE_SOURCE_DIR) / "qos" / "sonopose.xml");
  const std::size_t place = xml.find(right);
  REQUIRE(place != std::string::npos);
  const auto line = 1 + std::count(xml.begin(), xml.begin() + static_cast<std::ptrdiff_t>(place), '\n');
  write_text(folder / "qos.xml", xml.replace(place, right.size(), wrong));
  std::string said = refusal(SONOPOSE_TEST_BRIDGE, {"--qos", (folder / "qos.xml").string()});
  CHECK_THAT(said, Contains((folder / "qos.xml").string() + ":" + std::to_string(line) + ":"));
  return said;
}

SCENARIO("a fusion refuses an invalid configuration") {
  WHEN("a key is misspelt") {
    const std::string said = refused_config("[documented.drift]\n\ndecay_rat_hz = 2.0\n");
    THEN("file, line and key are named, and the nearest key") {
      CHECK_THAT(said, Contains("fusion.toml:3:") && Contains("'documented.drift.decay_rat_hz'") &&
                           Contains("'documented.drift.decay_rate_hz'"));
    }
  }
  WHEN("a value is out of range") {
    const std::string said = refused_config("[documented.drift]\ndecay_rate_hz = 1000.0\n");
    THEN("file, line, key, value and limits are named") {
      CHECK_THAT(said, Contains("fusion.toml:2:") && Contains("documented.drift.decay_rate_hz") &&
                           Contains("1000") && Contains("0 … 50"));
    }
  }
  WHEN("a value has the wrong type") {
    const std::string said = refused_config("[documented.drift]\ndecay_rate_hz = \"fast\"\n");
    THEN("file, line, key, value and the allowed values are named") {
      CHECK_THAT(said, Contains("fusion.toml:2:") && Contains("documented.drift.decay_rate_hz") &&
                           Contains("fast") && Contains("type") && Contains("0 … 50"));
    }
  }
  WHEN("an override of one beacon is misspelt") {
    const std::string said = refused_config("[beacon.7.documented.drift]\ndecay_rate = 1.0\n");
    THEN("file, line and key are named") {
      CHECK_THAT(said, Contains("fusion.toml:2:") && Contains("drift.decay_rate"));
    }
  }
  WHEN("the file is not TOML") {
    THEN("file and line are named") {
      CHECK_THAT(refused_config("[documented.drift]\ndecay_rate_hz = = 2\n"), Contains("fusion.toml:2:"));
    }
  }
  WHEN("the file does not exist") {
    THEN("it is named") {
      CHECK_THAT(refusal(SONOPOSE_TEST_FUSION, {"--config", "/no/such.toml"}),
                 Contains("/no/such.toml: does not exist"));
    }
  }
  WHEN("--set has a value out of range") {
    THEN("the argument, the value and the limits are named") {
      CHECK_THAT(refusal(SONOPOSE_TEST_FUSION, {"--set", "documented.drift.decay_rate_hz=-1"}),
                 Contains("--set documented.drift.decay_rate_hz=-1") && Contains("0 … 50"));
    }
  }
}

SCENARIO("a program refuses an invalid QoS file") {
  WHEN("an element is unknown") {
    THEN("file, line and element are named") {
      CHECK_THAT(refused_qos("<history><kind>KEEP_LAST_HISTORY_QOS</kind><depth>64</depth></history>",
                             "<histroy><kind>KEEP_LAST_HISTORY_QOS</kind><depth>64</depth></histroy>"),
                 Contains("<histroy>"));
    }
  }
  WHEN("a deadline is zero") {
    const std::string said = refused_qos("<deadline><period><sec>0</sec><nanosec>100000000</nanosec>",
                                         "<deadline><period><sec>0</sec><nanosec>0</nanosec>");
    THEN("file, line and element are named") {
      CHECK_THAT(said, Contains("<period>"));
    }
  }
  WHEN("the file does not exist") {
    THEN("it is named") {
      CHECK_THAT(refusal(SONOPOSE_TEST_MONITOR, {"--qos", "/no/such.xml"}),
                 Contains("/no/such.xml: does not exist") && Contains("--qos"));
    }
  }
  WHEN("the environment names a file that cannot be used") {
    struct Mistake {
      const char* text;  ///< null: there is no file
      const char* reason;
    };
    const auto mistake = GENERATE(values<Mistake>({
        {nullptr, ": does not exist"},
        {"policies: none", ":1: not well-formed XML"},
        {"<dds>\n<qos_library name=\"sonopose\">\n<qos_profile name=\"Fixx\"/></qos_library></dds>\n",
         ":3: <qos_profile>: there is no profile"},
        {"<dds>\n<qos_library name=\"sonopose\">\n<qos_profile name=\"Fix\"><datawriter_qos>\n<deadlyne/>"
         "</datawriter_qos></qos_profile></qos_library></dds>\n",
         ":4: <deadlyne>: unknown element"},
    }));
    const TemporaryFolder folder;
    const std::string path = (folder / "qos.xml").string();
    if (mistake.text != nullptr) write_text(path, mistake.text);
    THEN(
        "variable, file, line and element are named, with the code of a wrong file, by readers and writers") {
      for (const char* const program : {SONOPOSE_TEST_FUSION, SONOPOSE_TEST_BRIDGE, SONOPOSE_TEST_MONITOR}) {
        Environment environment = neutral;
        environment["SONOPOSE_QOS"] = path;
        const Result result = run(program, {}, environment);
        CHECK(result.code == 78);
        CHECK_THAT(result.error, Contains("SONOPOSE_QOS: " + path + mistake.reason));
      }
    }
  }
}

SCENARIO("a program refuses a domain that does not exist") {
  for (const char* program : {SONOPOSE_TEST_BRIDGE, SONOPOSE_TEST_FUSION, SONOPOSE_TEST_MONITOR}) {
    CHECK_THAT(refusal(program, {"--domain", "233"}),
               Contains("--domain") && Contains("233") && Contains("232"));
    CHECK_THAT(refusal(program, {"--domain", "seven"}), Contains("--domain") && Contains("seven"));
    CHECK_THAT(refusal(program, {}, {{"ROS_DOMAIN_ID", "abc"}}),
               Contains("ROS_DOMAIN_ID") && Contains("abc") && Contains("232"));
  }
}

SCENARIO("a bridge refuses an invalid input") {
  const TemporaryFolder folder;
  const auto refused = [](const Arguments& arguments) { return refusal(SONOPOSE_TEST_BRIDGE, arguments); };
  WHEN("the log folder does not exist or is not given") {
    THEN("the error message says so") {
      CHECK_THAT(refused({"--source", "log", "--input", "/no/such/log"}),
                 Contains("/no/such/log: does not exist"));
      CHECK_THAT(refused({"--source", "log"}), Contains("--input"));
    }
  }
  WHEN("a cell of a log is not a number") {
    write_text(folder / "imu.csv", "#timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n1000,0,0,0,0,zero,9.81\n");
    write_text(folder / "ultrasonic.csv", "#t,r,x,y,z,q\n");
    THEN("file, line and value are named") {
      CHECK_THAT(refused({"--source", "log", "--input", folder.path().string()}),
                 Contains("imu.csv:2") && Contains("zero"));
    }
  }
  WHEN("the meta.toml of a log has a wrong value") {
    write_text(folder / "imu.csv", "#timestamp,w_x,w_y,w_z,a_x,a_y,a_z\n");
    write_text(folder / "ultrasonic.csv", "#t,r,x,y,z,q\n");
    write_text(folder / "meta.toml", "imu_meaning = \"average\"\n");
    const std::string said = "meta.toml:1: imu_meaning: \"average\" is not one of unknown, instant, mean";
    THEN("file, line, key, value and the allowed values are named, by the programs that read logs") {
      const std::string log = folder.path().string();
      CHECK_THAT(refused({"--source", "log", "--input", log}), Contains(said));
      CHECK_THAT(refusal(SONOPOSE_TEST_REPLAY, {log}), Contains(said));
      CHECK_THAT(refusal(SONOPOSE_TEST_ATTITUDE, {log}), Contains(said));
    }
  }
  WHEN("--imu-meaning is no meaning, or the source declares it") {
    THEN("option, value and what is allowed are named") {
      CHECK_THAT(refused({"--source", "udp", "--imu-meaning", "average"}),
                 Contains("--imu-meaning: 'average' is not one of unknown, instant, mean"));
      CHECK_THAT(refused({"--imu-meaning", "mean"}), Contains("--imu-meaning") && Contains("not with sim"));
      CHECK_THAT(refused({"--source", "log", "--imu-meaning", "mean"}), Contains("not with log"));
    }
  }
  WHEN("the stream file cannot be read") {
    THEN("it is named") {
      CHECK_THAT(refused({"--source", "stream", "--input", "/no/such.bin"}), Contains("/no/such.bin"));
      CHECK_THAT(refused({"--source", "stream", "--input", folder.path().string()}),
                 Contains(folder.path().string()));
    }
  }
  WHEN("--listen is not an address of this machine") {
    THEN("it is named") {
      CHECK_THAT(refused({"--source", "udp", "--listen", "nonsense"}), Contains("nonsense"));
      CHECK_THAT(refused({"--source", "udp", "--listen", "127.0.0.1:99999"}), Contains("99999"));
      CHECK_THAT(refused({"--source", "udp", "--from", "modem"}), Contains("\"modem\" is not a numeric IP"));
      CHECK_THAT(refused({"--source", "sim", "--from", "10.0.0.5"}),
                 Contains("only works with --source udp"));
      CHECK_THAT(refused({"--source", "udp", "--listen", "192.0.2.1:5000"}), Contains("192.0.2.1:5000"));
    }
  }
  WHEN("an option belongs to another source, also where none was named") {
    THEN("option and sources are named") {
      CHECK_THAT(refused({"--device", "/dev/ttyACM0"}),
                 Contains("--device only works with --source serial, not with sim"));
      CHECK_THAT(refused({"--source", "serial", "--rate", "2"}),
                 Contains("--rate only works with --source sim, log, mcap or stream, not with serial"));
    }
  }
  WHEN("the seed is negative") {
    THEN("option, value and limits are named") {
      CHECK_THAT(refused({"--seed", "-1"}), Contains("--seed: Value -1 not in range [0 - 1000000000]"));
    }
  }
  WHEN("the device is not a serial line") {
    THEN("it is named") {
      CHECK_THAT(refused({"--source", "serial", "--device", folder.path().string()}),
                 Contains(folder.path().string()));
      CHECK_THAT(refused({"--source", "serial", "--device", "/dev/null"}),
                 Contains("--device: \"/dev/null\" is not a serial device"));
      CHECK_THAT(refused({"--source", "serial", "--device", "COM3"}),
                 Contains("--device: \"COM3\" is not a serial device"));
    }
  }
  WHEN("a path is empty or blank, as by an unset variable of a shell") {
    THEN("its option is named") {
      CHECK_THAT(refused({"--source", "serial", "--device", " "}), Contains("--device: the path is blank"));
      CHECK_THAT(refused({"--source", "serial", "--device", ""}), Contains("--device: the path is empty"));
      CHECK_THAT(refused({"--record", ""}), Contains("--record: the path is empty"));
      CHECK_THAT(refusal(SONOPOSE_TEST_RECORD, {""}), Contains("file: the path is empty"));
      CHECK_THAT(refusal(SONOPOSE_TEST_FUSION, {"--config", ""}), Contains("--config: the path is empty"));
    }
  }
  WHEN("the stream file has sentences of a beacon in NMEA mode") {
    std::string sentences;
    for (int i = 0; i < 20; ++i) sentences += "$GPGLL,4916.45,N,12311.12,W,225444,A*31\r\n";
    write_text(folder / "nmea.bin", sentences);
    THEN("file, protocol and the setting of the beacon are named") {
      CHECK_THAT(refused({"--source", "stream", "--input", (folder / "nmea.bin").string()}),
                 Contains("nmea.bin: NMEA sentences ($GPGLL)") && Contains("Dashboard"));
    }
  }
  WHEN("the scenario, the source or the rate does not exist") {
    THEN("it is named with the existing ones") {
      CHECK_THAT(refused({"--scenario", "swim"}), Contains("swim") && Contains("walk"));
      CHECK_THAT(refused({"--source", "dream"}), Contains("dream") && Contains("serial"));
      CHECK_THAT(refused({"--rate", "-1"}), Contains("--rate") && Contains("-1"));
    }
  }
  WHEN("more beacons are requested than there are addresses") {
    THEN("number, address and limit are named") {
      CHECK_THAT(refused({"--beacons", "1000", "--address", "65000"}),
                 Contains("1000") && Contains("65000") && Contains("65534"));
      CHECK_THAT(refused({"--beacons", "1001"}), Contains("--beacons") && Contains("1001"));
      CHECK_THAT(refused({"--beacons", "2", "--capture", (folder / "bytes").string()}),
                 Contains("bytes") && Contains("2 beacons"));
    }
  }
  WHEN("the number of accepted beacons is too large, or has no meaning") {
    THEN("option, value and limit are named, or the source") {
      CHECK_THAT(refused({"--source", "udp", "--max-beacons", "257"}),
                 Contains("--max-beacons") && Contains("257") && Contains("256"));
      CHECK_THAT(refused({"--source", "sim", "--max-beacons", "5"}),
                 Contains("--max-beacons") && Contains("sim"));
    }
  }
  WHEN("the --record folder already contains a recording") {
    write_text(folder / "imu.csv", "precious\n");
    THEN("it refuses, and the recording is unchanged") {
      CHECK_THAT(refused({"--record", folder.path().string()}),
                 Contains(folder.path().string()) && Contains("not overwritten"));
      CHECK(read_text(folder / "imu.csv") == "precious\n");
    }
  }
}

/// Writes a playable recording of one message.
void write_recording(const std::filesystem::path& file) {
  mcap::FileSink sink(file);
  mcap::Writer writer(sink);
  const auto schema = writer.add_schema("sonopose::ResetCommand", "omgidl", "");
  const std::array<std::byte, 8> data{};
  writer.write({writer.add_channel(schema, "sonopose/reset", "cdr"), 1, 1'000'000'000, 1, data});
  writer.close();
}

SCENARIO("every program on the bus refuses a limit of too few file descriptors") {
  const TemporaryFolder folder;
  const std::string recording = (folder / "recording.mcap").string();
  const std::string recorded = (folder / "recorded.mcap").string();
  write_recording(recorded);
  const std::vector<std::pair<const char*, const char*>> programs{{SONOPOSE_TEST_BRIDGE, ""},
                                                                  {SONOPOSE_TEST_FUSION, ""},
                                                                  {SONOPOSE_TEST_MONITOR, ""},
                                                                  {SONOPOSE_TEST_DOCTOR, ""},
                                                                  {SONOPOSE_TEST_SETTINGS, "watch"},
                                                                  {SONOPOSE_TEST_ROS2, "--network loopback"},
                                                                  {SONOPOSE_TEST_RECORD, recording.c_str()},
                                                                  {SONOPOSE_TEST_PLAY, recorded.c_str()}};
  for (const auto& [program, arguments] : programs) {
    for (const char* const limit : {"8", "12"}) {
      const std::string command = std::string("ulimit -n ") + limit + "; exec \"$0\" " + arguments;
      const std::string said = refusal("/bin/sh", {"-c", command, program});
      CHECK_THAT(said, Contains(std::string("at most ") + limit + " file descriptors are allowed") &&
                           Contains("are needed"));
    }
  }
}

SCENARIO("a replay with any limit of file descriptors gives its result or the reason why not") {
  const TemporaryFolder folder;
  const std::string log = (folder / "log").string();
  REQUIRE(run(SONOPOSE_TEST_SIMULATE, {"rest", "--out", log, "--duration", "1"}).code == 0);
  const std::string whole = run(SONOPOSE_TEST_REPLAY, {log}).output;
  REQUIRE_THAT(whole, Contains("state hash"));
  bool has_refused = false;
  for (int limit = 3; limit <= 8; ++limit) {
    const std::string command = "ulimit -n " + std::to_string(limit) + R"(; exec "$0" "$1")";
    const Result result = run("/bin/sh", {"-c", command, SONOPOSE_TEST_REPLAY, log}, neutral);
    CAPTURE(limit, result.output, result.error);
    REQUIRE(result.code);
    CHECK(*result.code >= 0);  // not ended by a signal
    if (*result.code == 0) {
      CHECK_THAT(result.output, Contains("state hash"));
    } else {
      // From the program itself, or from the loader that starts it.
      CHECK_THAT(result.error, Contains("Too many open files") || Contains("cannot open shared object file"));
      has_refused = true;
    }
  }
  CHECK(has_refused);
}

}  // namespace refusal_test
