// The recorder next to a consumer of the same topics that only counts: messages missing, and processor time
// with many beacons.

#include "child.hpp"
#include "clocks/clocks.hpp"
#include "mcap/reader.hpp"
#include "statistics.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <sys/mman.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace {

using namespace sonopose;
using namespace sonopose::benchmarks;
namespace topics = dds::topics;
namespace fs = std::filesystem;

struct Options {
  std::uint32_t domain = 0;
  std::uint32_t beacons = 250;
  double imu_rate_hz = 100;
  double seconds = 60;
  double settle_s = 8;
  bool with_fusion = false;
  std::string compression = "lz4";
  fs::path folder = fs::temp_directory_path();
};

/// The topics whose messages have an increasing number after the address: the event's, or the time.
constexpr std::array<const char*, 6> counted_topics{"sonopose/imu",   "sonopose/fix",  "sonopose/heading",
                                                    "sonopose/truth", "sonopose/pose", "sonopose/report"};
constexpr std::size_t most_beacons = 2048;

/// Which messages of a beacon and topic a consumer got.
struct Seen {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  std::uint64_t count = 0;

  void on(std::uint64_t number) {
    if (count == 0) first = number;
    last = number;
    ++count;
  }
};

/// Shared by the processes.
struct SeenTable {
  /// Set once all readers and writers have found each other: what is sent before reaches some earlier.
  std::atomic<bool> is_counting = false;
  std::array<std::array<Seen, most_beacons>, counted_topics.size()> topics{};
};

template <class T>
std::uint64_t number_of(const T& sample) {
  if constexpr (requires { sample.event_sequence; }) {
    return sample.event_sequence;
  } else {
    return static_cast<std::uint64_t>(sample.time);
  }
}

template <class T>
class Counter final : public dds::DataReaderListener<T> {
public:
  Counter(const std::atomic<bool>& is_counting, std::array<Seen, most_beacons>& seen)
      : is_counting_(is_counting), seen_(seen) {}
  void on_data_available(dds::DataReader<T>& reader) noexcept override {
    reader.try_take_each([this](const T& sample, const dds::SampleInfo&) {
      if (is_counting_) seen_[sample.address % most_beacons].on(number_of(sample));
    });
  }

private:
  const std::atomic<bool>& is_counting_;
  std::array<Seen, most_beacons>& seen_;
};

template <class T>
struct CountingReader {
  CountingReader(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
                 const topics::Entry<T>& entry, SeenTable& seen)
      : listener(seen.is_counting,
                 seen.topics.at(static_cast<std::size_t>(
                     std::find(counted_topics.begin(), counted_topics.end(), std::string(entry.name)) -
                     counted_topics.begin()))),
        reader(topics::make_reader(participant, qos, entry, &listener)) {}
  Counter<T> listener;
  dds::DataReader<T> reader;
};

/// Counts until it is killed.
void count_samples(std::uint32_t domain, SeenTable& seen) {
  const dds::qos::Provider qos;
  const dds::DomainParticipant participant({domain, dds::Network::loopback});
  const CountingReader imu(participant, qos, topics::imu, seen);
  const CountingReader fix(participant, qos, topics::fix, seen);
  const CountingReader heading(participant, qos, topics::heading, seen);
  const CountingReader truth(participant, qos, topics::truth, seen);
  const CountingReader pose(participant, qos, topics::pose, seen);
  const CountingReader report(participant, qos, topics::report, seen);
  while (true) ::pause();
}

SeenTable& shared_table() {
  void* const memory =
      ::mmap(nullptr, sizeof(SeenTable), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::runtime_error("mmap failed");
  return *new (memory) SeenTable{};
}

void sleep_s(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

/// Calls `on(topic, address, number)` for each message of a counted topic.
template <class On>
void for_each_recorded(const mcap::Reader& reader, const On& on) {
  mcap::Messages messages(reader, {.channel = {}, .order = mcap::Selection::Order::file});
  while (const auto message = messages.next()) {
    const std::string& topic = reader.channels().at(message->channel_id).topic;
    const auto* const found = std::find(counted_topics.begin(), counted_topics.end(), topic);
    if (found == counted_topics.end() || message->data.size() < 20) continue;
    std::uint64_t number = 0;
    std::memcpy(&number, message->data.data() + 12, sizeof number);
    on(static_cast<std::size_t>(found - counted_topics.begin()),
       *topics::beacon_of(message->data) % most_beacons, number);
  }
}

struct Comparison {
  std::uint64_t counted = 0;  ///< by the consumer, of the time that both have
  std::uint64_t missing = 0;  ///< of these in the file
};

Comparison compare(const SeenTable& seen, const fs::path& file) {
  const mcap::Reader reader(file);
  std::vector<std::uint64_t> recorded_last(counted_topics.size() * most_beacons);
  const auto at = [](std::size_t topic, std::size_t address) { return topic * most_beacons + address; };
  for_each_recorded(reader, [&](std::size_t topic, std::size_t address, std::uint64_t number) {
    recorded_last[at(topic, address)] = number;
  });
  std::vector<std::uint64_t> recorded(recorded_last.size());
  for_each_recorded(reader, [&](std::size_t topic, std::size_t address, std::uint64_t number) {
    const Seen& own = seen.topics.at(topic).at(address);
    if (number >= own.first && number <= own.last) ++recorded[at(topic, address)];
  });
  Comparison result;
  for (std::size_t topic = 0; topic < counted_topics.size(); ++topic) {
    for (std::size_t address = 0; address < most_beacons; ++address) {
      const Seen& own = seen.topics.at(topic).at(address);
      const std::uint64_t in_file = recorded[at(topic, address)];
      result.counted += own.count;
      if (own.count > in_file) result.missing += own.count - in_file;
    }
  }
  return result;
}

void wait_for_file(const fs::path& file, double most_s) {
  for (double waited_s = 0; !fs::exists(file); waited_s += 0.05) {
    if (waited_s > most_s) throw std::runtime_error(file.string() + ": the recorder did not complete it");
    sleep_s(0.05);
  }
}

void measure(const Options& options) {
  const std::string domain = std::to_string(options.domain);
  const fs::path file = options.folder / fmt::format("benchmark_record_{}.mcap", ::getpid());
  SeenTable& seen = shared_table();
  const Child recorder = Child::execute({SONOPOSE_RECORD, file.string(), "--domain", domain, "--compression",
                                         options.compression, "--duration",
                                         fmt::format("{}", options.settle_s + options.seconds + 6.0)});
  double recorder_s = 0;
  double counter_s = 0;
  double length_s = 0;
  {
    const Child counter = Child::fork_to([&] { count_samples(options.domain, seen); });
    sleep_s(1.0);
    std::vector<Child> others;
    if (options.with_fusion) others.push_back(Child::execute({SONOPOSE_FUSION, "--domain", domain}));
    // It ends by itself, so that both get the last message of each stream.
    others.push_back(
        Child::execute({SONOPOSE_BRIDGE, "--domain", domain, "--beacons", std::to_string(options.beacons),
                        "--imu-rate", fmt::format("{}", options.imu_rate_hz), "--duration",
                        fmt::format("{}", options.settle_s + options.seconds)}));
    sleep_s(options.settle_s);
    seen.is_counting = true;
    const std::int64_t recorder_before_ns = recorder.cpu_time_ns();
    const std::int64_t counter_before_ns = counter.cpu_time_ns();
    const SteadyTime began = clocks::steady_now();
    sleep_s(options.seconds - 2.0);
    recorder_s = seconds_between(recorder_before_ns, recorder.cpu_time_ns());
    counter_s = seconds_between(counter_before_ns, counter.cpu_time_ns());
    length_s = seconds_between(began, clocks::steady_now());
    wait_for_file(file, 30.0);
  }
  const Comparison compared = compare(seen, file);
  const double megabytes = static_cast<double>(fs::file_size(file)) * 1e-6;
  fs::remove(file);
  fmt::print("{} beacons at {} Hz for {} s{}, {}\n", options.beacons, options.imu_rate_hz, options.seconds,
             options.with_fusion ? " with a fusion" : "", options.compression);
  fmt::print("messages counted {}, missing in the file {}, {:.0f} MB\n", compared.counted, compared.missing,
             megabytes);
  fmt::print("recorder CPU {:.1f} %, counting consumer CPU {:.1f} %, ratio {:.2f}\n",
             100.0 * recorder_s / length_s, 100.0 * counter_s / length_s, recorder_s / counter_s);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("The recorder, next to a consumer that only counts.", "benchmark_record");
  app.add_option("--domain", options.domain, "DDS domain")->capture_default_str();
  app.add_option("--beacons", options.beacons, "Number of beacons")
      ->check(CLI::Range(1U, 1000U))
      ->capture_default_str();
  app.add_option("--imu-rate", options.imu_rate_hz, "Rate of each beacon's IMU, Hz")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seconds", options.seconds, "Length")
      ->check(CLI::Range(5.0, 3600.0))
      ->capture_default_str();
  app.add_flag("--fusion", options.with_fusion, "With a fusion, whose poses are recorded too");
  app.add_option("--compression", options.compression, "none, lz4 or zstd")->capture_default_str();
  app.add_option("--folder", options.folder, "For the file, which is removed")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    measure(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "benchmark_record: {}\n", error.what());
    return 1;
  }
  return 0;
}
