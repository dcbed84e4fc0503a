#include "player/player_node.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "mcap/reader.hpp"
#include "player/play_clock.hpp"
#include "player/republisher.hpp"
#include "recorder/instance_end.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

namespace sonopose::player {
namespace {

namespace topics = dds::topics;

/// With `rate` 0, nobody loses anything: writers wait for slow readers.
dds::DomainOptions domain_options(const PlayerOptions& options) {
  dds::DomainOptions domain = options.domain;
  domain.wait_for_readers = options.rate == 0.0;
  return domain;
}

/// The topics of the file that are played, and the reason for each other one in the log.
std::vector<std::string> playable_topics(const mcap::Reader& reader, const PlayerOptions& options) {
  std::set<std::string> wanted;
  for (const std::string& name : options.topics) {
    const auto* const topic = topics::find_topic(name);
    wanted.insert(topic == nullptr ? name : topic->name);
  }
  std::set<std::string> playable;
  for (const auto& [id, channel] : reader.channels()) {
    if (!wanted.empty() && !wanted.contains(channel.topic)) continue;
    const auto schema = reader.schemas().find(channel.schema_id);
    const std::string obstacle =
        obstacle_to(channel, schema == reader.schemas().end() ? nullptr : &schema->second);
    if (obstacle.empty()) {
      playable.insert(channel.topic);
    } else {
      logging::warning(fmt::format("{} is not played: {}", channel.topic, obstacle));
    }
  }
  for (const std::string& name : wanted) {
    if (!playable.contains(name))
      throw std::invalid_argument(fmt::format("{}: has no topic {}", reader.name(), name));
  }
  playable.erase(std::string(recorder::instance_ends_topic));
  if (playable.empty()) throw std::invalid_argument(reader.name() + ": has no topic that can be played");
  return {playable.begin(), playable.end()};
}

/// What is played, by the log time of the file.
mcap::Selection selection_of(const mcap::Reader& reader, const PlayerOptions& options,
                             const std::vector<std::string>& names) {
  const mcap::TimeSpan all = reader.statistics().log_times;
  if (all.is_empty()) throw std::invalid_argument(reader.name() + ": has no messages");
  const auto after_start = [&](double seconds) {
    return all.start_ns + static_cast<std::uint64_t>(seconds * 1e9);
  };
  mcap::Selection selection;
  selection.channel = [names](const mcap::Channel& channel) {
    return channel.topic == recorder::instance_ends_topic ||
           std::binary_search(names.begin(), names.end(), channel.topic);
  };
  selection.start_ns = after_start(options.start_s);
  if (options.end_s) selection.end_ns = after_start(*options.end_s);
  selection.damaged = mcap::Selection::Damaged::skip;
  if (selection.start_ns > all.end_ns || selection.start_ns > selection.end_ns) {
    throw std::invalid_argument(fmt::format("{}: has no messages from {} s{} on; its last one is at {:.3f} s",
                                            reader.name(), options.start_s,
                                            options.end_s ? fmt::format(" to {} s", *options.end_s) : "",
                                            static_cast<double>(all.end_ns - all.start_ns) * 1e-9));
  }
  return selection;
}

class Play {
public:
  Play(const mcap::Reader& reader, const PlayerOptions& options, PlayControl& control,
       const process::StopSignal& stop)
      : reader_(reader),
        options_(options),
        control_(control),
        stop_(stop),
        names_(playable_topics(reader, options)),
        selection_(selection_of(reader, options, names_)),
        clock_(options.rate),
        participant_(domain_options(options)),
        qos_(options.qos_file),
        publisher_(participant_, qos_, names_,
                   options.rate == 0.0 ? topics::Delivery::lossless : topics::Delivery::live) {}

  PlayerReport run();

private:
  void wait_for_readers();
  void play_once();
  bool wait_for(std::uint64_t log_time_ns);
  void obey_pause(std::uint64_t log_time_ns);
  void begin(std::uint64_t log_time_ns);

  const mcap::Reader& reader_;
  const PlayerOptions& options_;
  PlayControl& control_;
  const process::StopSignal& stop_;
  std::vector<std::string> names_;
  mcap::Selection selection_;
  PlayClock clock_;
  dds::DomainParticipant participant_;
  dds::qos::Provider qos_;
  Republisher publisher_;
  PlayerReport report_;
};

PlayerReport Play::run() {
  if (options_.wait_for_readers) wait_for_readers();
  const SteadyTime began = clocks::steady_now();
  do {
    play_once();
  } while (options_.loop && !stop_.requested());
  publisher_.wait_until_read(stop_);
  report_.duration_s = static_cast<double>(clocks::steady_now() - began) * 1e-9;
  return report_;
}

/// Until there is a reader, and no other one has come for a while.
void Play::wait_for_readers() {
  constexpr TimeNs settle_ns = 300'000'000;
  constexpr TimeNs poll_period_ns = 20'000'000;
  constexpr TimeNs report_after_ns = 3'000'000'000;
  const SteadyTime began = clocks::steady_now();
  SteadyTime changed = began;
  std::size_t count = 0;
  bool reported = false;
  while (count == 0 || clocks::steady_now() - changed < settle_ns) {
    if (stop_.wait_until(clocks::steady_now() + poll_period_ns)) return;
    const std::size_t now = publisher_.reader_count();
    if (std::exchange(count, now) != now) changed = clocks::steady_now();
    if (count == 0 && !reported && clocks::steady_now() - began > report_after_ns) {
      logging::warning("waiting for a reader (--no-wait plays without one)");
      reported = true;
    }
  }
}

void Play::play_once() {
  mcap::Messages messages(reader_, selection_);
  bool is_first = true;
  while (const auto message = messages.next()) {
    if (std::exchange(is_first, false)) begin(message->log_time_ns);
    if (!wait_for(message->log_time_ns)) return;
    const bool good = publisher_.publish(reader_.channels().at(message->channel_id).topic, *message, stop_);
    if (!good && stop_.requested()) return;  // it may have waited for a reader
    ++(good ? report_.played : report_.refused);
  }
  for (const std::string& damage : messages.skipped()) logging::warning("not played: " + damage);
  if (is_first)
    throw std::invalid_argument(reader_.name() + ": has no messages of these topics at these times");
}

void Play::begin(std::uint64_t log_time_ns) {
  clock_.begin(log_time_ns, clocks::steady_now());
  if (!options_.restamp) return;
  const auto recorded_ns = static_cast<TimeNs>(
      std::min<std::uint64_t>(log_time_ns, static_cast<std::uint64_t>(std::numeric_limits<TimeNs>::max())));
  publisher_.shift_times(saturated_difference(clocks::host_now(), recorded_ns));
}

/// Until the message is due, or the user steps to it. False if the stop came.
bool Play::wait_for(std::uint64_t log_time_ns) {
  constexpr TimeNs pause_look_ns = 1'000'000'000;
  while (!stop_.requested()) {
    obey_pause(log_time_ns);
    if (clock_.is_paused() && control_.take_step()) {
      clock_.step_to(log_time_ns);
      return true;
    }
    const auto due = clock_.due(log_time_ns);
    const SteadyTime now = clocks::steady_now();
    if (due && *due <= now) return true;
    stop_.wait_until(due.value_or(now + pause_look_ns), control_.wakeup());
  }
  return false;
}

void Play::obey_pause(std::uint64_t log_time_ns) {
  if (control_.take_pause_toggles() % 2 == 1) {
    if (clock_.is_paused()) {
      clock_.resume(clocks::steady_now());
    } else {
      clock_.pause(clocks::steady_now());
    }
    const auto passed_ns = log_time_ns - std::min(log_time_ns, reader_.statistics().log_times.start_ns);
    logging::info(fmt::format("{} at {:.3f} s", clock_.is_paused() ? "paused" : "playing",
                              static_cast<double>(passed_ns) * 1e-9));
  }
  if (!clock_.is_paused()) control_.forget_steps();
}

}  // namespace

PlayerReport play(const PlayerOptions& options, PlayControl& control, const process::StopSignal& stop) {
  const mcap::Reader reader(options.file);
  for (const std::string& damage : reader.damages()) logging::warning(damage);
  return Play(reader, options, control, stop).run();
}

}  // namespace sonopose::player
