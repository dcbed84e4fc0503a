// Measures the latency of the chain bridge → fusion → consumer, next to a bare Cyclone DDS chain and to plain
// UDP sockets with the same payloads. Rounds of all chains are interleaved, so that other load affects all of
// them equally; the ratios are the result.

#include "chains.hpp"
#include "child.hpp"
#include "clocks/clocks.hpp"
#include "latency_report.hpp"
#include "process/stop_signal.hpp"
#include "security/key_store.hpp"
#include "support/temporary_folder.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdlib>
#include <optional>

namespace {

using namespace sonopose;
using namespace sonopose::benchmarks;

struct Options {
  std::uint32_t domain = 143;
  std::vector<double> rates_hz{100.0, 200.0, 500.0, 1000.0};
  std::vector<std::string> variants;
  std::string other_fusion;
  int rounds = 10;
  double round_s = 3.0;
  unsigned fusion_cpu = 1;
  std::string protection;  ///< kind of DDS Security; empty: none
};

std::vector<Chain> chains_of(const Options& options) {
  std::vector<Chain> chains{plain_chain(), bare_chain("bare"), bare_chain("bare again")};
  const std::vector<std::string> engines{"documented", "kalman"};
  for (const std::string& engine : engines) chains.push_back(real_chain(engine, {.engine = engine}));
  if (!options.other_fusion.empty()) {
    for (const std::string& engine : engines) {
      chains.push_back(real_chain("other " + engine, {.engine = engine, .fusion = options.other_fusion}));
    }
  }
  for (const std::string& variant : options.variants) {
    Tuning tuning;
    tuning.realtime = variant == "realtime";
    tuning.awake = variant == "awake";
    tuning.ros2 = variant == "ros2";
    if (variant == "pinned") tuning.fusion_cpu = options.fusion_cpu;
    chains.push_back(real_chain(variant, tuning));
  }
  return chains;
}

/// Runs the rounds. Each starts with a different chain.
Results rounds_of(const Options& options, double rate_hz, const process::StopSignal& stop) {
  const std::vector<Chain> chains = chains_of(options);
  Results results;
  for (const Chain& chain : chains) results.push_back({chain.name, {}, {}});
  for (std::size_t round = 0; round < static_cast<std::size_t>(options.rounds); ++round) {
    for (std::size_t i = 0; i < chains.size(); ++i) {
      if (stop.requested()) return results;
      const std::size_t at = (round + i) % chains.size();
      results[at].pending = chains[at].run({options.domain, rate_hz, options.round_s});
    }
    for (ChainResult& result : results) result.rounds.push_back(std::move(result.pending));
  }
  return results;
}

/// A key store that all processes of the chains on DDS find by the environment.
class Secured {
public:
  explicit Secured(const std::string& protection) {
    const std::int64_t now_s = clocks::host_now() / 1'000'000'000;
    const auto kind = protection == "encrypt" ? security::Protection::encrypt : security::Protection::sign;
    const auto store = security::KeyStore::create(folder_ / "keys", kind, now_s);
    const security::Validity validity{now_s - security::day_s, now_s + security::day_s};
    for (const char* const role : {"bridge", "fusion", "consumer"}) {
      store.add(role, {.roles = {role}, .validity = validity});
    }
    ::setenv("ROS_SECURITY_KEYSTORE", store.folder().c_str(), 1);
    ::setenv("ROS_SECURITY_ENABLE", "true", 1);
    ::setenv("ROS_SECURITY_STRATEGY", "Enforce", 1);
  }

private:
  test::TemporaryFolder folder_;
};

void add_options(CLI::App& app, Options& options) {
  app.add_option("--domain", options.domain, "DDS domain")->capture_default_str();
  app.add_option("--rates", options.rates_hz, "IMU rates in Hz")->capture_default_str();
  app.add_option("--rounds", options.rounds, "Rounds of each chain; the limits are evaluated from 10 on")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--round-seconds", options.round_s, "Length of a round")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option(
         "--variants", options.variants,
         "Variants of the chain with the Kalman engine, compared with it: realtime (with --realtime), awake "
         "(cores never sleep), pinned (the fusion on a reserved core), ros2 (through sonopose-ros2)")
      ->check(CLI::IsMember({"realtime", "awake", "pinned", "ros2"}));
  app.add_option("--other-fusion", options.other_fusion,
                 "Another build of sonopose-fusion, with both engines, compared with this one")
      ->check(CLI::ExistingFile);
  app.add_option("--secured", options.protection, "Secure all chains but udp by DDS Security")
      ->check(CLI::IsMember({"sign", "encrypt"}));
  app.add_option("--fusion-cpu", options.fusion_cpu, "Core for the variant pinned")->capture_default_str();
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Latency of bridge, fusion and consumer next to a bare Cyclone DDS chain and plain UDP sockets.",
      "benchmark_latency");
  add_options(app, options);
  return run_main(app, argc, argv, [&] {
    std::optional<Secured> secured;
    if (!options.protection.empty()) secured.emplace(options.protection);
    process::StopSignal stop;
    stop.listen_to_signals();
    for (const double rate_hz : options.rates_hz) {
      const Results results = rounds_of(options, rate_hz, stop);
      if (!results.front().rounds.empty())
        print_report(rate_hz, options.round_s, results, secured.has_value());
      if (stop.requested()) break;
    }
  });
}
