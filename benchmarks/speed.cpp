// Measures computation only: the decoder in MB/s, the engines in ns per IMU sample, and the Mahony update for
// comparison.

#include "marvelmind/decoder.hpp"
#include "marvelmind/disassembler.hpp"
#include "marvelmind/encoder.hpp"
#include "sim/simulator.hpp"
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>

#include <algorithm>
#include <benchmark/benchmark.h>
#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

namespace {

using namespace sonopose;

/// Returns a minute of a walking beacon as events.
const std::vector<Event>& recorded_events() {
  static const std::vector<Event> events = [] {
    constexpr TimeNs start_ns = 1'700'000'000'000'000'000;
    sim::Simulator simulator(sim::find_scenario("walk"), {},
                             {.seed = 1, .start_time_ns = start_ns, .address = 7, .duration_s = 60.0});
    std::vector<Event> made;
    while (const auto step = simulator.next()) made.push_back(step->event);
    return made;
  }();
  return events;
}

/// Returns the same minute as bytes of the beacon.
const std::vector<std::uint8_t>& recorded_bytes() {
  static const std::vector<std::uint8_t> bytes = [] {
    std::vector<std::uint8_t> made;
    marvelmind::Disassembler disassembler(
        {.beacon_zero_ns = available_at_ns(recorded_events().front()) - 1'000'000'000});
    const auto append = [&made](const marvelmind::Packet& packet) {
      const marvelmind::Frame frame = marvelmind::encode(packet);
      made.insert(made.end(), frame.bytes().begin(), frame.bytes().end());
    };
    for (const Event& event : recorded_events()) disassembler.on(event, append);
    return made;
  }();
  return bytes;
}

void decoder(benchmark::State& state) {
  const auto& bytes = recorded_bytes();
  for (auto run : state) {
    marvelmind::Decoder decoder;
    std::size_t packets = 0;
    decoder.feed(bytes, [&packets](const marvelmind::Packet&) { ++packets; });
    benchmark::DoNotOptimize(packets);
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes.size()));
}
BENCHMARK(decoder);

settings::Settings settings_of(settings::EngineKind engine) {
  settings::Settings settings;
  settings.engine.engine = engine;
  return settings;
}

void engine_per_imu_sample(benchmark::State& state, settings::EngineKind kind) {
  const auto& events = recorded_events();
  std::int64_t samples = 0;
  for (auto run : state) {
    estimation::AnyEstimator estimator{settings_of(kind)};
    for (const Event& event : events) {
      benchmark::DoNotOptimize(estimation::process(estimator, event));
      if (std::holds_alternative<ImuSample>(event)) ++samples;
    }
  }
  state.counters["per_sample"] = benchmark::Counter(
      static_cast<double>(samples), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  // One second of 100 Hz data is 100 samples.
  state.counters["times_real_time"] =
      benchmark::Counter(static_cast<double>(samples) / 100.0, benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(engine_per_imu_sample, documented, settings::EngineKind::documented);
BENCHMARK_CAPTURE(engine_per_imu_sample, kalman, settings::EngineKind::kalman);

/// Measures the time from an IMU sample to its pose if the caches went cold since the last one: the median
/// over the samples of 20 s.
void pose_from_cold_caches(benchmark::State& state, settings::EngineKind kind) {
  constexpr std::size_t more_than_the_caches = 40U << 20U;
  std::vector<std::uint64_t> other(more_than_the_caches / sizeof(std::uint64_t));
  for (auto run : state) {
    estimation::AnyEstimator estimator{settings_of(kind)};
    std::vector<double> times_ns;
    for (const Event& event : std::span(recorded_events()).first(2500)) {
      const bool is_imu = std::holds_alternative<ImuSample>(event);
      if (is_imu) {
        for (std::uint64_t& word : other) ++word;
        benchmark::ClobberMemory();
      }
      const auto begin = std::chrono::steady_clock::now();
      benchmark::DoNotOptimize(estimation::process(estimator, event));
      const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
      if (is_imu) times_ns.push_back(took.count());
      estimator.finish_pending_work();
    }
    const auto middle = times_ns.begin() + static_cast<std::ptrdiff_t>(times_ns.size() / 2);
    std::nth_element(times_ns.begin(), middle, times_ns.end());
    state.SetIterationTime(1e-9 * *middle);
  }
}
BENCHMARK_CAPTURE(pose_from_cold_caches, documented, settings::EngineKind::documented)
    ->UseManualTime()
    ->Iterations(1);
BENCHMARK_CAPTURE(pose_from_cold_caches, kalman, settings::EngineKind::kalman)
    ->UseManualTime()
    ->Iterations(1);

/// Measures the most expensive event of the Kalman engine, including what it leaves to repeat. It is a fix of
/// the greatest age while all eight starts of an unknown yaw are alive, as for a body at rest. The argument
/// is the rate of the IMU, Hz.
void latest_fix_with_all_starts(benchmark::State& state) {
  const TimeNs age_ns = to_ns(settings::Settings{}.admission.max_fix_age_s) - 1'000'000;
  sim::SensorSettings sensors;
  sensors.imu_rate_hz = static_cast<double>(state.range(0));
  sensors.pair_heading = false;
  sim::Simulator simulator(sim::find_scenario("rest"), sensors, {.seed = 1, .duration_s = 10.0});
  estimation::kalman::Engine before{settings::Settings{}};
  UltrasonicFix fix;
  while (const auto step = simulator.next()) {
    estimation::process(before, step->event);
    if (const auto* latest = std::get_if<UltrasonicFix>(&step->event)) fix = *latest;
  }
  if (before.state().phase != estimation::kalman::Phase::searching_yaw) {
    state.SkipWithError("the yaw is not searched");
    return;
  }
  fix.emission_time_ns = before.time_ns() - age_ns;
  fix.received_time_ns = before.time_ns();
  fix.measured_delay_s = seconds_between(fix.emission_time_ns, fix.received_time_ns);
  estimation::kalman::Engine engine{settings::Settings{}};
  for (auto run : state) {
    state.PauseTiming();
    engine = before;
    fix.emission_time_ns += 1;  // a repeated fix would be refused
    state.ResumeTiming();
    const FixReport report = engine.correct(fix);
    engine.finish_pending_work();
    if ((report.flags & fix_used) == 0) {
      state.SkipWithError("the fix was not used");
      break;
    }
  }
}
BENCHMARK(latest_fix_with_all_starts)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);

void mahony_per_imu_sample(benchmark::State& state) {
  const auto& events = recorded_events();
  std::int64_t samples = 0;
  for (auto run : state) {
    attitude::Mahony filter;
    const attitude::MahonySettings settings;
    for (const Event& event : events) {
      const auto* imu = std::get_if<ImuSample>(&event);
      if (imu == nullptr) continue;
      filter.update(settings, {.dt_s = 0.01,
                               .angular_velocity_body_radps = imu->angular_velocity_body_radps,
                               .specific_force_body_mps2 = imu->specific_force_body_mps2});
      ++samples;
    }
    benchmark::DoNotOptimize(filter);
  }
  state.counters["per_sample"] = benchmark::Counter(
      static_cast<double>(samples), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(mahony_per_imu_sample);

}  // namespace

BENCHMARK_MAIN();
