#include "player/player_node.hpp"

#include "bus_log/instance_end.hpp"
#include "bus_log/latched_start.hpp"
#include "bus_log/log_times.hpp"
#include "bus_log/moment.hpp"
#include "bus_log/recording_files.hpp"
#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "mcap/chunk_messages.hpp"
#include "mcap/reader.hpp"
#include "player/gaps.hpp"
#include "player/play_clock.hpp"
#include "player/republisher.hpp"
#include "publication/lossy_fusions.hpp"
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

namespace sonopose::player {
namespace {

namespace topics = dds::topics;

/// Options of the domain. With `rate` 0, nothing is lost: writers wait for slow readers.
dds::DomainOptions domain_options(const PlayerOptions& options) {
  dds::DomainOptions domain = options.domain;
  domain.wait_for_readers = options.rate == 0.0;
  return domain;
}

/// Playable part of a file: the topics that get a writer, and the channels, including the ends of instances.
struct Playable {
  std::set<std::string> topics;
  std::set<std::uint16_t> channel_ids;
  std::uint64_t refused = 0;  ///< messages of this program's topics in the other channels
};

/// Selects the playable channels. Logs the reason for each other one.
Playable playable_of(const mcap::Reader& reader, const PlayerOptions& options) {
  std::set<std::string> wanted;
  for (const std::string& name : options.topics) {
    const auto* const topic = topics::find_topic(name);
    wanted.insert(topic == nullptr ? name : topic->name);
  }
  Playable playable;
  for (const auto& [id, channel] : reader.channels()) {
    const bool is_ends = channel.topic == bus_log::instance_ends_topic;
    if (!wanted.empty() && !wanted.contains(channel.topic) && !is_ends) continue;
    const auto schema = reader.schemas().find(channel.schema_id);
    const std::string obstacle =
        obstacle_to(channel, schema == reader.schemas().end() ? nullptr : &schema->second);
    if (obstacle.empty()) {
      playable.channel_ids.insert(id);
      if (!is_ends) playable.topics.insert(channel.topic);
    } else {
      logging::warning(text::escaped(fmt::format("{} is not played: {}", channel.topic, obstacle)));
      const auto* const topic = topics::find_topic(channel.topic);
      const auto& counts = reader.statistics().channel_message_counts;
      const auto count = counts.find(id);
      if (topic != nullptr && channel.topic == topic->name && count != counts.end())
        playable.refused += count->second;
    }
  }
  for (const std::string& name : wanted) {
    if (!playable.topics.contains(name))
      throw std::invalid_argument(fmt::format("{}: has no topic {}", reader.name(), name));
  }
  if (playable.topics.empty()) {
    throw std::invalid_argument(reader.name() + ": has no topic that can be played");
  }
  return playable;
}

/// Selects the messages to play by their log time.
mcap::Selection selection_of(const mcap::Reader& reader, const PlayerOptions& options,
                             const std::set<std::uint16_t>& channel_ids) {
  const mcap::TimeSpan all = reader.statistics().log_times;
  if (all.is_empty()) throw std::invalid_argument(reader.name() + ": has no messages");
  mcap::Selection selection;
  selection.channel = [channel_ids](const mcap::Channel& channel) {
    return channel_ids.contains(channel.id);
  };
  const mcap::TimeSpan part = bus_log::part_of(all, options.start, options.end);
  selection.start_ns = part.start_ns;
  selection.end_ns = part.end_ns;
  selection.damaged = mcap::Selection::Damaged::skip;
  if (part.start_ns > all.end_ns || part.end_ns < all.start_ns) {
    throw std::invalid_argument(fmt::format("{}: has no messages from {} {}; its last one is at {:.3f} s",
                                            reader.name(), bus_log::text_of(options.start.value_or(0.0)),
                                            options.end ? "to " + bus_log::text_of(*options.end) : "on",
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
        playable_(playable_of(reader, options)),
        selection_(selection_of(reader, options, playable_.channel_ids)),
        clock_(options.rate),
        gaps_(options.max_gap_s, options.rate, reader.statistics().log_times.start_ns),
        participant_(dds::ext::participant(domain_options(options))),
        qos_(options.qos_file),
        publisher_(participant_, qos_, {playable_.topics.begin(), playable_.topics.end()},
                   options.rate == 0.0 ? topics::Delivery::lossless : topics::Delivery::live) {
    report_.refused = playable_.refused;
    if (options.rate == 0.0) lossy_fusions_.emplace(participant_, qos_);
  }

  PlayerReport run();

private:
  void wait_for_readers();
  void play_once();
  void advance_to(std::uint64_t log_time_ns);
  bool publish(const mcap::Message& message);
  bool wait_for(std::uint64_t log_time_ns);
  void obey_pause(std::uint64_t log_time_ns);
  void begin(std::uint64_t log_time_ns);

  const mcap::Reader& reader_;
  const PlayerOptions& options_;
  PlayControl& control_;
  const process::StopSignal& stop_;
  Playable playable_;
  mcap::Selection selection_;
  PlayClock clock_;
  Gaps gaps_;
  dds::domain::DomainParticipant participant_;
  dds::qos::Provider qos_;
  Republisher publisher_;
  std::optional<publication::LossyFusions> lossy_fusions_;  ///< empty unless the rate is 0
  TimeNs shift_ns_ = 0;                                     ///< shift of the times of the messages
  bus_log::LatchedStart latched_;
  PlayerReport report_;
};

PlayerReport Play::run() {
  if (options_.start) {
    latched_ = bus_log::latched_start(reader_, selection_, qos_, [this] { return stop_.requested(); });
    for (const std::string& damage : latched_.damages) logging::warning("not read: " + damage);
  }
  if (options_.wait_for_readers) wait_for_readers();
  if (lossy_fusions_) lossy_fusions_->warn(stop_);
  const SteadyTime began = clocks::steady_now();
  do {
    play_once();
  } while (options_.loop && !stop_.requested());
  for (const std::string& topic : publisher_.wait_until_read(stop_)) {
    logging::warning(fmt::format("a reader of {} has not confirmed the last messages", topic));
  }
  if (lossy_fusions_) report_.lost_by_fusions = lossy_fusions_->count_lost(stop_);
  report_.shortened_gaps = gaps_.shortened();
  report_.left_out_s = gaps_.left_out_s();
  report_.duration_s = static_cast<double>(clocks::steady_now() - began) * 1e-9;
  return report_;
}

/// Waits until there is a reader, or the requested number, and no further one has come for a while. A remote
/// reader matches the writer later than the writer matches it, and live samples do not wait for it.
void Play::wait_for_readers() {
  constexpr TimeNs settle_ns = 300'000'000;
  constexpr TimeNs poll_period_ns = 20'000'000;
  constexpr TimeNs report_after_ns = 3'000'000'000;
  const SteadyTime began = clocks::steady_now();
  SteadyTime changed = began;
  Republisher::Readers readers;
  bool reported = false;
  const auto are_enough = [&] { return readers.all > 0 && readers.min >= options_.readers; };
  while (!are_enough() || clocks::steady_now() - changed < settle_ns) {
    if (stop_.wait_until(clocks::steady_now() + poll_period_ns)) return;
    const auto now = publisher_.readers();
    if (std::exchange(readers, now).all != now.all) changed = clocks::steady_now();
    if (!are_enough() && !reported && clocks::steady_now() - began > report_after_ns) {
      logging::warning(options_.readers == 0
                           ? "waiting for a reader (--no-wait plays without one)"
                           : fmt::format("waiting for readers: a topic has {} of {} (--readers)", readers.min,
                                         options_.readers));
      reported = true;
    }
  }
}

void Play::play_once() {
  mcap::Selection of_topics = selection_;  // the ends of instances alone are nothing
  of_topics.channel = [this](const mcap::Channel& channel) {
    return selection_.channel(channel) && channel.topic != bus_log::instance_ends_topic;
  };
  if (latched_.samples.is_empty() && !mcap::Messages(reader_, of_topics).next())
    throw std::invalid_argument(reader_.name() + ": has no messages of these topics at these times");
  mcap::Messages messages(reader_, selection_);
  auto message = messages.next();
  begin(message ? message->log_time_ns : selection_.start_ns);
  for (const auto& entry : latched_.samples.entries()) {
    if (!publish(message_at(latched_.samples, entry))) return;
  }
  for (; message; message = messages.next()) {
    advance_to(message->log_time_ns);
    if (!wait_for(message->log_time_ns) || !publish(*message)) return;
  }
  for (const std::string& damage : messages.skipped()) logging::warning("not played: " + damage);
  report_.damaged = messages.skipped().size() + reader_.contents().unreadable_blocks.size();
}

/// Returns false if the stop came.
bool Play::publish(const mcap::Message& message) {
  using Outcome = Republisher::Outcome;
  const auto outcome = publisher_.publish(reader_.channels().at(message.channel_id).topic, message, stop_);
  if (outcome == Outcome::refused && stop_.requested()) return false;  // it may have waited for a reader
  if (outcome == Outcome::published) ++report_.played;
  if (outcome == Outcome::refused) ++report_.refused;
  return true;
}

void Play::begin(std::uint64_t log_time_ns) {
  if (options_.restamp) {
    shift_ns_ = saturated_difference(clocks::host_now(), bus_log::time_of(log_time_ns));
    publisher_.shift_times(shift_ns_);
  }
  gaps_.begin(log_time_ns);
  clock_.begin(log_time_ns, clocks::steady_now());  // after the other clock: no message is from the future
}

/// Leaves out what a gap has too much, also in the times of the messages.
void Play::advance_to(std::uint64_t log_time_ns) {
  const std::uint64_t left_out_ns = gaps_.advance_to(log_time_ns);
  if (left_out_ns == 0) return;
  clock_.leave_out(left_out_ns);
  if (!options_.restamp) return;
  shift_ns_ = saturated_difference(shift_ns_, bus_log::time_of(left_out_ns));
  publisher_.shift_times(shift_ns_);
}

/// Waits until the message is due, or the user steps to it. Returns false if the stop came.
bool Play::wait_for(std::uint64_t log_time_ns) {
  constexpr TimeNs pause_poll_ns = 1'000'000'000;
  while (!stop_.requested()) {
    obey_pause(log_time_ns);
    if (clock_.is_paused() && control_.take_step()) {
      clock_.step_to(log_time_ns);
      return true;
    }
    const auto due = clock_.due(log_time_ns);
    const SteadyTime now = clocks::steady_now();
    if (due && *due <= now) return true;
    stop_.wait_until(due.value_or(now + pause_poll_ns), control_.wakeup());
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
  const mcap::Reader reader(bus_log::recording_files(options.recording));
  const auto step = bus_log::step_back_in(reader);
  if (options.on_read) options.on_read();
  for (const std::string& damage : reader.damages()) logging::warning(damage);
  if (step) logging::warning(*step + "; messages are played by log time, what came after the step first");
  return Play(reader, options, control, stop).run();
}

}  // namespace sonopose::player
