// Compares the processor time of the monitor's screen with that of a consumer that only counts the same
// topics, with many beacons.

#include "counting_consumer.hpp"
#include "support/terminal_process.hpp"

using namespace sonopose;
using namespace sonopose::benchmarks;

int main(int argc, char** argv) {
  ComparisonOptions options;
  options.beacons = 250;
  options.imu_rate_hz = 25;
  options.rounds = 3;
  CLI::App app("The processor time of the monitor's screen, next to a consumer that only counts.",
               "benchmark_monitor");
  add_options(app, options);
  return run_main(app, argc, argv, [&] {
    const CountedChain chain(options);
    const test::TerminalProcess monitor(SONOPOSE_MONITOR, {"--domain", std::to_string(options.domain)}, 200,
                                        60);
    chain.compare(monitor.pid(), "a screen of 200 x 60",
                  [&] { return static_cast<std::int64_t>(monitor.output().size()); });
  });
}
