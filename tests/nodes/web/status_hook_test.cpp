/// The command that runs when the status of a beacon changes.

#include "web/status_hook.hpp"

#include "support/temporary_folder.hpp"
#include "support/wait_until.hpp"

#include <catch2/catch.hpp>

#include <filesystem>
#include <string>

namespace status_hook_test {

using namespace sonopose;

constexpr TimeNs second_ns = 1'000'000'000;

observation::bus::BusSnapshot second_with(BeaconAddress address, std::uint32_t status) {
  observation::BeaconView view;
  view.address = address;
  view.poses = 100;
  view.pose.status = status;
  return {.beacons = {view}, .warnings = {}, .gone = {}};
}

/// A hook whose command adds a line to a file, and the time of a test.
struct Hook {
  /// Passes the second until the hook has run its command `lines` times in total.
  bool update_until(const observation::bus::BusSnapshot& second, const std::string& lines) {
    return test::wait_until([&] {
      hook.update(second, now);
      return text() == lines;
    });
  }
  /// Passes a second in which no command may start.
  void update_alone(const observation::bus::BusSnapshot& second) { hook.update(second, now); }

  [[nodiscard]] std::string text() const {
    return std::filesystem::exists(file) ? test::read_text(file) : std::string();
  }

  test::TemporaryFolder folder;
  std::filesystem::path file = folder / "lines";
  web::StatusHook hook{"echo \"$SONOPOSE_BEACON: $SONOPOSE_STATUS_BEFORE, now $SONOPOSE_STATUS\" >> " +
                       file.string()};
  SteadyTime now{3600 * second_ns};
};

SCENARIO("a command learns of each change of a status, at most every ten seconds") {
  GIVEN("a beacon that becomes stale") {
    Hook hook;
    REQUIRE(hook.update_until(second_with(7, status_stale), "7: ok, now stale\n"));
    WHEN("it stays stale") {
      hook.now += 60 * second_ns;
      hook.update_alone(second_with(7, status_stale));
      THEN("the command does not run again before another change") {
        CHECK(hook.update_until(second_with(7, status_low_trust),
                                "7: ok, now stale\n7: stale, now low trust\n"));
      }
    }
    WHEN("it changes twice within ten seconds") {
      hook.now += 3 * second_ns;
      hook.update_alone(second_with(7, status_low_trust));
      hook.now += 3 * second_ns;
      hook.update_alone(second_with(7, 0));
      THEN("the command runs once, later, with the last status") {
        hook.now += 10 * second_ns;
        CHECK(hook.update_until(second_with(7, 0), "7: ok, now stale\n7: stale, now ok\n"));
      }
    }
    WHEN("it is gone") {
      auto second = second_with(7, status_stale);
      std::swap(second.beacons, second.gone);
      hook.now += 10 * second_ns;
      THEN("the command learns that too, and its return") {
        const std::string text = "7: ok, now stale\n7: stale, now gone\n";
        CHECK(hook.update_until(second, text));
        hook.now += 10 * second_ns;
        CHECK(hook.update_until(second_with(7, 0), text + "7: gone, now ok\n"));
      }
    }
  }
  GIVEN("a beacon that is ok from the start") {
    Hook hook;
    hook.update_alone(second_with(7, 0));
    THEN("nothing runs before its first change") {
      CHECK(hook.update_until(second_with(7, status_late), "7: ok, now late\n"));
    }
  }
}

}  // namespace status_hook_test
