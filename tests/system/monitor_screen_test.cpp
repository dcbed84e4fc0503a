/// The monitor on a terminal: a screen that fits, keys, and a terminal that is restored in every case.

#include "support/bus.hpp"
#include "support/held_thread.hpp"
#include "support/matches.hpp"
#include "support/terminal_process.hpp"
#include "support/wait_until.hpp"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace monitor_screen_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;

const std::string ctrl_c = "\x03";
const std::string page_down = "\x1b[6~";
const std::string end = "\x1bOF";
const std::string enter = "\r";
const std::string escape = "\x1b";

/// A monitor on its own terminal.
class MonitorScreen : public TerminalProcess {
public:
  explicit MonitorScreen(const Bus& bus, const Environment& environment = {{"TERM", "xterm-256color"}})
      : TerminalProcess(SONOPOSE_TEST_MONITOR, {"--domain", std::to_string(bus.domain_id())}, 80, 24,
                        environment) {}

  /// Waits for a text in this row, counted from the top.
  bool wait_for_row(std::size_t row, std::string_view text) {
    return wait_until(
        [=](const TextScreen& screen) { return screen.line(row).find(text) != std::string::npos; });
  }

  /// Waits for a pose in a beacon's row; only poses have numbers with two decimals.
  bool wait_for_pose(std::size_t row) {
    return wait_until(
        [=](const TextScreen& screen) { return !first_match(screen.line(row), R"(\d\.\d\d( |$))").empty(); });
  }
};

void check_is_whole(const TextScreen& screen) {
  CAPTURE(screen.text());
  CHECK(screen.is_alternate());
  CHECK_FALSE(screen.has_overflown());
  CHECK(screen.unknown() == "");
}

void check_is_restored(const TerminalProcess& monitor) {
  CHECK_FALSE(monitor.screen().is_alternate());
  CHECK_THAT(monitor.output(), Contains("\x1b[?1049l") && Contains("\x1b[?25h"));
  CHECK(monitor.has_normal_line());
}

SCENARIO("the monitor is a screen that fits") {
  GIVEN("50 beacons and a monitor on a terminal of 80 x 24") {
    const Bus bus;
    const auto fusion = bus.fusion();
    auto bridge = bus.bridge({"--beacons", "50", "--imu-rate", "25"});
    MonitorScreen monitor(bus);
    REQUIRE(monitor.wait_for("50 beacons"));
    monitor.type("a");
    REQUIRE(monitor.wait_for("by address"));
    REQUIRE(monitor.wait_for("rows 1-20"));
    THEN("the table scrolls, has pages, adapts to the size, and messages leave it where it is") {
      check_is_whole(monitor.screen());
      CHECK_THAT(monitor.screen().line(1), Contains("beacon") && Contains("status"));
      CHECK(monitor.wait_for_row(2, "     7 "));

      monitor.type(page_down + page_down);
      CHECK(monitor.wait_for("rows 20-39"));
      monitor.type(end);
      CHECK(monitor.wait_for_row(21, "    56 "));  // addresses 7 … 56
      monitor.type("?");
      CHECK(monitor.wait_for_row(22, "w worst"));

      monitor.type(enter);
      REQUIRE(monitor.wait_for_row(0, "beacon 56"));
      CHECK(monitor.wait_for("innovation m"));
      CHECK(monitor.wait_for("battery V"));
      check_is_whole(monitor.screen());
      monitor.type(escape);
      REQUIRE(monitor.wait_for_row(0, "50 beacons"));

      monitor.resize(60, 12);
      REQUIRE(monitor.wait_for("rows 43-50"));
      CHECK(monitor.wait_for_row(9, "    56 "));
      check_is_whole(monitor.screen());
      monitor.resize(120, 60);
      REQUIRE(monitor.wait_for_row(1, "m/s"));
      CHECK(monitor.wait_for_row(51, "    56 "));
      check_is_whole(monitor.screen());

      REQUIRE(bridge->end_by(SIGINT).code == 0);
      CHECK(monitor.wait_for_row(59, "no pose for"));
      CHECK_THAT(monitor.screen().line(1), Contains("beacon") && Contains("status"));
      check_is_whole(monitor.screen());

      monitor.type(ctrl_c);
      CHECK(monitor.wait_for_exit() == 0);
      check_is_restored(monitor);
      const std::string output = monitor.output();
      const std::string after = output.substr(output.rfind("\x1b[?1049l"));
      CHECK_THAT(after, Contains("beacon 56 over"));  // the summary
      CHECK_THAT(after,
                 Contains("sonopose-monitor: warning: beacon") && Contains("no pose for"));  // standard error
    }
  }
}

/// Id of the thread with this name; -1 if there is none.
int thread_of(int pid, const std::string& name) {
  for (const auto& entry : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/task")) {
    std::string thread_name;
    std::ifstream(entry.path() / "comm") >> thread_name;
    if (thread_name == name) return std::stoi(entry.path().filename().string());
  }
  return -1;
}

SCENARIO("the monitor gives way to the processes that it watches") {
  GIVEN("a monitor on a terminal") {
    const Bus bus;
    MonitorScreen monitor(bus);
    REQUIRE(monitor.wait_for("no beacon yet"));
    THEN("none of its threads interrupts another one when it wakes up") {
      // The monitor keeps a policy chosen by the user, such as that of the test.
      const int own = ::sched_getscheduler(0);
      const int expected = own == SCHED_OTHER ? SCHED_BATCH : own;
      int threads = 0;
      const std::string tasks = "/proc/" + std::to_string(monitor.pid()) + "/task";
      for (const auto& task : std::filesystem::directory_iterator(tasks)) {
        CHECK(::sched_getscheduler(std::stoi(task.path().filename())) == expected);
        ++threads;
      }
      CHECK(threads > 2);  // includes those of Cyclone DDS
    }
  }
}

SCENARIO("the terminal is restored however the monitor ends") {
  GIVEN("a monitor on a terminal") {
    const Bus bus;
    MonitorScreen monitor(bus);
    REQUIRE(monitor.wait_for("no beacon yet"));
    REQUIRE(monitor.screen().is_alternate());
    REQUIRE_FALSE(monitor.has_normal_line());
    THEN("by q, without any pose") {
      monitor.type("q");
      CHECK(monitor.wait_for_exit() == 0);
      check_is_restored(monitor);
    }
    THEN("by SIGTERM") {
      monitor.send(SIGTERM);
      CHECK(monitor.wait_for_exit() == 0);
      check_is_restored(monitor);
    }
    THEN("by a crash, which still ends it") {
      const int signal = GENERATE(SIGSEGV, SIGABRT);
      monitor.send(signal);
      const auto code = monitor.wait_for_exit();
      CHECK(code);
      CHECK(code != 0);
      check_is_restored(monitor);
    }
  }
}

SCENARIO("c clears the counters") {
  GIVEN("the page of a beacon whose bridge was stopped for a moment") {
    const Bus bus;
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    MonitorScreen monitor(bus);
    monitor.resize(100, 70);
    REQUIRE(monitor.wait_for("1 beacon by worst"));
    REQUIRE(monitor.wait_for_pose(2));
    monitor.type(enter);
    REQUIRE(monitor.wait_for("Problems since the start or the last clear"));
    bridge->send(SIGSTOP);
    REQUIRE(monitor.wait_for("missed"));
    bridge->send(SIGCONT);
    WHEN("c is typed") {
      // Deadlines missed after a clear are counted, so a busy machine may need several.
      const bool is_cleared = wait_until([&] {
        monitor.type("c");
        return monitor.wait_until(
            [](const TextScreen& screen) { return !Contains("missed").match(screen.text()); },
            std::chrono::seconds(1));
      });
      THEN("the problems from before are gone") {
        CAPTURE(monitor.screen().text());
        CHECK(is_cleared);
      }
    }
  }
}

SCENARIO("a second Ctrl-C ends a monitor that hangs, and restores the terminal") {
  GIVEN("a monitor whose main thread hangs") {
    const Bus bus;
    MonitorScreen monitor(bus);
    REQUIRE(monitor.wait_for("no beacon yet"));
    const HeldThread held(monitor.pid(), "sonopose-monito");  // the kernel keeps 15 characters
    WHEN("Ctrl-C is pressed, and again after more than a second") {
      monitor.type(ctrl_c);
      CHECK_FALSE(monitor.wait_for_exit(std::chrono::milliseconds(1200)));
      CHECK_FALSE(monitor.has_normal_line());
      // Repeated, because a busy machine may have been late with the first one.
      REQUIRE(test::wait_until([&monitor] {
        monitor.type(ctrl_c);
        return monitor.wait_for_exit(std::chrono::milliseconds(200)).has_value();
      }));
      THEN("it has ended, and the terminal is as before") {
        CHECK(monitor.wait_for_exit() == 128 + SIGINT);
        check_is_restored(monitor);
      }
    }
  }
}

SCENARIO("the lines on standard error outlive a crash") {
  GIVEN("a monitor that shows a message which was written to standard error") {
    const Bus bus;
    MonitorScreen monitor(bus);
    const auto fusion = bus.fusion();
    auto bridge = bus.bridge({});
    REQUIRE(monitor.wait_for("1 beacon by worst"));
    REQUIRE(monitor.wait_for_pose(2));
    REQUIRE(bridge->end_by(SIGINT).code == 0);
    REQUIRE(monitor.wait_for("no pose for"));
    WHEN("it crashes") {
      monitor.send(SIGSEGV);
      REQUIRE(monitor.wait_for_exit());
      THEN("the line stands below the restored screen") {
        check_is_restored(monitor);
        const std::string output = monitor.output();
        CHECK_THAT(output.substr(output.rfind("\x1b[?1049l")),
                   Contains("sonopose-monitor: warning: beacon 7: no pose for"));
      }
    }
  }
}

SCENARIO("a crash in a thread that receives samples restores the terminal") {
  GIVEN("a monitor that has received a pose") {
    const Bus bus;
    MonitorScreen monitor(bus);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({});
    REQUIRE(monitor.wait_for("1 beacon by worst"));
    const int receiver = thread_of(monitor.pid(), "recv");  // Cyclone DDS blocks signals on this thread
    REQUIRE(receiver > 0);
    WHEN("that thread gets a fault") {
      REQUIRE(::syscall(SYS_tgkill, monitor.pid(), receiver, SIGSEGV) == 0);
      THEN("the monitor ends, and the terminal is restored") {
        const auto code = monitor.wait_for_exit();
        CHECK(code);
        CHECK(code != 0);
        check_is_restored(monitor);
      }
    }
  }
}

SCENARIO("TERM and NO_COLOR choose colours and the screen") {
  const Bus bus;
  GIVEN("monitors on three terminals, and a chain, so that there is a status to colour") {
    MonitorScreen coloured(bus);
    MonitorScreen plain(bus, {{"TERM", "xterm-256color"}, {"NO_COLOR", "1"}});
    MonitorScreen dumb(bus, {{"TERM", "dumb"}});
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({"--beacons", "2"});
    for (MonitorScreen* const monitor : {&coloured, &plain}) {
      REQUIRE(monitor->wait_for("2 beacons"));
      REQUIRE(monitor->wait_for_pose(3));
      monitor->type("q");
      REQUIRE(monitor->wait_for_exit() == 0);
    }
    REQUIRE(dumb.wait_for("     7 "));
    dumb.type(ctrl_c);
    REQUIRE(dumb.wait_for_exit() == 0);
    THEN("colours are used, unless NO_COLOR is set, and a terminal that is dumb gets lines") {
      CHECK(coloured.screen().has_colour());
      CHECK_FALSE(plain.screen().has_colour());
      CHECK_THAT(dumb.output(), !Contains("\x1b"));
    }
  }
  GIVEN("a terminal of an unknown type") {
    // ncurses leaks 1.6 kB if it does not know the terminal.
    MonitorScreen monitor(bus, {{"TERM", "unheard-of"}, {"ASAN_OPTIONS", "detect_leaks=0"}});
    THEN("the monitor prints lines and says why") {
      CHECK(monitor.wait_for("unheard-of"));
      monitor.type(ctrl_c);
      CHECK(monitor.wait_for_exit() == 0);
      CHECK_THAT(monitor.output(), !Contains("\x1b[?1049h"));
    }
  }
}

}  // namespace monitor_screen_test
