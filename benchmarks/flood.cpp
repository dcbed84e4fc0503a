// Longest gap between the poses of a beacon while a stranger publishes samples of forged addresses, or on
// many topics of its own. Cases are interleaved, each with a new bridge and a new fusion.

#include "child.hpp"
#include "clocks/clocks.hpp"
#include "statistics.hpp"
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace sonopose;
using namespace sonopose::benchmarks;
namespace dds = sonopose::dds;
namespace topics = dds::topics;

constexpr BeaconAddress healthy = 7;

/// Cases: nothing, samples of one stream or both streams of forged addresses, one sample of each address,
/// and topics of the stranger's own.
enum class Flood : std::uint8_t { none, imu, fixes, both, once, topics };
const std::vector<std::string> names{"none", "imu", "fixes", "both", "once", "topics"};

struct Options {
  std::vector<std::string> floods = names;
  std::uint32_t domain = 143;
  std::uint32_t addresses = 500;
  std::uint32_t topics = 3000;
  double forged_rate_hz = 10;
  double round_s = 8;
  int rounds = 3;
};

/// Publishes samples of all forged addresses, until it is killed.
[[noreturn]] void forge_addresses(const dds::domain::DomainParticipant& participant, const Options& options,
                                  Flood flood) {
  const dds::qos::Provider qos;
  auto imu_writer = topics::make_writer(participant, qos, topics::imu);
  auto fix_writer = topics::make_writer(participant, qos, topics::fix);
  sleep_s(1);
  for (std::uint64_t sequence = 1;; ++sequence) {
    for (std::uint32_t i = 1; i <= options.addresses; ++i) {
      ImuSample imu;
      imu.address = static_cast<BeaconAddress>(healthy + i);
      imu.sequence = flood == Flood::both ? 2 * sequence : sequence;
      imu.sensor_time_ns = imu.bridge_time_ns = clocks::host_now();
      imu.specific_force_body_mps2 = {0, 0, 9.81};
      if (flood != Flood::fixes) dds::ext::try_write(imu_writer, dds::topics::to_idl(imu));
      UltrasonicFix fix;
      fix.address = imu.address;
      fix.sequence = flood == Flood::both ? 2 * sequence + 1 : sequence;
      fix.emission_time_ns = fix.received_time_ns = imu.sensor_time_ns;
      fix.position_world_m = {static_cast<double>(sequence % 7), 1, 1};
      if (flood != Flood::imu) dds::ext::try_write(fix_writer, dds::topics::to_idl(fix));
    }
    sleep_s(flood == Flood::once ? 1000 : 1 / options.forged_rate_hz);
  }
}

/// Creates topics with a writer each, and keeps them until it is killed.
[[noreturn]] void create_topics(const dds::domain::DomainParticipant& participant, const Options& options) {
  sleep_s(1);
  for (std::uint32_t i = 0; i < options.topics; ++i) {
    const std::string name = fmt::format("stranger/{}", i);
    const auto topic = dds_create_topic(dds::ext::handle(participant), &sonopose_ImuSample_desc, name.c_str(),
                                        nullptr, nullptr);
    if (topic < 0 || dds_create_writer(dds::ext::handle(participant), topic, nullptr, nullptr) < 0) break;
  }
  while (true) sleep_s(1);
}

void forge(const Options& options, Flood flood) {
  const auto participant = dds::ext::participant({options.domain, dds::Network::loopback});
  if (flood == Flood::topics) create_topics(participant, options);
  forge_addresses(participant, options, flood);
}

/// Poses of the healthy beacon.
class Poses final : public dds::sub::NoOpDataReaderListener<sonopose_FusedPose> {
public:
  void on_data_available(dds::sub::DataReader<sonopose_FusedPose>& reader) noexcept override {
    const SteadyTime now = clocks::steady_now();
    dds::ext::try_take_each(reader, [&](const sonopose_FusedPose& pose, const dds::sub::SampleInfo&) {
      if (pose.address != healthy) return;
      const TimeNs gap_ns = now - std::exchange(latest_, now);
      if (count_++ > 0) longest_ns_ = std::max(longest_ns_.load(), gap_ns);
    });
  }

  [[nodiscard]] std::uint64_t count() const { return count_; }
  TimeNs take_longest_ns() { return longest_ns_.exchange(0); }

private:
  SteadyTime latest_;
  std::atomic<std::uint64_t> count_ = 0;
  std::atomic<TimeNs> longest_ns_ = 0;
};

/// Returns the longest gap in a round, s.
double measure(const Options& options, Flood flood) {
  const std::string domain = std::to_string(options.domain);
  const Child fusion = Child::execute({SONOPOSE_FUSION, "--domain", domain});
  const Child bridge =
      Child::execute({SONOPOSE_BRIDGE, "--domain", domain, "--address", std::to_string(healthy)});
  std::optional<Child> forger;
  if (flood != Flood::none) forger.emplace(Child::fork_to([&] { forge(options, flood); }));
  Poses poses;
  const auto participant = dds::ext::participant({options.domain, dds::Network::loopback});
  const auto reader = topics::make_reader(participant, dds::qos::Provider(), topics::pose, &poses);
  for (int tenths = 0; poses.count() < 20; ++tenths) {
    if (tenths == 200) throw std::runtime_error("no poses");
    sleep_s(0.1);
  }
  poses.take_longest_ns();
  sleep_s(options.round_s);
  return seconds_between(0, poses.take_longest_ns());
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Longest gap of a beacon's poses while a stranger floods the bus", "benchmark_flood");
  app.add_option("--domain", options.domain, "DDS domain")->capture_default_str();
  app.add_option("--floods", options.floods, "Cases")->check(CLI::IsMember(names))->capture_default_str();
  app.add_option("--addresses", options.addresses, "Forged addresses")->capture_default_str();
  app.add_option("--forged-rate", options.forged_rate_hz, "Samples of each, Hz")->capture_default_str();
  app.add_option("--topics", options.topics, "Topics of the stranger")->capture_default_str();
  app.add_option("--rounds", options.rounds, "Rounds of each case")->capture_default_str();
  app.add_option("--round-seconds", options.round_s, "Length of a round")->capture_default_str();
  return run_main(app, argc, argv, [&] {
    std::map<std::size_t, std::vector<double>> gaps_s;
    for (int round = 0; round < options.rounds; ++round) {
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (std::ranges::count(options.floods, names.at(i)) == 0) continue;
        gaps_s[i].push_back(measure(options, static_cast<Flood>(i)));
      }
    }
    fmt::print("{:<8} {:>12} {:>12}\n", "flood", "median ms", "longest ms");
    for (const auto& [flood, all] : gaps_s) {
      fmt::print("{:<8} {:>12.0f} {:>12.0f}\n", names.at(flood), 1e3 * median(all),
                 1e3 * *std::max_element(all.begin(), all.end()));
    }
  });
}
