/// The program sonopose-run: bridge, fusion and monitor in one terminal, with the real programs.

#include "recording/log_folder.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"
#include "support/terminal_process.hpp"
#include "support/wait_until.hpp"

#include <catch2/catch.hpp>

#include <csignal>
#include <filesystem>
#include <fstream>

namespace sonopose::run_test {

using namespace sonopose::test;
using Catch::Contains;
namespace fs = std::filesystem;
namespace topics = dds::topics;

std::unique_ptr<Process> start(const Bus& bus, Arguments arguments) {
  arguments.insert(arguments.end(), {"--domain", std::to_string(bus.domain_id())});
  return std::make_unique<Process>(SONOPOSE_TEST_RUN, arguments);
}

/// Process id of a program started by `parent`; 0 if there is none.
int child_named(int parent, const std::string& name) {
  std::ifstream children("/proc/" + std::to_string(parent) + "/task/" + std::to_string(parent) + "/children");
  for (int pid = 0; children >> pid;) {
    std::error_code gone;
    if (fs::read_symlink("/proc/" + std::to_string(pid) + "/exe", gone).filename() == name) return pid;
  }
  return 0;
}

/// Waits until the process ends, even if it is not our child.
bool ends(int pid) {
  return wait_until([&] { return !fs::exists("/proc/" + std::to_string(pid) + "/exe"); });
}

SCENARIO("one command runs bridge, fusion and monitor") {
  const Bus bus;
  const TemporaryFolder folder;
  GIVEN("a scenario, a file of settings and a recording") {
    write_text(folder / "f.toml", "[heading]\nmount_offset_deg = 12.5\n");
    Consumer<sonopose_EffectiveSettings> settings(bus, topics::settings);
    const auto all =
        start(bus, {"--source", "sim", "--scenario", "kart", "--seed", "4", "--config",
                    (folder / "f.toml").string(), "--record", (folder / "log").string(), "--json"});
    REQUIRE(all->wait_for_line(Stream::error, "sonopose-bridge: publishing from sim"));
    REQUIRE(settings.wait_for([](const EffectiveSettings& each) { return each.address == 7; }));
    REQUIRE(all->wait_for_line(Stream::output, "\"address\":7"));
    const std::array<int, 3> pids{child_named(all->pid(), "sonopose-bridge"),
                                  child_named(all->pid(), "sonopose-fusion"),
                                  child_named(all->pid(), "sonopose-monitor")};
    for (const int pid : pids) REQUIRE(pid > 0);
    THEN("the options reached the bridge and the fusion") {
      const auto& values = settings.samples.back().values;
      CHECK(std::any_of(values.begin(), values.end(), [](const SettingAssignment& value) {
        return value.key == "heading.mount_offset_deg" && value.value == "12.5";
      }));
      AND_THEN("a signal, which may come twice, ends all of them, and the recording is whole") {
        all->send(SIGINT);
        CHECK(all->end_by(SIGTERM).code == 0);
        for (const int pid : pids) CHECK(ends(pid));
        CHECK(recording::read_sensor_log(folder / "log").events.size() > 10);
        CHECK_THAT(read_text(folder / "log/meta.toml"), Contains("scenario = \"kart\""));
      }
    }
    WHEN("the fusion dies") {
      ::kill(pids[1], SIGKILL);
      THEN("the others end, and its name and its end are the reason") {
        CHECK(all->wait_for_exit() == 128 + SIGKILL);
        CHECK_THAT(all->text(Stream::error), Contains("sonopose-run: sonopose-fusion was ended by signal 9"));
        for (const int pid : pids) CHECK(ends(pid));
        CHECK(fs::exists(folder / "log"));
      }
    }
    WHEN("the command itself is killed") {
      all->end_by(SIGKILL);
      THEN("no program stays, and the recording is whole") {
        for (const int pid : pids) CHECK(ends(pid));
        CHECK(fs::exists(folder / "log"));
      }
    }
  }
}

SCENARIO("on a terminal the monitor has the screen, and the lines of the others follow") {
  const Bus bus;
  TerminalProcess all(SONOPOSE_TEST_RUN,
                      {"--source", "sim", "--scenario", "rest", "--domain", std::to_string(bus.domain_id())});
  REQUIRE(all.wait_for("1 beacon by worst"));
  CHECK(all.screen().is_alternate());
  CHECK_THAT(all.output(), !Contains("sonopose-bridge: publishing"));
  const std::array<int, 3> pids{child_named(all.pid(), "sonopose-bridge"),
                                child_named(all.pid(), "sonopose-fusion"),
                                child_named(all.pid(), "sonopose-monitor")};
  all.type("\x03");  // Ctrl-C
  CHECK(all.wait_for_exit() == 0);
  CHECK_FALSE(all.screen().is_alternate());
  CHECK(all.has_normal_line());
  const std::string output = all.output();
  CHECK_THAT(output.substr(output.rfind("\x1b[?1049l")),
             Contains("beacon 7 over") && Contains("sonopose-bridge: publishing from sim") &&
                 Contains("sonopose-fusion: serving"));
  for (const int pid : pids) CHECK(ends(pid));
}

SCENARIO("an error of one program is the error of all") {
  const Bus bus;
  const TemporaryFolder folder;
  WHEN("the settings are wrong") {
    const auto all = start(bus, {"--set", "heading.mount_offset_deg=1000"});
    THEN("the fusion's message and exit code arrive") {
      CHECK(all->wait_for_exit() == 78);
      CHECK_THAT(all->text(Stream::error),
                 Contains("heading.mount_offset_deg = 1000: out of range") &&
                     Contains("sonopose-run: sonopose-fusion ended with exit code 78"));
    }
  }
  WHEN("a short simulation ends by itself") {
    const auto all = start(bus, {"--duration", "1"});
    THEN("all end without an error") {
      CHECK(all->wait_for_exit() == 0);
    }
  }
  WHEN("an option is misspelt") {
    const auto all = start(bus, {"--scenrio", "walk"});
    THEN("nothing is started") {
      CHECK(all->wait_for_exit().value_or(0) > 0);
      CHECK_THAT(all->text(Stream::error), Contains("did you mean --scenario?"));
    }
  }
}

}  // namespace sonopose::run_test
