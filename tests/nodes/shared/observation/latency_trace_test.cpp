#include "observation/latency_trace.hpp"

#include <catch2/catch.hpp>

#include <cmath>

namespace latency_trace_test {

using namespace sonopose;
using namespace sonopose::observation;

constexpr TimeNs begin_ns = 1'700'000'000'000'000'000;
constexpr TimeNs us = 1'000;

/// Trace of a sample published 1 ms after its measurement and received by the fusion 50 µs later. Its pose is
/// published after another 10 µs and received after `last_ns`.
PoseTrace trace(std::uint64_t sequence, TimeNs last_ns) {
  FusedPose pose;
  pose.sequence = sequence;
  pose.imu_sensor_time_ns = begin_ns;
  pose.imu_bridge_time_ns = begin_ns + 1000 * us;
  pose.fusion_in_time_ns = begin_ns + 1050 * us;
  pose.fusion_out_time_ns = begin_ns + 1060 * us;
  return trace_of(pose, begin_ns + 1060 * us + last_ns);
}

TEST_CASE("percentiles of durations") {
  SECTION("0 … 100 s in any order: the median is 50 s, the 99th percentile 99 s") {
    std::vector<double> durations_s;
    for (int i = 0; i <= 100; ++i) durations_s.push_back((i * 37) % 101);
    const Percentiles percentiles = percentiles_of(durations_s);
    CHECK(percentiles.p50_s == 50.0);
    CHECK(percentiles.p99_s == 99.0);
  }
  SECTION("one outlier in a hundred raises the 99th percentile and not the median") {
    std::vector<double> durations_s(100, 0.001);
    durations_s[10] = 5.0;
    CHECK(percentiles_of(durations_s).p50_s == 0.001);
    CHECK(percentiles_of(durations_s).p99_s == 5.0);
  }
  SECTION("a single duration") {
    CHECK(percentiles_of({0.25}).p50_s == 0.25);
    CHECK(percentiles_of({0.25}).p99_s == 0.25);
  }
  SECTION("an empty set: NaN") {
    CHECK(std::isnan(percentiles_of({}).p50_s));
    CHECK(std::isnan(percentiles_of({}).p99_s));
  }
}

SCENARIO("the segments of a pose add up to its latency") {
  const PoseTrace one = trace(1, 40 * us);
  CHECK(one.latency_s() == Approx(100e-6));
  CHECK(one.segments_s()[0] == Approx(1e-3));
  CHECK(one.segments_s()[1] == Approx(50e-6));
  CHECK(one.segments_s()[2] == Approx(10e-6));
  CHECK(one.segments_s()[3] == Approx(40e-6));
}

SCENARIO("the age of a sample with a stamp of another time is not known") {
  PoseTrace played = trace(1, 40 * us);
  played.sensor_ns -= 86'400'000'000'000;
  CHECK(std::isnan(played.segments_s()[0]));
  TraceCollector collector;
  collector.add(played);
  CHECK(std::isnan(collector.segments()[0].p50_s));
  CHECK(collector.segments()[1].p50_s == Approx(50e-6));
  CHECK(collector.latency().p50_s == Approx(100e-6));
}

SCENARIO("a long run is sampled uniformly") {
  TraceCollector collector;
  for (std::uint64_t i = 0; i < 200'000; ++i) collector.add(trace(i, i % 10 == 0 ? 900 * us : 40 * us));
  for (std::uint64_t i = 0; i < 200'000; ++i) collector.add(trace(i, i % 10 == 0 ? 1900 * us : 140 * us));
  CHECK(collector.latency().p50_s < 201e-6);
  CHECK(collector.latency().p99_s == Approx(1960e-6));  // the latency of a twentieth of all
}

SCENARIO("collectors of consecutive windows add up") {
  TraceCollector window;
  TraceCollector all;
  for (std::uint64_t i = 0; i < 400'000; ++i) {
    const bool is_slow = i >= 200'000;
    window.add(trace(i, (i % 10 == 0 ? 900 * us : 40 * us) + (is_slow ? 1000 * us : 0)));
    if (i % 1000 != 999) continue;
    all.add(window);
    window.clear();
  }
  CHECK_FALSE(window.worst());
  CHECK(std::isnan(window.latency().p50_s));
  CHECK(all.latency().p50_s == Approx(1000e-6).margin(50e-6));  // between the fast and the slow half
  CHECK(all.latency().p99_s == Approx(1960e-6));
  CHECK(all.worst()->latency_s() == Approx(1960e-6));
}

SCENARIO("a collector has the distribution of each segment, and the slowest pose") {
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

}  // namespace latency_trace_test
