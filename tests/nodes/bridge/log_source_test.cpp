#include "bridge/log_source.hpp"

#include "bridge/collecting_sink.hpp"
#include "bridge/shifted.hpp"
#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "logging/captured_log.hpp"
#include "recording/log_folder.hpp"
#include "recording/log_writer.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <limits>
#include <string>

namespace log_source_test {

using namespace sonopose;
using namespace sonopose::bridge;
using namespace sonopose::publication;
using namespace sonopose::process;
using sonopose::test::CollectingSink;
using sonopose::test::TemporaryFolder;

constexpr TimeNs recorded_ns = 1'600'000'000'000'000'000;
constexpr TimeNs ms = 1'000'000;

/// Writes a log of 2020: an IMU sample, a fix and a heading received 68 ms after their emission, an IMU
/// sample. Each IMU sample has a truth.
void write_log(const std::filesystem::path& folder, BeaconAddress address = 7) {
  recording::SensorLogWriter log(folder);
  for (const TimeNs after_ns : {TimeNs{0}, 100 * ms}) {
    ImuSample imu;
    imu.address = address;
    imu.meaning = ImuMeaning::mean_since_last;
    imu.sensor_time_ns = recorded_ns + after_ns;
    imu.specific_force_body_mps2 = {0.0, 0.0, 9.81};
    log.write(imu);
    TruthSample truth;
    truth.address = address;
    truth.time_ns = imu.sensor_time_ns;
    log.write(truth);
  }
  UltrasonicFix fix;
  fix.address = address;
  fix.emission_time_ns = recorded_ns;
  fix.received_time_ns = recorded_ns + 68 * ms;
  log.write(fix);
  PairHeading heading;
  heading.address = address;
  heading.emission_time_ns = fix.emission_time_ns;
  heading.received_time_ns = fix.received_time_ns;
  heading.valid = true;
  log.write(heading);
}

SCENARIO("a log folder as a source") {
  CollectingSink sink;
  const StopSignal stop;
  const TemporaryFolder folder;
  write_log(folder / "log");
  GIVEN("its stamps as they are") {
    const auto source = make_log_source({.folder = folder / "log", .address = 12, .rate = 0.0});
    CHECK(source->is_recording());
    source->run(sink, stop);
    THEN("it yields the log's events to the last bit, and the truth") {
      CHECK(sink.events == recording::read_sensor_log(folder / "log", 12).events);
      CHECK(sink.events.size() == 4);
      REQUIRE(sink.truth.size() == 2);
      CHECK(sink.truth.front().time_ns == recorded_ns);
      CHECK(sink.truth.front().address == 12);
    }
  }
  GIVEN("no address") {
    write_log(folder / "other", 131);
    make_log_source({.folder = folder / "other", .rate = 0.0})->run(sink, stop);
    THEN("the samples have the one that the log names, and its meaning") {
      REQUIRE(sink.events.size() == 4);
      for (const Event& event : sink.events) CHECK(address_of(event) == 131);
      CHECK(sink.truth.front().address == 131);
      for (const auto& imu : sink.of_kind<ImuSample>()) CHECK(imu.meaning == ImuMeaning::mean_since_last);
    }
  }
  GIVEN("a shift to now") {
    const TimeNs before_ns = clocks::host_now();
    make_log_source({.folder = folder / "log", .rate = 0.0, .restamp = true})->run(sink, stop);
    const TimeNs after_ns = clocks::host_now();
    REQUIRE(sink.events.size() == 4);
    const auto imu = sink.of_kind<ImuSample>();
    const auto fix = sink.of_kind<UltrasonicFix>().front();
    const auto heading = sink.of_kind<PairHeading>().front();
    const TimeNs begin_ns = imu.front().sensor_time_ns;
    THEN("it begins now, and all intervals stay the same") {
      CHECK(begin_ns >= before_ns);
      CHECK(begin_ns <= after_ns);
      CHECK(imu.back().sensor_time_ns == begin_ns + 100 * ms);
      CHECK(fix.emission_time_ns == begin_ns);
      CHECK(fix.received_time_ns == begin_ns + 68 * ms);
      CHECK(heading.emission_time_ns == begin_ns);
      CHECK(heading.received_time_ns == begin_ns + 68 * ms);
      CHECK(fix.measured_delay_s == Approx(0.068));
      CHECK(sink.truth.back().time_ns == begin_ns + 100 * ms);
    }
  }
  GIVEN("real time") {
    const SteadyTime began = clocks::steady_now();
    make_log_source({.folder = folder / "log", .rate = 1.0})->run(sink, stop);
    THEN("its 100 ms take 100 ms") {
      CHECK(clocks::steady_now() - began >= 99 * ms);
    }
  }
  GIVEN("a clock that was set back by an hour in the middle, at a hundred times real time") {
    {
      recording::SensorLogWriter log(folder / "set");
      for (TimeNs i = 0; i < 600; ++i) {
        const TimeNs set_ns = i < 300 ? 0 : 3'600'000 * ms;
        ImuSample imu;
        imu.sensor_time_ns = recorded_ns + i * 10 * ms - set_ns;
        imu.specific_force_body_mps2 = {0.0, 0.0, 9.81};
        log.write(imu);
        UltrasonicFix fix;
        fix.emission_time_ns = imu.sensor_time_ns;
        fix.received_time_ns = imu.sensor_time_ns;
        if (i % 10 == 5) log.write(fix);
      }
    }
    logging::test::CapturedError error;
    const auto source = make_log_source({.folder = folder / "set", .rate = 100.0});
    const SteadyTime began = clocks::steady_now();
    source->run(sink, stop);
    const SteadyTime ended = clocks::steady_now();
    error.restore();
    THEN("its six seconds take 60 ms, and the step is said once") {
      CHECK(sink.events.size() == 660);
      CHECK(ended - began >= 59 * ms);
      const std::string said = error.read();
      const std::string text = "the clock of the log was set back by 60.0 min";
      const std::size_t at = said.find(text);
      REQUIRE(at != std::string::npos);
      CHECK(said.find(text, at + 1) == std::string::npos);
    }
  }
  GIVEN("one fix with a stamp of an hour ago") {
    {
      recording::SensorLogWriter log(folder / "odd");
      for (TimeNs i = 0; i < 30; ++i) {
        ImuSample imu;
        imu.sensor_time_ns = recorded_ns + i * 10 * ms;
        log.write(imu);
        UltrasonicFix fix;
        fix.emission_time_ns = imu.sensor_time_ns - (i == 15 ? 3'600'000 * ms : 0);
        fix.received_time_ns = fix.emission_time_ns;
        if (i % 5 == 0) log.write(fix);
      }
    }
    THEN("the samples that follow are due as before, not in an hour") {
      make_log_source({.folder = folder / "odd", .rate = 100.0})->run(sink, stop);
      CHECK(sink.events.size() == 36);
    }
  }
  GIVEN("a log without a row") {
    { const recording::SensorLogWriter log(folder / "empty"); }
    THEN("it is refused by name") {
      CHECK_THROWS_WITH(make_log_source({.folder = folder / "empty"}),
                        Catch::Contains("empty: has no samples"));
    }
  }
  GIVEN("a folder that does not exist") {
    THEN("it is refused by name") {
      CHECK_THROWS_AS(make_log_source({.folder = folder / "none"}), files::IoError);
      CHECK_THROWS_WITH(make_log_source({.folder = folder / "none"}), Catch::Contains("none"));
    }
  }
}

TEST_CASE("Stamps that cannot be shifted stay at the end of time") {
  constexpr TimeNs greatest = std::numeric_limits<TimeNs>::max();
  UltrasonicFix fix;
  fix.emission_time_ns = std::numeric_limits<TimeNs>::min();
  fix.received_time_ns = greatest;
  const auto later = std::get<UltrasonicFix>(shifted(fix, 100 * ms));
  CHECK(later.emission_time_ns == fix.emission_time_ns + 100 * ms);
  CHECK(later.received_time_ns == greatest);
}

}  // namespace log_source_test
