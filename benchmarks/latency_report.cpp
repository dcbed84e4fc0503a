#include "latency_report.hpp"

#include "statistics.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace sonopose::benchmarks {
namespace {

template <class Part>
double quantile_us(const std::vector<const Round*>& rounds, double share, const Part& part) {
  std::vector<double> values_s;
  for (const Round* round : rounds) {
    for (const Latency& latency : round->latencies) values_s.push_back(part(latency));
  }
  return 1e6 * statistics::quantile(std::move(values_s), share);
}

double all_s(const Latency& latency) {
  return latency.all_s();
}

double p50_us(const Round& round) {
  return quantile_us({&round}, 0.5, all_s);
}
double p99_us(const Round& round) {
  return quantile_us({&round}, 0.99, all_s);
}
double relay_cpu_us(const Round& round) {
  return 1e6 * round.relay_cpu_s;
}

void print_chain(const ChainResult& result) {
  std::vector<const Round*> rounds;
  std::vector<double> cpu_us;
  for (const Round& round : result.rounds) {
    rounds.push_back(&round);
    cpu_us.push_back(relay_cpu_us(round));
  }
  fmt::print("  {:<16} {:>6.0f} {:>6.0f} {:>6.0f} {:>10.1f} {:>11.0f} {:>6.1f} {:>6.0f}\n", result.name,
             quantile_us(rounds, 0.5, all_s), quantile_us(rounds, 0.99, all_s),
             quantile_us(rounds, 0.999, all_s), median(cpu_us),
             quantile_us(rounds, 0.5, [](const Latency& latency) { return latency.to_relay_s; }),
             quantile_us(rounds, 0.5, [](const Latency& latency) { return latency.in_relay_s; }),
             quantile_us(rounds, 0.5, [](const Latency& latency) { return latency.to_consumer_s; }));
}

std::vector<double> ratios(const ChainResult& over, const ChainResult& under, double (*value)(const Round&)) {
  std::vector<double> found;
  for (std::size_t i = 0; i < over.rounds.size(); ++i) {
    found.push_back(value(over.rounds[i]) / value(under.rounds[i]));
  }
  return found;
}

void print_ratios(const ChainResult& over, const ChainResult& under) {
  fmt::print("  {:<28}", over.name + "/" + under.name);
  for (auto* value : {p50_us, p99_us, relay_cpu_us}) {
    const auto found = ratios(over, under, value);
    const MedianInterval interval = median_interval(found);
    fmt::print("  {:.2f} ({:.2f} .. {:.2f})", median(found), interval.lower, interval.upper);
  }
  fmt::print("\n");
}

/// Limits of a chain relative to the bare one.
struct Limits {
  double p50 = 0;
  double p99 = 0;
  double relay_cpu = 0;
};

void print_limit(const ChainResult& ours, const char* what, double limit, const std::vector<double>& found) {
  constexpr std::size_t min_rounds = 10;
  fmt::print("  limit {:.2f}, {} {}/bare: ", limit, what, ours.name);
  if (found.size() < min_rounds) {
    fmt::print("not evaluated, {} of the required {} rounds\n", found.size(), min_rounds);
  } else {
    fmt::print("{}\n", median(found) <= limit ? "met" : "missed");
  }
}

void print_limits(const ChainResult& ours, const ChainResult& bare, const Limits& limits) {
  print_limit(ours, "p50", limits.p50, ratios(ours, bare, p50_us));
  print_limit(ours, "p99", limits.p99, ratios(ours, bare, p99_us));
  print_limit(ours, "relay CPU", limits.relay_cpu, ratios(ours, bare, relay_cpu_us));
}

}  // namespace

void print_report(double rate_hz, double round_s, const Results& results, bool is_secured) {
  const ChainResult& bare = results.at(1);
  const ChainResult& documented = results.at(3);
  const ChainResult& kalman = results.at(4);
  fmt::print("{:.0f} Hz, {} interleaved rounds of {} s; us\n", rate_hz, bare.rounds.size(), round_s);
  fmt::print("  chain               p50    p99  p99.9  relay CPU  p50: to relay, in relay, to consumer\n");
  for (const ChainResult& result : results) print_chain(result);
  fmt::print("  median ratio (interval of the median by order statistics, {:.0f} %)\n",
             100.0 * median_interval(std::vector<double>(bare.rounds.size())).confidence);
  fmt::print("                                p50                  p99                  relay CPU\n");
  print_ratios(bare, results.at(0));
  print_ratios(results.at(2), bare);  // shows the resolution of the machine
  print_ratios(documented, bare);
  print_ratios(kalman, bare);
  for (std::size_t i = 5; i < results.size(); ++i) {
    const bool is_documented = results[i].name == "other documented";
    print_ratios(results[i], is_documented ? documented : kalman);
  }
  if (is_secured) {
    for (const ChainResult* const chain : {&documented, &kalman}) {
      print_limit(*chain, "p50", 1.25, ratios(*chain, bare, p50_us));
    }
  } else {
    print_limits(documented, bare, {.p50 = 1.10, .p99 = 1.25, .relay_cpu = 1.5});
    print_limits(kalman, bare, {.p50 = 1.15, .p99 = 1.30, .relay_cpu = 1.9});
  }
  std::fflush(stdout);
}

}  // namespace sonopose::benchmarks
