// 112 s of bytes recorded from a real pair of beacons, compared with the log folder of the same recording.

#include "marvelmind/assembler.hpp"
#include "marvelmind/conversions.hpp"
#include "marvelmind/decoder.hpp"
#include "marvelmind/frames.hpp"
#include "support/events.hpp"
#include "support/recordings.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace recording_test {

using namespace sonopose;
using namespace sonopose::marvelmind;

const std::filesystem::path folder = test::beacon_recordings("car");

struct Row {
  TimeNs time_ns = 0;
  std::vector<double> values;
};

std::vector<Row> read_csv(const std::string& name) {
  std::ifstream file(folder / name);
  std::vector<Row> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream cells(line);
    std::string cell;
    std::getline(cells, cell, ',');
    Row row{std::stoll(cell), {}};
    while (std::getline(cells, cell, ',')) row.values.push_back(std::stod(cell));
    rows.push_back(std::move(row));
  }
  return rows;
}

/// The recorded bytes. If they are missing: none, and prints the word that marks a test as skipped.
marvelmind::testing::Bytes read_stream() {
  if (!test::is_here(folder)) return {};
  const std::string bytes = test::read_text(folder / "stream.bin");
  return {bytes.begin(), bytes.end()};
}

TEST_CASE("The car's recorded bytes give every sample of its log folder") {
  const auto stream = read_stream();
  if (stream.empty()) return;
  const auto imu_rows = read_csv("imu.csv");
  const auto fix_rows = read_csv("ultrasonic.csv");
  const auto heading_rows = read_csv("heading.csv");
  REQUIRE(imu_rows.size() == 10555);
  REQUIRE(fix_rows.size() == 1182);

  // The folder's times are the stream's uptimes plus this epoch.
  constexpr TimeNs epoch_ns = 1'700'000'000'000'000'000;
  const TimeNs first_sent_ns = fix_rows.front().time_ns / 1'000'000 * 1'000'000 + 68'000'000;
  REQUIRE(first_sent_ns - epoch_ns == 659'000'000);

  std::vector<Event> events;
  const auto collect = [&events](const Event& event) { events.push_back(event); };
  Assembler assembler(TimeMapping::fixed);
  Decoder decoder;
  const auto on_packet = [&](const Packet& packet) {
    assembler.on(packet, assembler.replay_arrival_ns(packet, first_sent_ns), collect);
  };
  decoder.feed(stream, on_packet);
  decoder.finish(on_packet);
  assembler.finish(collect);

  CHECK(decoder.counters() == DecoderCounters{.frames = 10555 + 1182 + 1182});
  const auto samples = test::samples_of<ImuSample>(events);
  const auto fixes = test::samples_of<UltrasonicFix>(events);
  const auto headings = test::samples_of<PairHeading>(events);
  REQUIRE(samples.size() == imu_rows.size());
  REQUIRE(fixes.size() == fix_rows.size());
  REQUIRE(headings.size() == fix_rows.size());

  constexpr TimeNs ms = 1'000'000;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto& row = imu_rows[i];
    CHECK(std::abs(samples[i].sensor_time_ns - row.time_ns) <= ms);
    const Vector3d gyro(row.values[0], row.values[1], row.values[2]);
    const Vector3d accel(row.values[3], row.values[4], row.values[5]);
    CHECK((samples[i].angular_velocity_body_radps - gyro).cwiseAbs().maxCoeff() <= 0.51 * gyro_radps_per_lsb);
    CHECK((samples[i].specific_force_body_mps2 - accel).cwiseAbs().maxCoeff() <= 0.51 * accel_mps2_per_lsb);
    CHECK_FALSE(samples[i].magnetic_field_body_t);
  }
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    const auto& row = fix_rows[i];
    CHECK(std::abs(fixes[i].emission_time_ns - row.time_ns) <= ms);
    CHECK((fixes[i].position_world_m - Vector3d(row.values[1], row.values[2], row.values[3])).norm() <= 1e-3);
    CHECK(fixes[i].quality_percent == Approx(row.values[4]));
    CHECK(fixes[i].measured_delay_s == Approx(0.068));
  }
  CHECK(std::count_if(headings.begin(), headings.end(), [](const auto& h) { return h.valid; }) ==
        static_cast<std::ptrdiff_t>(heading_rows.size()));
  CHECK(assembler.beacon(7)->status().clock_resets == 0);
}

TEST_CASE("The car's bytes over a line with jitter lose nothing, and keep the IMU's intervals") {
  const auto stream = read_stream();
  if (stream.empty()) return;
  constexpr TimeNs origin_ns = 1'700'000'000'000'000'000;
  std::mt19937_64 random(1);
  std::exponential_distribution<double> lateness_s(1 / 3e-3);

  std::vector<Event> events;
  const auto collect = [&events](const Event& event) { events.push_back(event); };
  Assembler by_content(TimeMapping::fixed);  // knows when each packet was sent
  Assembler assembler(TimeMapping::fitted);
  Decoder decoder;
  TimeNs arrival_ns = 0;
  decoder.feed(stream, [&](const Packet& packet) {
    const TimeNs sent_ns = by_content.replay_arrival_ns(packet, origin_ns);
    arrival_ns = std::max(arrival_ns, sent_ns + to_ns(lateness_s(random)));
    assembler.on(packet, arrival_ns, collect);
  });
  assembler.finish(collect);

  const auto samples = test::samples_of<ImuSample>(events);
  CHECK(samples.size() == 10555);
  CHECK(test::samples_of<UltrasonicFix>(events).size() == 1182);
  const auto status = assembler.beacon(7)->status();
  CHECK(status.clock_resets == 0);
  CHECK(status.clock_jitter_s < 10e-3);

  const auto rows = read_csv("imu.csv");
  const double recorded_s = seconds_between(rows.front().time_ns, rows.back().time_ns);
  const double mapped_s = seconds_between(samples.front().sensor_time_ns, samples.back().sensor_time_ns);
  CHECK(std::abs(mapped_s - recorded_s) < 3e-3);
  CHECK(std::is_sorted(samples.begin(), samples.end(),
                       [](const auto& a, const auto& b) { return a.sensor_time_ns < b.sensor_time_ns; }));
}

}  // namespace recording_test
