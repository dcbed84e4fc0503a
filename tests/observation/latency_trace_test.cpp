#include "observation/latency_trace.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace sonopose;
using namespace sonopose::observation;

namespace {

constexpr TimeNs begin_ns = 1'700'000'000'000'000'000;
constexpr TimeNs us = 1'000;

/// Measured, 1 ms later published, 50 µs later taken, 10 µs later written, `last_ns` later here.
PoseTrace trace(std::uint64_t sequence, TimeNs last_ns) {
  FusedPose pose;
  pose.sequence = sequence;
  pose.imu_sensor_time_ns = begin_ns;
  pose.imu_bridge_time_ns = begin_ns + 1000 * us;
  pose.fusion_in_time_ns = begin_ns + 1050 * us;
  pose.fusion_out_time_ns = begin_ns + 1060 * us;
  return trace_of(pose, begin_ns + 1060 * us + last_ns);
}

}  // namespace

TEST_CASE("percentiles of durations") {
  SECTION("of 0 … 100 s in any order: the median is 50 s, and 99 of a hundred lie below 99 s") {
    std::vector<double> durations_s;
    for (int i = 0; i <= 100; ++i) durations_s.push_back((i * 37) % 101);
    const Percentiles percentiles = percentiles_of(durations_s);
    CHECK(percentiles.p50_s == 50.0);
    CHECK(percentiles.p99_s == 99.0);
  }
  SECTION("one late one of a hundred shows in the 99th percentile and not in the median") {
    std::vector<double> durations_s(100, 0.001);
    durations_s[10] = 5.0;
    CHECK(percentiles_of(durations_s).p50_s == 0.001);
    CHECK(percentiles_of(durations_s).p99_s == 5.0);
  }
  SECTION("of a single one: itself") {
    CHECK(percentiles_of({0.25}).p50_s == 0.25);
    CHECK(percentiles_of({0.25}).p99_s == 0.25);
  }
  SECTION("of none: unknown") {
    CHECK(std::isnan(percentiles_of({}).p50_s));
    CHECK(std::isnan(percentiles_of({}).p99_s));
  }
}

SCENARIO("the way of a pose is the sum of its segments") {
  const PoseTrace one = trace(1, 40 * us);
  CHECK(one.latency_s() == Approx(100e-6));
  CHECK(one.legs_s()[0] == Approx(1e-3));
  CHECK(one.legs_s()[1] == Approx(50e-6));
  CHECK(one.legs_s()[2] == Approx(10e-6));
  CHECK(one.legs_s()[3] == Approx(40e-6));
}

SCENARIO("of a long run a fair sample is kept") {
  TraceCollector collector;
  for (std::uint64_t i = 0; i < 200'000; ++i) collector.add(trace(i, i % 10 == 0 ? 900 * us : 40 * us));
  for (std::uint64_t i = 0; i < 200'000; ++i) collector.add(trace(i, i % 10 == 0 ? 1900 * us : 140 * us));
  CHECK(collector.latency().p50_s < 201e-6);
  CHECK(collector.latency().p99_s == Approx(1960e-6));  // a twentieth of all took so long
}

SCENARIO("a collector knows each leg's distribution, and the slowest pose") {
  TraceCollector collector;
  CHECK_FALSE(collector.worst());
  CHECK(std::isnan(collector.latency().p50_s));
  for (std::uint64_t i = 1; i <= 100; ++i) collector.add(trace(i, i == 42 ? 900 * us : 40 * us));
  CHECK(collector.latency().p50_s == Approx(100e-6));
  CHECK(collector.segments()[3].p50_s == Approx(40e-6));
  CHECK(collector.segments()[3].p99_s == Approx(900e-6));
  CHECK(collector.segments()[1].p99_s == Approx(50e-6));
  REQUIRE(collector.worst());
  CHECK(collector.worst()->sequence == 42);
}
