// Compares the recorder with a consumer that only counts the same topics: missing messages, and processor
// time with many beacons.

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
#include <compare>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
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

/// Topics with an increasing number after the address: that of the event, or the time.
constexpr std::array<const char*, 6> counted_topics{"sonopose/imu",   "sonopose/fix",  "sonopose/heading",
                                                    "sonopose/truth", "sonopose/pose", "sonopose/report"};

/// A message that a consumer received, or a file contains.
struct Seen {
  std::uint32_t topic = 0;  ///< index in `counted_topics`
  std::uint32_t address = 0;
  std::uint64_t number = 0;

  auto operator<=>(const Seen&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14
};

/// A table that the processes share. Only its used part takes memory.
struct SeenTable {
  static constexpr std::size_t capacity = std::size_t{1} << 26U;

  /// Set once all readers and writers have found each other: earlier messages reach only some of them.
  std::atomic<bool> is_counting;
  std::atomic<std::size_t> count;
  std::array<Seen, capacity> seen;

  void on(const Seen& message) {
    const std::size_t at = count.fetch_add(1, std::memory_order_relaxed);
    if (at < capacity) seen[at] = message;
  }
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
  Counter(SeenTable& seen, std::uint32_t topic) : seen_(seen), topic_(topic) {}
  void on_data_available(dds::DataReader<T>& reader) noexcept override {
    reader.try_take_each([this](const T& sample, const dds::SampleInfo&) {
      if (seen_.is_counting) seen_.on({topic_, sample.address, number_of(sample)});
    });
  }

private:
  SeenTable& seen_;
  std::uint32_t topic_;
};

std::uint32_t index_of(const std::string& topic) {
  return static_cast<std::uint32_t>(std::find(counted_topics.begin(), counted_topics.end(), topic) -
                                    counted_topics.begin());
}

template <class T>
struct CountingReader {
  CountingReader(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
                 const topics::Entry<T>& entry, SeenTable& seen)
      : listener(seen, index_of(entry.name)),
        reader(topics::make_reader(participant, qos, entry, &listener)) {}
  Counter<T> listener;
  dds::DataReader<T> reader;
};

/// Counts samples until the process is killed.
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
  void* const memory = ::mmap(nullptr, sizeof(SeenTable), PROT_READ | PROT_WRITE,
                              MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::runtime_error("mmap failed");
  return *static_cast<SeenTable*>(memory);  // all zero
}

void sleep_s(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

/// Returns the messages of the counted topics in a file, sorted.
std::vector<Seen> recorded_in(const fs::path& file) {
  const mcap::Reader reader(file);
  mcap::Messages messages(reader, {.channel = {}, .order = mcap::Selection::Order::file});
  std::vector<Seen> recorded;
  while (const auto message = messages.next()) {
    const std::uint32_t topic = index_of(reader.channels().at(message->channel_id).topic);
    const auto number = topics::event_sequence_of(message->data);
    const auto address = topics::beacon_of(message->data);
    if (topic < counted_topics.size() && number && address) recorded.push_back({topic, *address, *number});
  }
  std::sort(recorded.begin(), recorded.end());
  return recorded;
}

struct Comparison {
  std::uint64_t counted = 0;  ///< messages counted by the consumer
  std::uint64_t missing = 0;  ///< counted messages missing in the file
};

Comparison compare(const SeenTable& seen, const fs::path& file) {
  const std::vector<Seen> recorded = recorded_in(file);
  Comparison result{.counted = seen.count};
  if (result.counted > SeenTable::capacity) throw std::runtime_error("too many messages to compare");
  for (std::size_t i = 0; i < result.counted; ++i) {
    if (!std::binary_search(recorded.begin(), recorded.end(), seen.seen[i])) ++result.missing;
  }
  return result;
}

void wait_for_file(const fs::path& file, double max_s) {
  for (double waited_s = 0; !fs::exists(file); waited_s += 0.05) {
    if (waited_s > max_s) throw std::runtime_error(file.string() + ": the recorder did not complete it");
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
    // The bridge ends by itself, so that both get the last message of each stream.
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
