// Latency of the chain bridge → fusion → consumer, next to a bare Cyclone DDS chain with the same payloads.
// Rounds of both are interleaved, so that a neighbour's load falls on both; what counts is the ratio.

#include "bare_chain.hpp"
#include <sonopose/dds/topics.hpp>
#include <sonopose/nodes/beacon_view.hpp>
#include <sonopose/nodes/host_clock.hpp>
#include <sonopose/nodes/stop_signal.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <stdexcept>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace {

using namespace sonopose;

struct Options {
  std::uint32_t domain = 143;
  std::vector<double> rates_hz{100.0, 1000.0};
  int rounds = 10;
  double round_s = 3.0;
};

/// A child process, killed and reaped at the end.
class Child {
public:
  template <class Body>
  static Child fork_to(const Body& body) {
    const pid_t pid = ::fork();
    if (pid < 0) throw std::runtime_error("fork failed");
    if (pid == 0) {
      body();
      ::_exit(1);
    }
    return Child(pid);
  }
  static Child execute(const std::vector<std::string>& command) {
    return fork_to([&command] {
      std::vector<char*> arguments;
      for (const auto& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
      arguments.push_back(nullptr);
      std::freopen("/dev/null", "w", stderr);
      ::execv(arguments.front(), arguments.data());
    });
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  Child(Child&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}
  Child& operator=(Child&&) = delete;
  ~Child() {
    if (pid_ < 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }

private:
  explicit Child(pid_t pid) : pid_(pid) {}
  pid_t pid_;
};

/// The consumer at the chain's end: latency of each pose since its IMU sample was published.
class Consumer final : public dds::DataReaderListener<sonopose_FusedPose> {
public:
  void on_data_available(dds::DataReader<sonopose_FusedPose>& reader) noexcept override {
    const TimeNs received_ns = nodes::now_ns();
    const std::lock_guard lock(mutex_);
    reader.try_take_each([&](const sonopose_FusedPose& pose, const dds::SampleInfo&) {
      latencies_s_.push_back(seconds_between(pose.imu_bridge_time, received_ns));
    });
  }
  std::vector<double> taken() {
    const std::lock_guard lock(mutex_);
    return std::exchange(latencies_s_, {});
  }

private:
  std::mutex mutex_;
  std::vector<double> latencies_s_;
};

/// One chain's round: waits until poses come, lets it run warm, then measures.
nodes::Percentiles measure(const Options& options, const nodes::StopSignal& stop) {
  Consumer consumer;
  const dds::DomainParticipant participant({options.domain, dds::Network::loopback});
  const dds::QosProvider qos;
  const auto reader = dds::make_reader(participant, qos, dds::topics::pose, &consumer);
  constexpr TimeNs patience_ns = 10'000'000'000;
  const TimeNs give_up_ns = nodes::steady_now_ns() + patience_ns;
  while (consumer.taken().empty() && nodes::steady_now_ns() < give_up_ns) {
    stop.wait_until(nodes::steady_now_ns() + 20'000'000);
  }
  stop.wait_until(nodes::steady_now_ns() + 500'000'000);
  consumer.taken();
  stop.wait_until(nodes::steady_now_ns() + to_ns(options.round_s));
  const auto latencies_s = consumer.taken();
  if (latencies_s.empty()) throw std::runtime_error("no pose came through the chain");
  return nodes::percentiles_of(latencies_s);
}

// Children are forked before this process has any thread, and each round has new ones.
nodes::Percentiles bare_round(const Options& options, double rate_hz, const nodes::StopSignal& stop) {
  const auto relay = Child::fork_to([&] { benchmarks::run_bare_relay(options.domain); });
  const auto source = Child::fork_to([&] { benchmarks::run_bare_source(options.domain, rate_hz); });
  return measure(options, stop);
}

nodes::Percentiles our_round(const Options& options, double rate_hz, const nodes::StopSignal& stop) {
  const std::string domain = std::to_string(options.domain);
  const auto fusion = Child::execute({SONOPOSE_FUSION, "--domain", domain});
  const auto bridge =
      Child::execute({SONOPOSE_BRIDGE, "--domain", domain, "--imu-rate", fmt::format("{}", rate_hz)});
  return measure(options, stop);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// One row: medians over the rounds, and the median of the rounds' own ratios with their spread.
void print_row(const char* name, const std::vector<double>& bare_s, const std::vector<double>& ours_s) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < bare_s.size(); ++i) ratios.push_back(ours_s[i] / bare_s[i]);
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  fmt::print("  {:<5} bare {:>7.0f} us   sonopose {:>7.0f} us   ratio {:.2f} ({:.2f} .. {:.2f})\n", name,
             median(bare_s) * 1e6, median(ours_s) * 1e6, median(ratios), *least, *most);
}

void compare(const Options& options, double rate_hz, const nodes::StopSignal& stop) {
  std::vector<double> bare_p50_s;
  std::vector<double> bare_p99_s;
  std::vector<double> ours_p50_s;
  std::vector<double> ours_p99_s;
  for (int round = 0; round < options.rounds && !stop.requested(); ++round) {
    const auto bare = bare_round(options, rate_hz, stop);
    const auto ours = our_round(options, rate_hz, stop);
    bare_p50_s.push_back(bare.p50_s);
    bare_p99_s.push_back(bare.p99_s);
    ours_p50_s.push_back(ours.p50_s);
    ours_p99_s.push_back(ours.p99_s);
  }
  if (bare_p50_s.empty()) return;
  fmt::print("{:.0f} Hz, {} interleaved rounds of {} s\n", rate_hz, bare_p50_s.size(), options.round_s);
  print_row("p50", bare_p50_s, ours_p50_s);
  print_row("p99", bare_p99_s, ours_p99_s);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Latency of bridge, fusion and consumer next to a bare Cyclone DDS chain.",
               "benchmark_latency");
  app.add_option("--domain", options.domain, "DDS domain")->capture_default_str();
  app.add_option("--rates", options.rates_hz, "IMU rates in Hz")->capture_default_str();
  app.add_option("--rounds", options.rounds, "Rounds of each chain")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--round-seconds", options.round_s, "Length of a round")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    nodes::StopSignal stop;
    stop.listen_to_signals();
    for (const double rate_hz : options.rates_hz) compare(options, rate_hz, stop);
  } catch (const std::exception& error) {
    fmt::print(stderr, "benchmark_latency: {}\n", error.what());
    return 1;
  }
  return 0;
}
