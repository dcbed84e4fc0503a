/// The processes log each change of a beacon's state once, with level and reason.

#include "recording/log_writer.hpp"
#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"
#include "support/wait_until.hpp"

#include <algorithm>
#include <csignal>

namespace sonopose::state_log_test {

using namespace sonopose::test;
namespace topics = dds::topics;

constexpr double freezes_at_s = 9.0;
constexpr double moves_at_s = 14.0;

/// Records a walk whose fixes repeat one position for five seconds.
void record_frozen_walk(const std::filesystem::path& folder) {
  recording::SensorLogWriter writer(folder);
  sim::Simulator simulator(sim::find_scenario("walk"), {.seed = 3, .duration_s = 40.0});
  std::optional<TimeNs> begin_ns;
  Vector3d held_m = Vector3d::Zero();
  while (auto step = simulator.next()) {
    if (auto* fix = std::get_if<UltrasonicFix>(&step->event)) {
      if (!begin_ns) begin_ns = fix->emission_time_ns;
      const double time_s = seconds_between(*begin_ns, fix->emission_time_ns);
      if (time_s < freezes_at_s) held_m = fix->position_world_m;
      if (time_s < moves_at_s) fix->position_world_m = held_m;
    }
    writer.write(step->event);
  }
}

/// A fusion whose standard error is announced as the journal, as systemd does.
std::unique_ptr<Process> journalled_fusion(const Bus& bus, Arguments arguments) {
  arguments.insert(arguments.begin(),
                   {"-c", R"(JOURNAL_STREAM=$(stat -L -c %d:%i /proc/self/fd/2) exec "$0" "$@")",
                    SONOPOSE_TEST_FUSION, "--domain", std::to_string(bus.domain_id())});
  auto fusion = std::make_unique<Process>("/bin/sh", arguments);
  REQUIRE(fusion->wait_for_line(Stream::error, "<6>serving"));
  return fusion;
}

/// Counts the lines that begin with `text`.
std::size_t count(const Process& process, const std::string& text) {
  const auto lines = process.lines(Stream::error);
  const auto begins = [&text](const std::string& line) { return line.starts_with(text); };
  return static_cast<std::size_t>(std::count_if(lines.begin(), lines.end(), begins));
}

SCENARIO("a freeze and a wrong mount are each logged once, with level and reason") {
  GIVEN("a fusion that knows the mount of beacon 7, and another one for beacon 8") {
    const Bus bus;
    const TemporaryFolder folder;
    const auto log = folder / "walk";
    record_frozen_walk(log);
    const auto fusion =
        journalled_fusion(bus, {"--lossless", "--set", "beacon.8.heading.mount_offset_deg=180"});
    WHEN("both send the same walk, in which the fixes freeze for five seconds") {
      for (const char* const address : {"7", "8"}) {
        const auto bridge =
            bus.bridge({"--source", "log", "--input", log.string(), "--rate", "0", "--address", address});
        REQUIRE(bridge->wait_for_exit() == 0);
        CHECK(count(*bridge, "sonopose-bridge: beacon " + std::string(address) + ": found") == 1);
      }
      REQUIRE(fusion->wait_for_line(Stream::error, "<6>beacon 7: the fixes move again, after "));
      REQUIRE(fusion->wait_for_line(Stream::error, "<4>beacon 8: relocated: the position jumped by "));
      CAPTURE(fusion->text(Stream::error));
      THEN("the freeze is logged, and what follows from it") {
        for (const char* const line :
             {"<6>beacon 7: found", "<6>beacon 7: initialised, after ",
              "<4>beacon 7: frozen track: the fixes repeat one position while the IMU moves",
              "<4>beacon 7: stale: no valid fix for 1.0 s", "<6>beacon 7: the fixes move again, after ",
              "<6>beacon 7: no longer stale, after ", "<4>beacon 7: relocated: the position jumped by 0."}) {
          CAPTURE(line);
          CHECK(count(*fusion, line) == 1);
        }
        CHECK(count(*fusion, "<4>beacon 7: gated") == 0);
      }
      THEN("the wrong mount is logged by what it causes") {
        CHECK(count(*fusion, "<4>beacon 8: low trust: ") >= 1);
        CHECK(count(*fusion, "<4>beacon 8: IMU inconsistent: ") >= 1);
        CHECK(count(*fusion, "<4>beacon 8: ") < 20);
      }
    }
  }
}

SCENARIO("a jump of the pose to a beacon that was carried away is logged, and when it has converged again") {
  GIVEN("a walk that is relocated by 2.5 m after 25 s, and a fusion") {
    const Bus bus;
    const TemporaryFolder folder;
    {
      recording::SensorLogWriter writer(folder / "walk");
      sim::Simulator simulator(sim::find_scenario("relocation"), {.seed = 5, .duration_s = 40.0});
      while (auto step = simulator.next()) writer.write(step->event);
    }
    const auto fusion = journalled_fusion(bus, {"--lossless"});
    WHEN("a bridge plays it") {
      const auto bridge =
          bus.bridge({"--source", "log", "--input", (folder / "walk").string(), "--rate", "0"});
      REQUIRE(bridge->wait_for_exit() == 0);
      THEN("jump, convergence and its end are logged once each, with their levels") {
        REQUIRE(fusion->wait_for_line(Stream::error, "<6>beacon 7: converged, after "));
        REQUIRE(fusion->wait_for_line(Stream::error, "<6>beacon 7: the fixes are trusted again"));
        CAPTURE(fusion->text(Stream::error));
        for (const char* const line :
             {"<4>beacon 7: gated: 10 fixes in a row are outliers, the latest by 2.",
              "<4>beacon 7: relocated: the position jumped by 2.",
              "<4>beacon 7: converging again: the pose is corrected by a large distance",
              "<6>beacon 7: converged, after "}) {
          CAPTURE(line);
          CHECK(count(*fusion, line) == 1);
        }
      }
    }
  }
}

SCENARIO("a reader of the log that goes away does not stop the poses") {
  const Bus bus;
  Consumer<sonopose_FusedPose> poses(bus, topics::pose);
  // The shell becomes the fusion; head ends after the first line.
  Process fusion("/bin/bash", {"-c", R"(exec "$0" "$@" 2> >(head -n 1 >&2))", SONOPOSE_TEST_FUSION,
                               "--domain", std::to_string(bus.domain_id())});
  REQUIRE(fusion.wait_for_line(Stream::error, "serving"));
  {
    const auto bridge = bus.bridge({"--scenario", "rest", "--duration", "3", "--rate", "0"});
    REQUIRE(bridge->wait_for_exit() == 0);
  }
  const auto bridge =
      bus.bridge({"--scenario", "rest", "--address", "9"});  // logs further lines: found, initialised
  CHECK(poses.wait_for(
      [](const FusedPose& pose) { return pose.address == 9 && (pose.status & status_initialising) == 0U; }));
  CHECK(fusion.end_by(SIGINT).code == 0);
}

SCENARIO("a killed bridge, its return and changed settings are logged") {
  GIVEN("a fusion, a relay, and a bridge that logs errors only") {
    const Bus bus;
    const auto fusion = journalled_fusion(bus, {});
    const auto relay = bus.ros2();
    auto bridge = bus.bridge({"--log-level", "error"});
    REQUIRE(fusion->wait_for_line(Stream::error, "<6>beacon 7: initialised, after "));
    REQUIRE(relay->wait_for_line(Stream::error, "sonopose-ros2: beacon 7: initialised, after "));
    WHEN("the bridge ends in good order") {
      const std::size_t earlier = count(*fusion, "<3>beacon 7: bridge lost");
      CHECK(bridge->end_by(SIGINT).code == 0);
      REQUIRE(fusion->wait_for_line(Stream::error, "<4>beacon 7: IMU silent: no sample for "));
      const auto another = bus.bridge({"--log-level", "error"});
      REQUIRE(fusion->wait_for_line(Stream::error, "<6>beacon 7: IMU samples arrive again, after "));
      THEN("no bridge is lost") {
        CHECK(count(*fusion, "<3>beacon 7: bridge lost") == earlier);
      }
    }
    WHEN("the bridge is killed") {
      const std::size_t earlier = count(*fusion, "<3>beacon 7: bridge lost");  // may occur on a busy machine
      bridge->send(SIGKILL);
      REQUIRE(bridge->wait_for_exit() == -SIGKILL);
      REQUIRE(wait_until([&] { return count(*fusion, "<3>beacon 7: bridge lost") > earlier; }));
      REQUIRE(fusion->wait_for_line(Stream::error, "<4>beacon 7: IMU silent: no sample for "));
      REQUIRE(relay->wait_for_line(Stream::error, "sonopose-ros2: warning: beacon 7: no pose for "));
      REQUIRE(count(*fusion, "<3>beacon 7: bridge lost") == earlier + 1);
      REQUIRE(bus.settings({"set", "admission.min_quality_percent=40"}).code == 0);
      REQUIRE(fusion->wait_for_line(
          Stream::error, "<6>settings of all beacons changed: admission.min_quality_percent = 40"));
      const auto another = bus.bridge({});
      THEN("it was logged once, and the return of a bridge is logged") {
        REQUIRE(fusion->wait_for_line(Stream::error, "<6>beacon 7: a bridge sends again, after "));
        REQUIRE(fusion->wait_for_line(Stream::error, "<6>beacon 7: IMU samples arrive again, after "));
        CAPTURE(fusion->text(Stream::error));
        CHECK(count(*fusion, "<6>beacon 7: found") == 1);
        CHECK(count(*fusion, "<6>settings of all beacons changed") == 1);
        CHECK(bridge->text(Stream::error).empty());
        CHECK(another->wait_for_line(Stream::error, "sonopose-bridge: beacon 7: found"));
        CHECK(count(*relay, "sonopose-ros2: beacon 7: found") == 1);
      }
    }
  }
}

}  // namespace sonopose::state_log_test
