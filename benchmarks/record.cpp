// Compares the recorder with a consumer that only counts the same topics: missing messages, and processor
// time with many beacons.

#include "clocks/clocks.hpp"
#include "counting_consumer.hpp"
#include "counting_reader.hpp"
#include "mcap/reader.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <compare>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <vector>

namespace {

using namespace sonopose;
using namespace sonopose::benchmarks;
namespace dds = sonopose::dds;
namespace topics = dds::topics;
namespace fs = std::filesystem;

constexpr double settle_s = 8;

/// Topics with an increasing number after the address: that of the event, or the time.
constexpr std::array<const char*, 4> counted_topics{"sonopose/imu", "sonopose/fix", "sonopose/heading",
                                                    "sonopose/truth"};

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

std::uint32_t index_of(const std::string& topic) {
  return static_cast<std::uint32_t>(std::find(counted_topics.begin(), counted_topics.end(), topic) -
                                    counted_topics.begin());
}

/// Counts samples until the process is killed.
void count_samples(std::uint32_t domain, SeenTable& seen) {
  const dds::qos::Provider qos;
  const auto participant = dds::ext::participant({domain, dds::Network::loopback});
  const auto on = [&seen](const auto& entry) {
    return [&seen, topic = index_of(entry.name)](const auto& sample) {
      if (seen.is_counting) seen.on({topic, sample.address, number_of(sample)});
    };
  };
  const CountingReader imu(participant, qos, topics::imu, on(topics::imu));
  const CountingReader fix(participant, qos, topics::fix, on(topics::fix));
  const CountingReader heading(participant, qos, topics::heading, on(topics::heading));
  const CountingReader truth(participant, qos, topics::truth, on(topics::truth));
  while (true) ::pause();
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

void measure(const ManyBeacons& options, double duration_s) {
  const fs::path file = fs::temp_directory_path() / fmt::format("benchmark_record_{}.mcap", ::getpid());
  auto& seen = shared_zeros<SeenTable>();
  const Child recorder =
      Child::execute({SONOPOSE_RECORD, file.string(), "--domain", std::to_string(options.domain),
                      "--duration", fmt::format("{}", settle_s + duration_s + 6.0)});
  double recorder_s = 0;
  double counter_s = 0;
  double length_s = 0;
  {
    const Child counter = Child::fork_to([&] { count_samples(options.domain, seen); });
    sleep_s(1.0);
    // The bridge ends by itself, so that both get the last message of each stream.
    const Child bridge = start_bridge(options, {"--duration", fmt::format("{}", settle_s + duration_s)});
    sleep_s(settle_s);
    seen.is_counting = true;
    const std::int64_t recorder_before_ns = recorder.cpu_time_ns();
    const std::int64_t counter_before_ns = counter.cpu_time_ns();
    const SteadyTime began = clocks::steady_now();
    sleep_s(duration_s - 2.0);
    recorder_s = seconds_between(recorder_before_ns, recorder.cpu_time_ns());
    counter_s = seconds_between(counter_before_ns, counter.cpu_time_ns());
    length_s = seconds_between(began, clocks::steady_now());
    wait_for_file(file, 30.0);
  }
  const Comparison compared = compare(seen, file);
  const double megabytes = static_cast<double>(fs::file_size(file)) * 1e-6;
  fs::remove(file);
  fmt::print("{} beacons at {} Hz for {} s\n", options.beacons, options.imu_rate_hz, duration_s);
  fmt::print("messages counted {}, missing in the file {}, {:.0f} MB\n", compared.counted, compared.missing,
             megabytes);
  fmt::print("recorder CPU {:.1f} %, counting consumer CPU {:.1f} %, ratio {:.2f}\n",
             100.0 * recorder_s / length_s, 100.0 * counter_s / length_s, recorder_s / counter_s);
}

}  // namespace

int main(int argc, char** argv) {
  ManyBeacons options;
  options.beacons = 250;
  double duration_s = 60;
  CLI::App app("The recorder, next to a consumer that only counts.", "benchmark_record");
  add_options(app, options);
  app.add_option("--seconds", duration_s, "Length")->check(CLI::Range(5.0, 3600.0))->capture_default_str();
  return run_main(app, argc, argv, [&] { measure(options, duration_s); });
}
