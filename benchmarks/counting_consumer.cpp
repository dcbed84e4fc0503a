#include "counting_consumer.hpp"

#include "clocks/clocks.hpp"
#include "counting_reader.hpp"
#include "statistics.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <unistd.h>

namespace sonopose::benchmarks {
namespace {

/// Counts the samples of the topics that the monitor and the page read, until the process is killed.
[[noreturn]] void count_samples(std::uint32_t domain, std::atomic<std::uint64_t>& count) {
  namespace topics = dds::topics;
  const dds::qos::Provider qos;
  const auto participant = dds::ext::participant({domain, dds::Network::loopback});
  const auto on = [&count](const auto&) { count.fetch_add(1, std::memory_order_relaxed); };
  const CountingReader pose(participant, qos, topics::pose, on);
  const CountingReader truth(participant, qos, topics::truth, on);
  const CountingReader report(participant, qos, topics::report, on);
  const CountingReader beacon_status(participant, qos, topics::beacon_status, on);
  const CountingReader estimate(participant, qos, topics::estimate, on);
  const CountingReader fusion_status(participant, qos, topics::fusion_status, on);
  const CountingReader line_status(participant, qos, topics::line_status, on);
  const CountingReader log(participant, qos, topics::log, on);
  while (true) ::pause();
}

}  // namespace

void add_options(CLI::App& app, ManyBeacons& options) {
  app.add_option("--domain", options.domain, "DDS domain")->capture_default_str();
  app.add_option("--beacons", options.beacons, "Number of beacons")
      ->check(CLI::Range(1U, 1000U))
      ->capture_default_str();
  app.add_option("--imu-rate", options.imu_rate_hz, "Rate of each beacon's IMU, Hz")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

Child start_bridge(const ManyBeacons& options, const std::vector<std::string>& more) {
  std::vector<std::string> command{SONOPOSE_BRIDGE, "--domain", std::to_string(options.domain)};
  command.insert(command.end(), {"--beacons", std::to_string(options.beacons)});
  command.insert(command.end(), {"--imu-rate", fmt::format("{}", options.imu_rate_hz)});
  command.insert(command.end(), more.begin(), more.end());
  return Child::execute(command);
}

void add_options(CLI::App& app, ComparisonOptions& options) {
  add_options(app, static_cast<ManyBeacons&>(options));
  app.add_option("--rounds", options.rounds, "Rounds")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--seconds", options.round_s, "Length of a round")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

CountedChain::CountedChain(const ComparisonOptions& options)
    : options_(options),
      count_(shared_zeros<std::atomic<std::uint64_t>>()),
      counter_(Child::fork_to([this] { count_samples(options_.domain, count_); })),
      fusion_(Child::execute({SONOPOSE_FUSION, "--domain", std::to_string(options.domain)})),
      bridge_(start_bridge(options)) {}

void CountedChain::compare(pid_t pid, const std::string& viewer,
                           const std::function<std::int64_t()>& bytes) const {
  sleep_s(8.0);  // lets every beacon be found and its fusion settle
  fmt::print("{} beacons at {} Hz, rounds of {} s, {}\n", options_.beacons, options_.imu_rate_hz,
             options_.round_s, viewer);
  fmt::print("round  samples/s  CPU  counting consumer CPU  ratio  kB/s\n");
  std::vector<double> ratios;
  for (int round = 1; round <= options_.rounds; ++round) {
    const std::int64_t cpu_before_ns = cpu_time_ns(pid);
    const std::int64_t counter_before_ns = counter_.cpu_time_ns();
    const std::int64_t bytes_before = bytes();
    const std::uint64_t count_before = count_;
    const SteadyTime began = clocks::steady_now();
    sleep_s(options_.round_s);
    const double cpu_s = seconds_between(cpu_before_ns, cpu_time_ns(pid));
    const double counter_s = seconds_between(counter_before_ns, counter_.cpu_time_ns());
    const double length_s = seconds_between(began, clocks::steady_now());
    ratios.push_back(cpu_s / counter_s);
    fmt::print("{:>5} {:>10.0f} {:>5.1f} % {:>18.1f} % {:>6.2f} {:>5.1f}\n", round,
               static_cast<double>(count_ - count_before) / length_s, 100.0 * cpu_s / length_s,
               100.0 * counter_s / length_s, ratios.back(),
               1e-3 * static_cast<double>(bytes() - bytes_before) / length_s);
    std::fflush(stdout);
  }
  fmt::print("median ratio {:.2f}\n", median(ratios));
}

}  // namespace sonopose::benchmarks
