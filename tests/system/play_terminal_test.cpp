/// sonopose-play on a terminal: its keys.

#include "bus_log/recorded.hpp"
#include "support/bus.hpp"
#include "support/held_thread.hpp"
#include "support/temporary_folder.hpp"
#include "support/terminal_process.hpp"
#include "support/wait_until.hpp"
#include "system/recorded_walk.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace sonopose::play_terminal_test {

using namespace sonopose::test;
namespace topics = dds::topics;

/// Time of the next message, in ms since the first one, shown by a paused player.
long long paused_at_ms(TerminalProcess& play) {
  const std::string name = "paused at ";
  const auto shown = [&name](const TextScreen& screen) {
    const std::size_t row = screen.row_of(name);
    return row == std::string::npos ? std::string() : screen.line(row);
  };
  REQUIRE(play.wait_until([&](const TextScreen& screen) { return shown(screen).ends_with(" s"); }));
  const std::string line = shown(play.screen());
  return std::llround(std::stod(line.substr(line.find(name) + name.size())) * 1e3);
}

SCENARIO("keys pause a player and play single messages") {
  GIVEN("a recording of IMU samples that is played on a terminal to a reader of them") {
    const TemporaryFolder folder;
    std::vector<Event> events = walk(60.0);
    std::erase_if(events, [](const Event& event) { return !std::holds_alternative<ImuSample>(event); });
    {
      BusRecording recording(folder / "run.mcap");
      for (const Event& event : events) {
        recording.write(event, static_cast<std::uint64_t>(available_at_ns(event)));
      }
    }
    const Bus bus;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    TerminalProcess play(SONOPOSE_TEST_PLAY,
                         {(folder / "run.mcap").string(), "--domain", std::to_string(bus.domain_id())}, 200);
    REQUIRE(play.wait_for("space: pause and continue"));
    REQUIRE(imu.wait_for_count(20));
    WHEN("it is paused, and told three times to play one message") {
      play.type(" ");
      const long long next_ms = paused_at_ms(play);
      const auto next = std::find_if(events.begin(), events.end(), [&](const Event& event) {
        return (available_at_ns(event) - available_at_ns(events.front()) + 500'000) / 1'000'000 >= next_ms;
      });
      REQUIRE(events.end() - next > 3);
      const std::uint64_t last = sequence_of(*(next + 2));
      play.type("s.s");
      REQUIRE(imu.wait_for([last](const ImuSample& sample) { return sample.sequence >= last; }));
      THEN("these come, and after the pause the others") {
        CHECK_FALSE(imu.wait_for([last](const ImuSample& sample) { return sample.sequence > last; }, 0,
                                 std::chrono::milliseconds(300)));
        play.type(" ");
        CHECK(play.wait_for("playing at "));
        CHECK(imu.wait_for_more(100));
        AND_THEN("q ends it, and the terminal is as before") {
          CHECK_FALSE(play.has_normal_line());
          play.type("q");
          CHECK(play.wait_for_exit() == 0);
          CHECK(play.has_normal_line());
        }
      }
    }
  }
}

SCENARIO("a second Ctrl-C ends a player that hangs, and restores the terminal") {
  GIVEN("a player on a terminal whose main thread hangs") {
    const TemporaryFolder folder;
    record_walk(folder / "walk.mcap", 2.0, {7});
    const Bus bus;
    TerminalProcess play(
        SONOPOSE_TEST_PLAY,
        {(folder / "walk.mcap").string(), "--loop", "--domain", std::to_string(bus.domain_id())}, 200);
    REQUIRE(play.wait_for("space: pause and continue"));
    const HeldThread held(play.pid(), "sonopose-play");
    WHEN("Ctrl-C is pressed, and again after more than a second") {
      play.type("\x03");
      CHECK_FALSE(play.wait_for_exit(std::chrono::milliseconds(1200)));
      CHECK_FALSE(play.has_normal_line());
      // Repeated, because a busy machine may have been late with the first one.
      REQUIRE(wait_until([&play] {
        play.type("\x03");
        return play.wait_for_exit(std::chrono::milliseconds(200)).has_value();
      }));
      THEN("it has ended, and the terminal is as before") {
        CHECK(play.wait_for_exit() == 128 + SIGINT);
        CHECK(play.has_normal_line());
      }
    }
  }
}

}  // namespace sonopose::play_terminal_test
