// Replays an hour of 100 Hz data: reading the folder, running the engine, smoothing; and runs a calibration.

#include "calibration/drive/drive_fit.hpp"
#include "evaluation/replay/run.hpp"
#include "evaluation/replay/smoothed_run.hpp"
#include "recording/log_folder.hpp"
#include "recording/log_writer.hpp"
#include "sim/simulator.hpp"

#include <benchmark/benchmark.h>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace sonopose;

constexpr double hour_s = 3600.0;

/// A temporary folder with an hour of a walking beacon.
class HourOfWalking {
public:
  HourOfWalking() {
    std::string name = (std::filesystem::temp_directory_path() / "sonopose-benchmark-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder: " + name);
    folder_ = name;
    record(folder_ / "with_truth", true);
    record(folder_ / "without_truth", false);
  }
  ~HourOfWalking() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  HourOfWalking(const HourOfWalking&) = delete;
  HourOfWalking& operator=(const HourOfWalking&) = delete;

  [[nodiscard]] std::filesystem::path folder(bool with_truth) const {
    return folder_ / (with_truth ? "with_truth" : "without_truth");
  }

private:
  static void record(const std::filesystem::path& folder, bool with_truth) {
    sim::Simulator simulator(sim::find_scenario("walk"), {.duration_s = hour_s});
    recording::SensorLogWriter log(folder);
    while (const auto step = simulator.next()) {
      log.write(step->event);
      if (with_truth && step->truth) log.write(*step->truth);
    }
    log.flush();
  }

  std::filesystem::path folder_;
};

std::filesystem::path hour(bool with_truth) {
  static const HourOfWalking walk;
  return walk.folder(with_truth);
}

void count_real_time(benchmark::State& state) {
  state.counters["times_real_time"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * hour_s, benchmark::Counter::kIsRate);
}

void replay_hour(benchmark::State& state) {
  const auto folder = hour(state.range(0) != 0);
  for (auto run : state) benchmark::DoNotOptimize(evaluation::run(recording::read_sensor_log(folder), {}));
  count_real_time(state);
}

void replay_hour_reading_alone(benchmark::State& state) {
  const auto folder = hour(state.range(0) != 0);
  for (auto run : state) benchmark::DoNotOptimize(recording::read_sensor_log(folder));
  count_real_time(state);
}

void replay_hour_engine_alone(benchmark::State& state) {
  const auto log = recording::read_sensor_log(hour(state.range(0) != 0));
  for (auto run : state) benchmark::DoNotOptimize(evaluation::run(log, {}));
  count_real_time(state);
}

/// Smooths an hour, without counting the time of reading.
void smooth_hour(benchmark::State& state) {
  const auto log = recording::read_sensor_log(hour(false));
  for (auto run : state) benchmark::DoNotOptimize(evaluation::run_smoothed(log, {}));
  count_real_time(state);
}

/// Calibrates everything from two minutes of the kart: grid, two fits and the judgement by the engine.
void calibrate_two_minutes(benchmark::State& state) {
  constexpr double drive_s = 120.0;
  const std::vector<std::vector<Event>> logs{
      sim::record(sim::find_scenario("kart"), {.duration_s = drive_s}).events};
  for (auto run : state) benchmark::DoNotOptimize(calibration::drive::calibrate_drive(logs, {}));
  state.counters["per_minute_of_log"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * drive_s / 60.0,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(replay_hour)->ArgName("truth")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(replay_hour_reading_alone)->ArgName("truth")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(replay_hour_engine_alone)->ArgName("truth")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(smooth_hour)->Unit(benchmark::kMillisecond);
BENCHMARK(calibrate_two_minutes)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
