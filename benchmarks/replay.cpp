// Replay of an hour of 100 Hz data: reading the folder, and running the engine.

#include "evaluation/run.hpp"
#include "recording/log_folder.hpp"
#include "recording/log_writer.hpp"
#include "sim/simulator.hpp"

#include <benchmark/benchmark.h>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

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
  HourOfWalking(HourOfWalking&&) = delete;
  HourOfWalking& operator=(HourOfWalking&&) = delete;

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

BENCHMARK(replay_hour)->ArgName("truth")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(replay_hour_reading_alone)->ArgName("truth")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(replay_hour_engine_alone)->ArgName("truth")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
