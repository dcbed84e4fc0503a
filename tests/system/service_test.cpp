/// Programs as services: options in files, readiness, watchdog and settings that are read again.

#include "support/bus.hpp"
#include "support/checked_run.hpp"
#include "support/notify_socket.hpp"
#include "support/temporary_folder.hpp"
#include <sonopose/estimation/aiding/known_sensors.hpp>

#include <fmt/format.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <regex>

namespace sonopose::service_test {

using namespace sonopose::test;
using Catch::Contains;

constexpr int wrong_configuration = 78;

/// A file with options or settings, and the folder of its drop-ins.
struct ConfigFile {
  explicit ConfigFile(const std::string& text) {
    write_text(path, text);
    std::filesystem::create_directory(drop_ins);
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder / "service.toml";
  std::filesystem::path drop_ins = folder / "service.toml.d";
};

SCENARIO("every option is a key of the file of --config") {
  for (const char* const program : {SONOPOSE_TEST_BRIDGE, SONOPOSE_TEST_RECORD, SONOPOSE_TEST_ROS2}) {
    CAPTURE(program);
    const std::string all = output_of(program, {"--print-config"}, neutral);
    CHECK_THAT(all, Contains("# domain = ") && Contains("= false\n"));
    GIVEN(std::string("what it prints, and a drop-in with a domain: ") + program) {
      const ConfigFile file(all);
      write_text(file.drop_ins / "50-domain.toml", "domain = 9\nlog-level = \"error\"\n");
      const std::string path = file.path.string();
      THEN("the drop-in has precedence over the file, and the command line over both") {
        const std::string used =
            output_of(program, {"--config", path, "--log-level=debug", "--print-config"}, neutral);
        CHECK_THAT(used, Contains("\ndomain = 9\n") && Contains("\nlog-level = \"debug\"\n"));
      }
      THEN("each default that it shows is a value of its key") {
        write_text(file.path, std::regex_replace(all, std::regex("(^|\n)# ([a-z0-9-]+ = [^\n])"), "$1$2"));
        const Result used = run(program, {"--config", path, "--print-config"}, neutral);
        CHECK(used.error.empty());
        CHECK(used.code == 0);
      }
      THEN("an unknown key is named with file, line and the nearest option") {
        write_text(file.path, "\ndomian = 1\n");
        const Result wrong = run(program, {"--config", path}, neutral);
        CHECK(wrong.code == wrong_configuration);
        CHECK_THAT(wrong.error, Contains(path + ":2: domian") && Contains("did you mean domain?"));
      }
      THEN("a wrong value is named with file, line, value and limit") {
        write_text(file.drop_ins / "50-domain.toml", "domain = 4711\n");
        const Result wrong = run(program, {"--config", path}, neutral);
        CHECK(wrong.code == wrong_configuration);
        CHECK_THAT(wrong.error, Contains("50-domain.toml:1: domain") && Contains("4711") && Contains("232"));
      }
      THEN("an empty text is a value, and does not take the next option for one") {
        write_text(file.drop_ins / "50-domain.toml", "log-level = \"debug\"\npartition = \"\"\ndomain = 9\n");
        const std::string used = output_of(program, {"--config", path, "--print-config"}, neutral);
        CHECK_THAT(used, Contains("\npartition = \"\"\n") && Contains("\ndomain = 9\n") &&
                             Contains("\nlog-level = \"debug\"\n"));
      }
    }
  }
}

SCENARIO("options of the fusion are in the table [program] of its settings") {
  struct Mistake {
    const char* line;
    const char* reason;
  };
  const auto mistake = GENERATE(values<Mistake>({
      {"addresses = \"seven\"", "seven"},
      {"partition = \"hall-*\"", "single partition"},
      {"qos = \"/no/such.xml\"", "program.qos: --qos: /no/such.xml: does not exist"},
      {"security = \"/no/such\"", "program.security: --security: /no/such/enclaves/fusion: no such enclave"},
      {"realtime = 1000", "1000"},
      {"lossless = 5", "true or false"},
      {"warm-up = 5", "--standby-strength"},
      {"standby-strength = 5\nlossless = true", "excludes"},
      {"check-config = true", "no such option"},
      {"print-completions = true", "no such option"},
  }));
  GIVEN(std::string("the wrong line ") + mistake.line) {
    const ConfigFile file(std::string("[program]\n") + mistake.line +
                          "\n[admission]\nmin_quality_percent = 60\n");
    THEN("the fusion does not start, the check finds the same, and no service manager tries again") {
      for (const test::Arguments& more : {test::Arguments{}, test::Arguments{"--check-config"}}) {
        test::Arguments arguments{"--config", file.path.string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Result wrong = run(SONOPOSE_TEST_FUSION, arguments, neutral);
        CHECK(wrong.code == wrong_configuration);
        CHECK_THAT(wrong.error, Contains(file.path.string() + ":") && Contains(mistake.reason));
      }
    }
  }
}

SCENARIO("a wrong value ends a service with a code that the service manager does not try again") {
  struct Mistake {
    const char* program;
    std::string earlier;  ///< correct lines, without quotes
    std::string key;
    std::string value;
    const char* reason;
  };
  const auto mistake = GENERATE(values<Mistake>({
      {SONOPOSE_TEST_BRIDGE, "source=udp", "listen", "127.0.0.1:70000", "not a port"},
      {SONOPOSE_TEST_BRIDGE, "source=udp", "from", "modem", "not a numeric IP address"},
      {SONOPOSE_TEST_BRIDGE, "address=65000", "beacons", "1000", "65999"},
      {SONOPOSE_TEST_BRIDGE, "beacons=2", "capture", "/no/such.bin", "one beacon"},
      {SONOPOSE_TEST_BRIDGE, "", "scenario", "wlak", "known are rest"},
      {SONOPOSE_TEST_BRIDGE, "", "partition", "hall-*", "single partition"},
      {SONOPOSE_TEST_BRIDGE, "", "source", "log", "--input is required"},
      {SONOPOSE_TEST_BRIDGE, "source=log", "input", "/no/such", "/no/such"},
      {SONOPOSE_TEST_BRIDGE, "source=stream", "input", "/no/such.bin", "/no/such.bin"},
      {SONOPOSE_TEST_BRIDGE, "source=serial", "device", "/dev/null", "not a serial device"},
      {SONOPOSE_TEST_BRIDGE, "source=sim", "record", "/dev/null/log", "/dev/null/log"},
      {SONOPOSE_TEST_BRIDGE, "", "qos", "/no/such.xml", "does not exist"},
      {SONOPOSE_TEST_RECORD, "", "include-earlier", "true", "--max-total"},
      {SONOPOSE_TEST_ROS2, "wheel-in=/j=42", "wheels", "/no/such.toml", "does not exist"},
      {SONOPOSE_TEST_ROS2, "", "beacon-namespace", "tag", "{address}"},
  }));
  const std::string& earlier = mistake.earlier;
  const auto line = [](const std::string& key, const std::string& value) {
    const std::string quote = value == "true" ? "" : "\"";
    return key + " = " + quote + value + quote + "\n";
  };
  GIVEN("the wrong value " + mistake.key + " = " + mistake.value) {
    WHEN("it is in a file") {
      const std::size_t end = earlier.find('=');
      const std::string first =
          earlier.empty() ? "\n" : line(earlier.substr(0, end), earlier.substr(end + 1));
      const ConfigFile file(first + line(mistake.key, mistake.value));
      const Result wrong = run(mistake.program, {"--config", file.path.string()}, neutral);
      THEN("the code is that of a wrong file, and the text begins with file, line and key") {
        CHECK(wrong.code == wrong_configuration);
        CHECK_THAT(wrong.error, Contains(fmt::format(": {}:2: {}: ", file.path.string(), mistake.key)) &&
                                    Contains(mistake.reason));
      }
    }
    WHEN("it is on the command line") {
      test::Arguments arguments{"--" + mistake.key + "=" + mistake.value};
      if (!earlier.empty()) arguments.push_back("--" + earlier);
      const Result wrong = run(mistake.program, arguments, neutral);
      THEN("the code is that of a wrong option, and the option is named") {
        CHECK(wrong.code.value_or(0) >= 103);
        CHECK(wrong.code.value_or(0) <= 114);
        CHECK_THAT(wrong.error, Contains("--" + mistake.key) && Contains(mistake.reason));
      }
    }
  }
}

SCENARIO("the check of a fusion's file says that what is learned could not be saved") {
  const ConfigFile file("[program]\nlearned = \"/no/such/learned.toml\"\n");
  const Result checked =
      run(SONOPOSE_TEST_FUSION, {"--config", file.path.string(), "--check-config"}, neutral);
  CHECK(checked.code == 0);
  CHECK_THAT(checked.error, Contains("--learned /no/such/learned.toml: cannot be written"));
}

SCENARIO("a file among the drop-ins with another ending is named, not silently left out") {
  const ConfigFile file("");
  for (const char* const name : {"50-lan.conf", "60-old.toml.bak", ".hidden"}) {
    write_text(file.drop_ins / name, "domain = 4711\n");
  }
  const Result fusion =
      run(SONOPOSE_TEST_FUSION, {"--config", file.path.string(), "--check-config"}, neutral);
  const Result recorder =
      run(SONOPOSE_TEST_RECORD, {"--config", file.path.string(), "--print-config"}, neutral);
  for (const Result& result : {fusion, recorder}) {
    CHECK(result.code == 0);
    CHECK_THAT(result.error, Contains("50-lan.conf: not read: the name of a drop-in ends in .toml") &&
                                 !Contains("60-old") && !Contains("hidden"));
  }
}

SCENARIO("a flag of a file that is false is as one that is not given") {
  const ConfigFile file("[program]\nlossless = false\nstandby-strength = 5\nrealtime = 50\n");
  const Result checked =
      run(SONOPOSE_TEST_FUSION, {"--config", file.path.string(), "--check-config"}, neutral);
  CAPTURE(checked.error);
  CHECK(checked.code == 0);
}

SCENARIO("a fusion reports to the service manager, and reads its settings again") {
  GIVEN("a fusion with a file of settings, whose watchdog has a period of 2 s") {
    const ConfigFile file("[admission]\nmin_quality_percent = 50\n");
    NotifySocket manager(file.folder / "notify");
    const Bus bus;
    ::setenv("NOTIFY_SOCKET", (file.folder / "notify").c_str(), 1);
    ::setenv("WATCHDOG_USEC", "2000000", 1);
    const auto fusion = bus.fusion({"--config", file.path.string()});
    ::unsetenv("NOTIFY_SOCKET");
    ::unsetenv("WATCHDOG_USEC");
    const auto quality = [&bus] { return bus.settings({"get", "admission.min_quality_percent"}).output; };
    REQUIRE(!manager.next_with("READY=1").empty());
    WHEN("nothing happens") {
      THEN("it reports its progress again and again") {
        CHECK(!manager.next_with("WATCHDOG=1").empty());
        CHECK(!manager.next_with("WATCHDOG=1").empty());
      }
    }
    WHEN("a drop-in is added, and the fusion gets SIGUSR2") {
      write_text(file.drop_ins / "50-quality.toml", "[admission]\nmin_quality_percent = 60\n");
      fusion->send(SIGUSR2);
      REQUIRE(!manager.next_with("RELOADING=1").empty());
      CHECK_THAT(manager.next_with("READY=1"), Contains("settings read again"));
      REQUIRE(fusion->wait_for_line(Stream::error, "settings read again"));
      THEN("it uses the new settings") {
        CHECK_THAT(quality(), Contains("= 60"));
      }
      AND_WHEN("the drop-in becomes wrong") {
        write_text(file.drop_ins / "50-quality.toml", "[admission]\nmin_quality_percent = 600\n");
        fusion->send(SIGUSR2);
        THEN("the fusion names the mistake and keeps its settings") {
          CHECK_THAT(manager.next_with("the previous ones stay"),
                     Contains("READY=1") && Contains("50-quality.toml:2:") && Contains("600"));
          CHECK_THAT(quality(), Contains("= 60"));
        }
      }
    }
    WHEN("a setting is changed live and saved") {
      REQUIRE(bus.settings({"set", "admission.min_quality_percent=70"}).code == 0);
      const Result saved = bus.settings({"save", "--config", file.path.string()});
      CAPTURE(saved.error);
      REQUIRE(saved.code == 0);
      THEN("a drop-in has what differs from the file, and the fusion reads it") {
        CHECK_THAT(read_text(file.drop_ins / "90-saved.toml"),
                   Contains("[admission]\nmin_quality_percent = 70") && !Contains("mount_offset_deg"));
        fusion->send(SIGUSR2);
        REQUIRE(fusion->wait_for_line(Stream::error, "settings read again"));
        CHECK_THAT(quality(), Contains("= 70"));
      }
    }
  }
}

SCENARIO("a fusion begins with what the one before has learned of the sensors") {
  GIVEN("a fusion that keeps it in a file, and the simulator's beacon 7") {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder / "learned.toml";
    const Bus bus;
    auto fusion = bus.fusion({"--learned", file.string()});
    const auto bridge = bus.bridge({"--rate", "5"});
    Consumer<sonopose_Estimate> consumer(bus, dds::topics::estimate);
    REQUIRE(consumer.wait_for(estimation::aiding::is_learned));
    WHEN("it ends, and another begins") {
      CHECK(fusion->end_by(SIGTERM).code == 0);
      CHECK_THAT(read_text(file), Contains("[beacon.7]") && Contains("gyro_bias_body_radps = ["));
      fusion = bus.fusion({"--learned", file.string()});
      THEN("it knows the sensors of the beacon") {
        CHECK(fusion->wait_for_line(Stream::error, "sensors of 1 beacon known"));
      }
    }
    WHEN("it ends, and another begins with another mount of the IMU") {
      CHECK(fusion->end_by(SIGTERM).code == 0);
      fusion = bus.fusion({"--learned", file.string(), "--set", "heading.mount_offset_deg=90"});
      THEN("it begins without, and names the settings") {
        CHECK(fusion->wait_for_line(Stream::error, "sensors of 0 beacons known"));
        CHECK_THAT(fusion->text(Stream::error), Contains("none; now: heading.mount_offset_deg=90"));
      }
    }
    WHEN("the calibration is changed live by a little before the first saving, and it ends") {
      REQUIRE(bus.settings({"set", "calibration.gyroscope.offset_x_radps=0.0001"}).code == 0);
      CHECK(fusion->end_by(SIGTERM).code == 0);
      THEN("what it learned with the other calibration is not in the file") {
        // On a slow machine it was saved with the former calibration.
        if (std::filesystem::exists(file)) CHECK_THAT(read_text(file), !Contains("gyroscope.offset_x"));
      }
    }
    WHEN("the file is broken, and another begins") {
      write_text(file, "[beacon.7]\nfix_std_m = 5 m\n");
      const auto other = bus.fusion({"--learned", file.string()});
      THEN("it begins without, and says so with the line") {
        CHECK(other->wait_for_line(Stream::error, "learned.toml:2"));
      }
    }
  }
}

SCENARIO("a key of an earlier version does not stop the fusion") {
  const ConfigFile file("[trust]\nsigma_m = 0.5\n[admission]\nmin_quality_percent = 50\n");
  const Result checked =
      run(SONOPOSE_TEST_FUSION, {"--config", file.path.string(), "--check-config"}, neutral);
  CHECK(checked.code == 0);
  CHECK_THAT(checked.error, Contains(file.path.string() + ":2:") && Contains("documented.trust.sigma_m"));
}

SCENARIO("programs tell the shells what to complete") {
  const Result bridge = run(SONOPOSE_TEST_BRIDGE, {"--print-completions"}, neutral);
  CHECK(bridge.code == 0);
  CHECK_THAT(bridge.output, Contains("-\t--capture\tFILE\t") && Contains("-\t--network\tloopback|lan\t"));
  const Result settings = run(SONOPOSE_TEST_SETTINGS, {"--print-completions"}, neutral);
  CHECK_THAT(settings.output, Contains("-\tsave\t-\t") && Contains("save\t--config\tFILE\t"));
}

}  // namespace sonopose::service_test
