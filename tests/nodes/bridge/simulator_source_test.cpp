#include "bridge/simulator_source.hpp"

#include "bridge/collecting_sink.hpp"
#include "clocks/clocks.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

namespace simulator_source_test {

using namespace sonopose;
using namespace sonopose::bridge;
using namespace sonopose::publication;
using namespace sonopose::process;
using sonopose::test::CollectingSink;
using sonopose::test::TemporaryFolder;

/// Options of a simulator that runs as fast as possible; a duration of 0 s is unlimited.
SimulatorOptions simulator(double duration_s) {
  SimulatorOptions options;
  options.address = 9;
  options.duration_s = duration_s;
  options.rate = 0.0;
  return options;
}

/// IMU samples of one beacon.
std::vector<ImuSample> imu_of(const CollectingSink& sink, BeaconAddress address) {
  std::vector<ImuSample> samples = sink.of_kind<ImuSample>();
  std::erase_if(samples, [address](const ImuSample& sample) { return sample.address != address; });
  return samples;
}

SCENARIO("the simulator as a source") {
  CollectingSink sink;
  StopSignal stop;
  GIVEN("two seconds of it, as fast as possible") {
    const auto source = make_simulator_source(simulator(2.0));
    CHECK_FALSE(source->is_recording());
    const TimeNs before_ns = clocks::host_now();
    source->run(sink, stop);
    const TimeNs after_ns = clocks::host_now();
    THEN("it yields 200 IMU samples with truth, and fixes at 8 to 16 Hz with headings, and ends") {
      const auto imu = sink.of_kind<ImuSample>();
      CHECK(imu.size() == 200);
      CHECK(sink.truth.size() == 200);
      CHECK(sink.of_kind<UltrasonicFix>().size() >= 14);  // fixes in transit at the end are dropped
      CHECK(sink.of_kind<UltrasonicFix>().size() <= 32);
      CHECK(sink.of_kind<PairHeading>().size() == sink.of_kind<UltrasonicFix>().size());
      CHECK(sink.truth.back().time_ns == imu.back().sensor_time_ns);
    }
    THEN("it begins at the time of run(), with its address") {
      const auto first = sink.of_kind<ImuSample>().front();
      CHECK(first.address == 9);
      CHECK(first.sensor_time_ns >= before_ns);
      CHECK(first.sensor_time_ns <= after_ns);
    }
  }
  GIVEN("a tenth of a second of it in real time, run a while after it was made") {
    SimulatorOptions options = simulator(0.1);
    options.rate = 1.0;
    const auto source = make_simulator_source(options);
    stop.wait_until(clocks::steady_now() + 20'000'000);
    const TimeNs begun_ns = clocks::host_now();
    source->run(sink, stop);
    THEN("no sample is older than the run or early") {
      REQUIRE(sink.of_kind<ImuSample>().size() == 10);
      CHECK(sink.of_kind<ImuSample>().front().sensor_time_ns >= begun_ns);
      CHECK(sink.of_kind<ImuSample>().back().sensor_time_ns <= clocks::host_now());
    }
  }
  GIVEN("an unlimited run") {
    const auto source = make_simulator_source(simulator(0.0));
    sink.stop = &stop;
    sink.stop_after = 1000;
    THEN("the stop ends it") {
      source->run(sink, stop);
      CHECK(sink.events.size() >= 1000);
    }
  }
  GIVEN("a scenario that does not exist") {
    THEN("it is refused with the existing ones") {
      SimulatorOptions options;
      options.scenario = "swim";
      CHECK_THROWS_WITH(make_simulator_source(options), Catch::Contains("swim") && Catch::Contains("walk"));
    }
  }
}

SCENARIO("the simulator has a map of stationary beacons") {
  CollectingSink sink;
  const StopSignal stop;
  GIVEN("a minute of two beacons that walk") {
    SimulatorOptions options = simulator(60.0);
    options.beacons = 2;
    make_simulator_source(options)->run(sink, stop);
    THEN("four stationary beacons surround the walk and are above it, with addresses of their own") {
      REQUIRE(sink.stationary.size() == 4);
      Eigen::AlignedBox3d corners;
      for (const StationaryBeacon& beacon : sink.stationary) {
        REQUIRE(beacon.position_world_m);
        corners.extend(*beacon.position_world_m);
        CHECK(beacon.address > 10);
      }
      for (const TruthSample& truth : sink.truth) {
        REQUIRE((truth.position_world_m.head<2>().array() > corners.min().head<2>().array()).all());
        REQUIRE((truth.position_world_m.head<2>().array() < corners.max().head<2>().array()).all());
        REQUIRE(truth.position_world_m.z() < corners.min().z());
      }
    }
  }
}

SCENARIO("the simulator as a source of several beacons") {
  CollectingSink sink;
  const StopSignal stop;
  GIVEN("two seconds of five beacons from address 9, as fast as possible") {
    SimulatorOptions options = simulator(2.0);
    options.beacons = 5;
    make_simulator_source(options)->run(sink, stop);
    const auto imu = sink.of_kind<ImuSample>();
    THEN("each yields 200 IMU samples with their truth") {
      CHECK(imu.size() == std::size_t{5} * 200);
      CHECK(sink.truth.size() == std::size_t{5} * 200);
      for (BeaconAddress address = 9; address < 14; ++address) CHECK(imu_of(sink, address).size() == 200);
    }
    THEN("the IMU samples of all are evenly spread, a fifth of the period apart") {
      for (std::size_t i = 1; i < imu.size(); ++i) {
        const TimeNs apart_ns = imu[i].sensor_time_ns - imu[i - 1].sensor_time_ns;
        REQUIRE(std::abs(apart_ns - 2'000'000) <= 1);
        REQUIRE(imu[i].address == 9 + i % 5);
      }
    }
    THEN("events are in the order in which they become available") {
      CHECK(std::is_sorted(sink.events.begin(), sink.events.end(), [](const Event& a, const Event& b) {
        return available_at_ns(a) < available_at_ns(b);
      }));
    }
    THEN("the third equals a single beacon with its address and seed") {
      SimulatorOptions alone = simulator(2.0);
      alone.address = 11;
      alone.seed = options.seed + 2;
      CollectingSink single;
      make_simulator_source(alone)->run(single, stop);
      const auto expected = single.of_kind<ImuSample>();
      const auto third = imu_of(sink, 11);
      REQUIRE(third.size() == expected.size());
      for (std::size_t i = 0; i < third.size(); ++i) {
        REQUIRE(third[i].specific_force_body_mps2 == expected[i].specific_force_body_mps2);
        REQUIRE(third[i].angular_velocity_body_radps == expected[i].angular_velocity_body_radps);
      }
    }
  }
  GIVEN("a scenario that draws path and sensors from the seed") {
    SimulatorOptions options = simulator(20.0);
    options.scenario = "moving_start";
    options.beacons = 3;
    make_simulator_source(options)->run(sink, stop);
    SimulatorOptions alone = options;
    alone.beacons = 1;
    alone.address = static_cast<BeaconAddress>(options.address + 2);
    alone.seed = options.seed + 2;
    CollectingSink single;
    make_simulator_source(alone)->run(single, stop);
    THEN("each beacon has its own") {
      const auto expected = single.of_kind<ImuSample>();
      const auto third = imu_of(sink, alone.address);
      const auto first = imu_of(sink, options.address);
      REQUIRE(third.size() == expected.size());
      double difference_mps2 = 0;
      for (std::size_t i = 0; i < third.size(); ++i) {
        REQUIRE(third[i].specific_force_body_mps2 == expected[i].specific_force_body_mps2);
        const Vector3d apart = third[i].specific_force_body_mps2 - first[i].specific_force_body_mps2;
        difference_mps2 = std::max(difference_mps2, apart.norm());
      }
      CHECK(difference_mps2 > 0.5);
    }
  }
  GIVEN("a line that loses, duplicates and delays packets") {
    SimulatorOptions options = simulator(20.0);
    options.scenario = "packet_loss";
    options.beacons = 3;
    make_simulator_source(options)->run(sink, stop);
    THEN("the events of each beacon keep their order of arrival") {
      REQUIRE(sink.events.size() > 5'000);
      std::vector<std::uint64_t> next(16, 1);
      for (const Event& event : sink.events) REQUIRE(sequence_of(event) == next.at(address_of(event))++);
    }
  }
}

SCENARIO("beacons that cannot be simulated are refused") {
  SimulatorOptions options;
  WHEN("the last address would be out of range") {
    options.address = 65000;
    options.beacons = 536;
    THEN("number, first and last address and the limit are reported") {
      using Catch::Contains;
      CHECK_THROWS_WITH(make_simulator_source(options),
                        Contains("536") && Contains("65000") && Contains("65535") && Contains("65534"));
    }
    THEN("one beacon less is allowed") {
      options.beacons = 535;
      CHECK_NOTHROW(make_simulator_source(options));
    }
  }
  WHEN("there are zero or too many") {
    THEN("the number and the limit are reported") {
      for (const std::uint32_t beacons : {0U, 1001U}) {
        options.beacons = beacons;
        CHECK_THROWS_WITH(make_simulator_source(options),
                          Catch::Contains(std::to_string(beacons)) && Catch::Contains("1000"));
      }
    }
  }
  WHEN("the bytes of two beacons are to be captured in one file") {
    const TemporaryFolder folder;
    options.beacons = 2;
    options.capture = folder / "capture.bin";
    THEN("file and number are reported, and no file is created") {
      CHECK_THROWS_WITH(make_simulator_source(options),
                        Catch::Contains("capture.bin") && Catch::Contains("2 beacons"));
      CHECK_FALSE(std::filesystem::exists(*options.capture));
    }
  }
}

}  // namespace simulator_source_test
