/// A log stores a simulated run completely: late and duplicated packets read back in their order of arrival.

#include "recording/log_folder.hpp"
#include "recording/log_writer.hpp"
#include "sim/simulator.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace simulated_log_test {

using namespace sonopose;
using sonopose::test::TemporaryFolder;

/// The event as a log stores it, without flags.
Event as_logged(Event event) {
  if (auto* fix = std::get_if<UltrasonicFix>(&event)) fix->flags = 0;
  return event;
}

SCENARIO("every scenario's log reads back to the events in their order of arrival") {
  std::vector<sim::Scenario> all(sim::scenarios().begin(), sim::scenarios().end());
  all.insert(all.end(), sim::harder_scenarios().begin(), sim::harder_scenarios().end());
  for (const sim::Scenario& scenario : all) {
    GIVEN("the log of a run of " + std::string(scenario.name)) {
      const TemporaryFolder folder;
      const sim::Recording recording = sim::record(scenario, {.seed = 1});
      {
        recording::SensorLogWriter log(folder / "log");
        for (const Event& event : recording.events) log.write(event);
        for (const TruthSample& truth : recording.truth) log.write(truth);
      }
      WHEN("it is read") {
        const recording::SensorLog log = recording::read_sensor_log(folder / "log");
        THEN("its events and its truth are those of the run") {
          REQUIRE(log.events.size() == recording.events.size());
          for (std::size_t i = 0; i < log.events.size(); ++i) {
            REQUIRE(log.events[i] == as_logged(recording.events[i]));
          }
          CHECK(log.truth.size() == recording.truth.size());
        }
      }
    }
  }
}

}  // namespace simulated_log_test
