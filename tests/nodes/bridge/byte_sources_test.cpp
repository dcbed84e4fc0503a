#include "bridge/byte_sources.hpp"

#include "bridge/collecting_sink.hpp"
#include "bridge/log_source.hpp"
#include "bridge/simulator_source.hpp"
#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "logging/captured_log.hpp"
#include "marvelmind/encoder.hpp"
#include "marvelmind/frames.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace byte_sources_test {

using namespace sonopose;
using namespace sonopose::bridge;
using namespace sonopose::publication;
using namespace sonopose::process;
using namespace sonopose::marvelmind;
using sonopose::test::CollectingSink;
using sonopose::test::PseudoTerminal;
using sonopose::test::TemporaryFolder;

constexpr TimeNs ms = 1'000'000;

/// A file of a beacon's bytes.
class BeaconFile {
public:
  explicit BeaconFile(std::filesystem::path path) : path_(std::move(path)) {}

  BeaconFile& operator<<(const Packet& packet) {
    const Frame frame = encode(packet);
    return append(frame.bytes());
  }
  BeaconFile& append(std::span<const std::uint8_t> bytes) {
    std::ofstream(path_, std::ios::binary | std::ios::app)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return *this;
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

Stamp uptime(std::int64_t time_ms) {
  return {TimeBase::uptime_ms, time_ms};
}

/// An IMU packet at rest and level: +1 g, and 100 steps of 0.0175 deg/s about z.
RawImu imu_at(std::int64_t time_ms) {
  RawImu imu;
  imu.address = 5;
  imu.time = uptime(time_ms);
  imu.accel = {0, 0, 1000};
  imu.gyro = {0, 0, 100};
  imu.flags = imu_compass_not_available;
  return imu;
}

/// A position at (1.234, −2.5, 0.75) m with the pair's axis to the left, sent 60 ms after the emission.
Position position_at(std::int64_t time_ms) {
  Position position;
  position.address = 5;
  position.time = uptime(time_ms);
  position.flags = position_time_in_ms;
  position.xyz_mm = {1234, -2500, 750};
  position.angle.word = 900;
  position.time_passed_ms = 60;
  return position;
}

CollectingSink& played(CollectingSink& sink, const BeaconFile& file, double rate = 0.0) {
  const StopSignal stop;
  make_stream_source({file.path(), rate})->run(sink, stop);
  return sink;
}

SCENARIO("the map in a file of a beacon's bytes is passed on") {
  GIVEN("a map with beacon 2 at (1, 2, 3) m and beacon 3 without a position, between samples") {
    const TemporaryFolder folder;
    StationaryBeacons map;
    map.count = 2;
    map.items[0] = {.address = 2, .xyz_mm = {1000, 2000, 3000}};
    map.items[1] = {.address = 3, .xyz_mm = {}, .location_available = false};
    BeaconFile file(folder.path() / "beacon.bin");
    file << imu_at(1000) << map << imu_at(1010);
    CollectingSink sink;
    const TimeNs before_ns = clocks::host_now();
    played(sink, file);
    THEN("both are known, and the position of the first") {
      REQUIRE(sink.stationary.size() == 2);
      CHECK(sink.stationary[0].address == 2);
      REQUIRE(sink.stationary[0].position_world_m);
      CHECK(sink.stationary[0].position_world_m->isApprox(Vector3d(1, 2, 3)));
      CHECK(sink.stationary[0].time_ns >= before_ns);
      CHECK(sink.stationary[1].address == 3);
      CHECK_FALSE(sink.stationary[1].position_world_m);
    }
    THEN("the samples around it are there") {
      CHECK(sink.of_kind<ImuSample>().size() == 2);
    }
  }
}

SCENARIO("a file of a beacon's bytes is played as samples") {
  const TemporaryFolder folder;
  BeaconFile file(folder / "bytes.bin");
  CollectingSink sink;
  GIVEN("IMU samples, a position with its quality, and telemetry") {
    file << imu_at(10'000) << Telemetry{.battery_mv = 3900, .rssi_dbm = -40, .address = 5} << imu_at(10'010)
         << position_at(9'950) << Quality{.address = 5, .quality_percent = 87} << imu_at(10'020);
    const TimeNs before_ns = clocks::host_now();
    played(sink, file);
    const TimeNs after_ns = clocks::host_now();
    const auto imu = sink.of_kind<ImuSample>();
    const auto fixes = sink.of_kind<UltrasonicFix>();
    const auto headings = sink.of_kind<PairHeading>();
    REQUIRE(imu.size() == 3);
    REQUIRE(fixes.size() == 1);
    REQUIRE(headings.size() == 1);
    THEN("values are in SI units") {
      CHECK(imu[0].address == 5);
      CHECK(imu[0].specific_force_body_mps2.z() == Approx(9.81).epsilon(0.001));
      CHECK(imu[0].angular_velocity_body_radps.z() == Approx(1.75 * M_PI / 180));
      CHECK_FALSE(imu[0].magnetic_field_body_t);
      CHECK(fixes[0].position_world_m.isApprox(Vector3d(1.234, -2.5, 0.75)));
      CHECK(fixes[0].quality_percent == 87.0);
      CHECK(fixes[0].measured_delay_s == Approx(0.060));
      CHECK(headings[0].valid);
      CHECK(headings[0].heading_world_rad == Approx(M_PI / 2));
    }
    THEN("the meaning of IMU samples is unknown, unless the user declares it") {
      for (const ImuSample& sample : imu) CHECK(sample.meaning == ImuMeaning::unknown);
      CollectingSink declared;
      make_stream_source({file.path(), 0.0, ImuMeaning::mean_since_last})->run(declared, StopSignal());
      REQUIRE(declared.of_kind<ImuSample>().size() == 3);
      for (const ImuSample& sample : declared.of_kind<ImuSample>()) {
        CHECK(sample.meaning == ImuMeaning::mean_since_last);
      }
    }
    THEN("the first packet is stamped now, and the others by the beacon's clock") {
      const TimeNs first_ns = imu[0].sensor_time_ns;
      CHECK(first_ns >= before_ns - 100 * ms);
      CHECK(first_ns <= after_ns);
      CHECK(imu[1].sensor_time_ns - first_ns == 10 * ms);
      CHECK(imu[2].sensor_time_ns - first_ns == 20 * ms);
      CHECK(fixes[0].emission_time_ns - first_ns == -50 * ms);
      CHECK(fixes[0].received_time_ns - fixes[0].emission_time_ns >= 60 * ms);
      CHECK(headings[0].emission_time_ns == fixes[0].emission_time_ns);
    }
    THEN("the status has the beacon's telemetry and the line's counters") {
      REQUIRE(!sink.statuses.empty());
      const BeaconStatus& status = sink.statuses.back();
      CHECK(status.address == 5);
      CHECK(status.battery_v == Approx(3.9));
      CHECK(status.rssi_dbm == -40.0);
      CHECK(status.frames == 6);
      CHECK(status.crc_errors == 0);
      CHECK(status.bytes_lost == 0);
    }
  }
  GIVEN("garbage between frames, a broken frame and a position that is not available") {
    const std::vector<std::uint8_t> garbage{0x00, 0x12, 0x34};
    const auto whole = encode(imu_at(10'010));
    std::vector<std::uint8_t> flipped(whole.bytes().begin(), whole.bytes().end());
    flipped[8] ^= 0x01;
    Position unavailable = position_at(9'950);
    unavailable.flags |= position_not_available;
    file << imu_at(10'000);
    file.append(garbage).append(flipped) << unavailable << imu_at(10'020);
    played(sink, file);
    THEN("the valid samples are published, and the rest is counted") {
      CHECK(sink.of_kind<ImuSample>().size() == 2);
      CHECK(sink.of_kind<UltrasonicFix>().empty());
      const BeaconStatus& status = sink.statuses.back();
      CHECK(status.frames == 3);
      CHECK(status.crc_errors == 1);
      CHECK(status.bytes_lost >= garbage.size());
      CHECK(status.fixes_unavailable == 1);
    }
  }
  GIVEN("21 samples that share a millisecond") {
    for (int i = 0; i < 21; ++i) file << imu_at(10'000);
    played(sink, file);
    THEN("none counts as a duplicate") {
      CHECK(sink.of_kind<ImuSample>().size() == 21);
    }
  }
  GIVEN("a file that ends within a frame") {
    file << imu_at(10'000);
    file.append(encode(imu_at(10'010)).bytes().first(20));
    THEN("the complete frames are published, and the source ends") {
      CHECK(played(sink, file).of_kind<ImuSample>().size() == 1);
    }
  }
  GIVEN("two samples 100 ms apart, in real time") {
    file << imu_at(10'000) << imu_at(10'100);
    const SteadyTime began = clocks::steady_now();
    THEN("they take 100 ms") {
      CHECK(played(sink, file, 1.0).of_kind<ImuSample>().size() == 2);
      CHECK(clocks::steady_now() - began >= 99 * ms);
    }
  }
}

SCENARIO("a file with more beacons than are accepted is an error") {
  GIVEN("samples of two beacons") {
    const TemporaryFolder folder;
    BeaconFile file(folder / "bytes.bin");
    RawImu other = imu_at(10'010);
    other.address = 6;
    file << imu_at(10'000) << other;
    const auto play = [&](std::size_t max_beacons) {
      CollectingSink sink;
      make_stream_source({file.path(), 0.0, ImuMeaning::unknown, max_beacons})->run(sink, StopSignal());
      return sink.events.size();
    };
    THEN("two are played, and for one the error names the file, the second beacon and the limit") {
      CHECK(play(2) == 2);
      CHECK_THROWS_WITH(play(1), Catch::Contains("bytes.bin: beacon 6 is one more than --max-beacons 1"));
    }
  }
}

SCENARIO("a file of bytes that have no sample is an error that names what they are") {
  const TemporaryFolder folder;
  const auto file = folder / "bytes.bin";
  GIVEN("sentences of a beacon in NMEA mode") {
    std::string sentences;
    for (int i = 0; i < 100; ++i) sentences += "$GPGLL,4916.45,N,12311.12,W,225444,A*31\r\n";
    sonopose::test::write_text(file, sentences);
    THEN("file, protocol and the setting of the beacon are named") {
      CHECK_THROWS_WITH(make_stream_source({file}),
                        Catch::Contains(file.string() + ": NMEA sentences ($GPGLL)") &&
                            Catch::Contains("protocol") && Catch::Contains("Marvelmind"));
    }
  }
  GIVEN("a recording") {
    sonopose::test::write_text(file, "\x89MCAP0\r\n");
    THEN("the source for it is named") {
      CHECK_THROWS_WITH(make_stream_source({file}),
                        Catch::Contains("an MCAP file") && Catch::Contains("--source log or mcap"));
    }
  }
  GIVEN("nothing") {
    sonopose::test::write_text(file, "");
    CHECK_THROWS_WITH(make_stream_source({file}), Catch::EndsWith("bytes.bin: is empty"));
  }
  GIVEN("a beacon's frames whose zeros became blanks") {
    BeaconFile bytes(file);
    for (int i = 0; i < 20; ++i) bytes << imu_at(10'000 + 10 * i);
    std::string text = sonopose::test::read_text(file);
    std::ranges::replace(text, '\0', ' ');
    sonopose::test::write_text(file, text);
    CHECK_THROWS_WITH(make_stream_source({file}), Catch::Contains("frames with a wrong checksum") &&
                                                      Catch::Contains("the file is damaged"));
  }
  GIVEN("an IMU sample of 2026 and two of 2106") {
    BeaconFile bytes(file);
    for (const std::int64_t unix_ms : {1'795'000'000'000, 4'294'967'000'000, 4'294'967'000'010}) {
      RawImu imu = imu_at(0);
      imu.time = {TimeBase::unix_ms, unix_ms};
      bytes << imu;
    }
    CollectingSink sink;
    THEN("the first is published, and the others are counted") {
      const auto source = make_stream_source({file, 0.0});
      CHECK_THROWS_WITH(source->run(sink, StopSignal()),
                        Catch::Contains("bytes.bin: 2 samples of beacon 5 are stamped in the year 2100"));
      CHECK(sink.of_kind<ImuSample>().size() == 1);
    }
  }
  GIVEN("valid frames of telemetry alone") {
    BeaconFile(file) << Telemetry{.battery_mv = 3900, .rssi_dbm = -40, .address = 5};
    CollectingSink sink;
    THEN("the streams to enable are named") {
      const auto source = make_stream_source({file, 0.0});
      CHECK_THROWS_WITH(source->run(sink, StopSignal()),
                        Catch::Contains("1 valid frame, but no sample") && Catch::Contains("raw IMU"));
    }
  }
}

SCENARIO("a beacon that turns to another protocol is named with it") {
  const TemporaryFolder folder;
  BeaconFile file(folder / "bytes.bin");
  file << imu_at(10'000) << imu_at(10'010);
  const auto [bytes, name] = GENERATE(table<std::string, std::string>(
      {{"$GPGLL,4916.45,N,12311.12,W,225444,A*31\r\n", "NMEA sentences ($GPGLL)"},
       {std::string("\xB5\x62\x05\x01\x02\x00\x06\x01\x0F\x38", 10),
        "messages of a u-blox receiver (UBX)"}}));
  for (int i = 0; i < 20; ++i) file.append(std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
  CollectingSink sink;
  logging::test::CapturedError error;
  make_stream_source({file.path(), 0.0})->run(sink, StopSignal());
  error.restore();
  CHECK(sink.events.size() == 2);
  CHECK_THAT(error.read(), Catch::Contains(" bytes are in no valid frame") &&
                               Catch::Contains("found " + name + ": set the protocol"));
}

/// Sends frames to the line at its first report, and stops it at the fourth.
class FeedingSink final : public CollectingSink {
public:
  FeedingSink(const PseudoTerminal& beacon, StopSignal& line) : beacon_(beacon), line_(line) {}

  void tick() override {
    CollectingSink::tick();
    if (ticks == 4) line_.request();
    if (ticks > 1) return;
    beacon_.send(encode(imu_at(10'000)).bytes());
    for (const auto& frame : testing::unused_frames()) beacon_.send(frame);
  }

private:
  const PseudoTerminal& beacon_;
  StopSignal& line_;
};

SCENARIO("frames of kinds that are not used are said once") {
  logging::test::CapturedError error;
  GIVEN("a file with 18 of them") {
    const TemporaryFolder folder;
    BeaconFile file(folder / "bytes.bin");
    file << imu_at(10'000);
    for (int i = 0; i < 3; ++i) {
      for (const auto& frame : testing::unused_frames()) file.append(frame);
    }
    file << imu_at(10'010);
    CollectingSink sink;
    CHECK(played(sink, file).events.size() == 2);
    error.restore();
    THEN("they are counted") {
      CHECK_THAT(error.read(),
                 Catch::Contains("bytes.bin: ignored 18 frames of unused kinds, such as raw distances"));
    }
  }
  GIVEN("a line with some of them, and several reports") {
    const PseudoTerminal beacon;
    StopSignal stop;
    FeedingSink sink(beacon, stop);
    make_serial_source({beacon.device()}, {})->run(sink, stop);
    error.restore();
    REQUIRE(sink.of_kind<ImuSample>().size() == 1);
    THEN("one line says so") {
      const std::string said = error.read();
      const std::string text = "ignores frames of unused kinds, such as raw distances";
      const std::size_t at = said.find(text);
      REQUIRE(at != std::string::npos);
      CHECK(said.find(text, at + 1) == std::string::npos);
    }
  }
}

SCENARIO("a stream is a recording, and ends at the stop") {
  const TemporaryFolder folder;
  BeaconFile file(folder / "bytes.bin");
  file << imu_at(10'000) << imu_at(3'600'000);
  CollectingSink sink;
  StopSignal stop;
  const auto source = make_stream_source({file.path(), 1.0});
  CHECK(source->is_recording());
  sink.stop = &stop;
  sink.stop_after = 1;
  source->run(sink, stop);  // the next sample is due in an hour
  CHECK(sink.events.size() == 1);
}

SCENARIO("a capture of the simulator plays back as the samples that it published") {
  GIVEN("a second of the simulator, with its bytes") {
    const TemporaryFolder folder;
    const StopSignal stop;
    CollectingSink sent;
    CollectingSink received;
    SimulatorOptions simulator;
    simulator.duration_s = 1.0;
    simulator.rate = 0.0;
    simulator.capture = folder / "bytes.bin";
    make_simulator_source(simulator)->run(sent, stop);
    make_stream_source({folder / "bytes.bin", 0.0})->run(received, stop);
    THEN("the samples are the same up to the wire's steps, in the same order") {
      REQUIRE(received.events.size() == sent.events.size());
      REQUIRE(sent.events.size() > 100);
      for (std::size_t i = 0; i < sent.events.size(); ++i) {
        REQUIRE(received.events[i].index() == sent.events[i].index());
        if (const auto* before = std::get_if<ImuSample>(&sent.events[i])) {
          const auto& after = std::get<ImuSample>(received.events[i]);
          const Vector3d moved = after.specific_force_body_mps2 - before->specific_force_body_mps2;
          REQUIRE(moved.cwiseAbs().maxCoeff() <= 0.5 * 9.81e-3);
        }
      }
    }
  }
}

TEST_CASE("byte sources refuse unusable inputs by name") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH(make_stream_source({folder / "none.bin"}), Catch::Contains("none.bin"));
  CHECK_THROWS_AS(make_stream_source({folder.path()}), files::IoError);
  CHECK_THROWS_AS(make_udp_source({.listen = "nonsense"}, {}), std::invalid_argument);
  CHECK_THROWS_AS(make_serial_source({.device = folder.path().string()}, {}), std::invalid_argument);
}

}  // namespace byte_sources_test
