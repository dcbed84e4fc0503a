// Compares the processor time of the monitor's screen with that of a consumer that only counts the same
// topics, with many beacons.

#include "child.hpp"
#include "clocks/clocks.hpp"
#include "counting_consumer.hpp"
#include "statistics.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <poll.h>
#include <pty.h>
#include <stdexcept>
#include <string>
#include <sys/ioctl.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace {

using namespace sonopose;
using namespace sonopose::benchmarks;

struct Options {
  std::uint32_t domain = 0;
  std::uint32_t beacons = 250;
  double imu_rate_hz = 25;
  double round_s = 10;
  int rounds = 3;
  bool control = false;
};

/// A pseudo-terminal whose output is read and counted.
class WatchedTerminal {
public:
  WatchedTerminal() {
    const winsize size{60, 200, 0, 0};
    if (::openpty(&master_, &slave_, nullptr, nullptr, &size) != 0)
      throw std::runtime_error("openpty failed");
  }
  WatchedTerminal(const WatchedTerminal&) = delete;
  WatchedTerminal& operator=(const WatchedTerminal&) = delete;
  ~WatchedTerminal() {
    ending_ = true;
    if (watcher_.joinable()) watcher_.join();
    ::close(master_);
    ::close(slave_);
  }

  /// Makes it the terminal of the child that calls this.
  void become() const {
    ::setsid();
    ::ioctl(slave_, TIOCSCTTY, 0);
    ::dup2(slave_, STDIN_FILENO);
    ::dup2(slave_, STDOUT_FILENO);
    ::close(master_);
    ::setenv("TERM", "xterm-256color", 1);
  }

  void watch() {
    watcher_ = std::thread([this] {
      std::array<char, 65536> buffer{};
      while (!ending_) {
        pollfd waited{master_, POLLIN, 0};
        if (::poll(&waited, 1, 50) > 0)
          bytes_ += std::max<ssize_t>(::read(master_, buffer.data(), buffer.size()), 0);
      }
    });
  }

  [[nodiscard]] std::int64_t bytes() const { return bytes_; }

private:
  int master_ = -1;
  int slave_ = -1;
  std::atomic<std::int64_t> bytes_ = 0;
  std::atomic<bool> ending_ = false;
  std::thread watcher_;
};

void sleep_s(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

void measure(const Options& options) {
  const std::string domain = std::to_string(options.domain);
  std::atomic<std::uint64_t>& count = shared_counter();
  const Child counter = Child::fork_to([&] { count_samples(options.domain, count); });
  WatchedTerminal terminal;
  std::atomic<std::uint64_t>& control_count = shared_counter();
  const Child monitor =
      options.control
          ? Child::fork_to([&] { count_samples(options.domain, control_count); })
          : Child::execute({SONOPOSE_MONITOR, "--domain", domain}, [&terminal] { terminal.become(); });
  const Child fusion = Child::execute({SONOPOSE_FUSION, "--domain", domain});
  const Child bridge =
      Child::execute({SONOPOSE_BRIDGE, "--domain", domain, "--beacons", std::to_string(options.beacons),
                      "--imu-rate", fmt::format("{}", options.imu_rate_hz)});
  terminal.watch();
  sleep_s(8.0);  // lets every beacon be found and its fusion settle
  fmt::print("{} beacons at {} Hz, rounds of {} s, a screen of 200 x 60\n", options.beacons,
             options.imu_rate_hz, options.round_s);
  fmt::print("round  samples/s  monitor CPU  counting consumer CPU  ratio  screen kB/s\n");
  std::vector<double> ratios;
  for (int round = 1; round <= options.rounds; ++round) {
    const std::int64_t monitor_before_ns = monitor.cpu_time_ns();
    const std::int64_t counter_before_ns = counter.cpu_time_ns();
    const std::int64_t bytes_before = terminal.bytes();
    const std::uint64_t count_before = count;
    const SteadyTime began = clocks::steady_now();
    sleep_s(options.round_s);
    const double monitor_s = seconds_between(monitor_before_ns, monitor.cpu_time_ns());
    const double counter_s = seconds_between(counter_before_ns, counter.cpu_time_ns());
    const double length_s = seconds_between(began, clocks::steady_now());
    ratios.push_back(monitor_s / counter_s);
    fmt::print("{:>5} {:>10.0f} {:>10.1f} % {:>20.1f} % {:>6.2f} {:>12.1f}\n", round,
               static_cast<double>(count - count_before) / length_s, 100.0 * monitor_s / length_s,
               100.0 * counter_s / length_s, ratios.back(),
               1e-3 * static_cast<double>(terminal.bytes() - bytes_before) / length_s);
    std::fflush(stdout);
  }
  fmt::print("median ratio {:.2f}\n", median(ratios));
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("The processor time of the monitor's screen, next to a consumer that only counts.",
               "benchmark_monitor");
  app.add_option("--domain", options.domain, "DDS domain")->capture_default_str();
  app.add_option("--beacons", options.beacons, "Number of beacons")
      ->check(CLI::Range(1U, 1000U))
      ->capture_default_str();
  app.add_option("--imu-rate", options.imu_rate_hz, "Rate of each beacon's IMU, Hz")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--rounds", options.rounds, "Rounds")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--seconds", options.round_s, "Length of a round")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_flag(
      "--control", options.control,
      "A second consumer that only counts in place of the monitor: what the machine adds to a ratio");
  CLI11_PARSE(app, argc, argv);
  try {
    measure(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "benchmark_monitor: {}\n", error.what());
    return 1;
  }
  return 0;
}
