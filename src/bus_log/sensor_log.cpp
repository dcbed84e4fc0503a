#include "bus_log/sensor_log.hpp"

#include "bus_log/dashboard_log.hpp"
#include "bus_log/decoded.hpp"
#include "bus_log/messages.hpp"
#include "logging/log.hpp"
#include "mcap/reader.hpp"
#include "recording/log_columns.hpp"
#include <sonopose/collation/collator.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace sonopose::bus_log {

namespace {

namespace topics = dds::topics;

/// How long an event waits for one that the recorder received later. Live, the fusion waits less; here
/// nothing is in a hurry.
constexpr TimeNs collation_timeout_ns = 1'000'000'000;

bool is_input(const mcap::Channel& channel) {
  return channel.topic == topics::imu.name || channel.topic == topics::fix.name ||
         channel.topic == topics::heading.name;
}

std::string listed(const std::set<BeaconAddress>& addresses) {
  std::string text;
  for (const BeaconAddress address : addresses) text += (text.empty() ? "" : ", ") + std::to_string(address);
  return text;
}

/// One beacon of one file.
class FileLog {
public:
  FileLog(const std::filesystem::path& file, std::optional<BeaconAddress> address) : reader_{file} {
    for (const auto& [id, channel] : reader_.channels()) check(channel);
    address_ = chosen(address);
  }

  recording::SensorLog read() {
    log_.address = address_;
    log_.warnings = reader_.damages();
    mcap::Messages messages(reader_, {.channel = [](const mcap::Channel& channel) {
                              return is_input(channel) || channel.topic == topics::truth.name;
                            }});
    while (const auto message = messages.next()) add(*message);
    std::ranges::stable_sort(log_.truth, {}, &TruthSample::time_ns);
    warn();
    return std::move(log_);
  }

private:
  /// The topics that are read must be what their names say.
  void check(const mcap::Channel& channel) const {
    if (!is_input(channel) && channel.topic != topics::truth.name) return;
    if (channel.message_encoding != "cdr") {
      throw files::IoError(fmt::format(R"({}: topic {} has message encoding "{}" instead of "cdr")",
                                       reader_.name(), channel.topic, channel.message_encoding));
    }
  }

  [[nodiscard]] BeaconAddress chosen(std::optional<BeaconAddress> address) const {
    const std::set<BeaconAddress> found = addresses();
    if (found.empty()) {
      throw files::IoError(reader_.name() + ": has no message of the topics " + topics::imu.name + ", " +
                           topics::fix.name + " or " + topics::heading.name);
    }
    if (address && !found.contains(*address)) {
      throw files::IoError(reader_.name() + ": has no beacon " + std::to_string(*address) + "; it has " +
                           listed(found));
    }
    if (!address && found.size() > 1) {
      throw files::IoError(reader_.name() + ": has " + std::to_string(found.size()) +
                           " beacons; choose one with --beacon: " + listed(found));
    }
    return address.value_or(*found.begin());
  }

  [[nodiscard]] std::set<BeaconAddress> addresses() const {
    std::set<BeaconAddress> found;
    mcap::Messages messages(reader_, {.channel = is_input, .order = mcap::Selection::Order::file});
    while (const auto message = messages.next()) {
      if (const auto address = address_in(message->data)) found.insert(*address);
    }
    return found;
  }

  void add(const mcap::Message& message) {
    if (address_in(message.data) != address_) return;
    const std::string& topic = reader_.channels().at(message.channel_id).topic;
    if (topic == topics::imu.name) {
      collate(decoded(topics::imu, reader_, message), message);
    } else if (topic == topics::fix.name) {
      collate(decoded(topics::fix, reader_, message), message);
    } else if (topic == topics::heading.name) {
      collate(decoded(topics::heading, reader_, message), message);
    } else {
      const TruthSample truth = decoded(topics::truth, reader_, message);
      require_time(truth.time_ns, message);
      log_.truth.push_back(truth);
    }
  }

  void require_time(TimeNs time_ns, const mcap::Message& message) const {
    // As in a log folder: the difference of any two times then fits into 64 bits.
    constexpr TimeNs too_late = TimeNs{1} << 62U;
    if (time_ns > 0 && time_ns < too_late) return;
    fail(reader_, message,
         "has the time " + std::to_string(time_ns) + ", which is not between 1 and 2^62 - 1 ns");
  }

  void collate(const Event& event, const mcap::Message& message) {
    require_time(available_at_ns(event), message);
    if (input_count_++ == 0) first_sequence_ = sequence_of(event);
    const SteadyTime arrival{static_cast<std::int64_t>(message.log_time_ns >> 1U)};
    for (const collation::CollatedEvent& next : collator_.push(event, arrival)) {
      Event numbered = next.event;
      std::visit([this](auto& sample) { sample.sequence = log_.events.size() + 1; }, numbered);
      log_.events.push_back(std::move(numbered));
    }
  }

  void warn() {
    const auto warn_of = [this](std::uint64_t count, std::string_view what) {
      if (count > 0)
        log_.warnings.push_back(reader_.name() + ": " + std::to_string(count) + std::string(what));
    };
    const collation::CollatorCounters& counters = collator_.counters();
    if (first_sequence_ > 1) {
      log_.warnings.push_back(reader_.name() + ": begins with event " + std::to_string(first_sequence_) +
                              " of beacon " + std::to_string(address_) +
                              ": the state of a fusion that had those before is another one");
    }
    warn_of(counters.lost, " events of the bridge are missing in the recording");
    warn_of(counters.duplicated, " events have numbers that came before: two bridges, or too late");
    warn_of(counters.restarts, " times the bridge began to count again");
    warn_of(input_count_ - log_.events.size() - counters.duplicated,
            " events at the end wait for one that is missing, and are left out");
  }

  mcap::Reader reader_;
  BeaconAddress address_ = 0;
  collation::Collator collator_{collation_timeout_ns};
  std::uint64_t input_count_ = 0;
  std::uint64_t first_sequence_ = 0;
  recording::SensorLog log_;
};

}  // namespace

bool is_file(const std::filesystem::path& log) {
  return std::filesystem::is_regular_file(log);
}

std::filesystem::path imu_source(const std::filesystem::path& log) {
  return is_file(log) ? log : log / recording::imu_file;
}

recording::SensorLog read_sensor_log(const std::filesystem::path& log, std::optional<BeaconAddress> address) {
  if (!is_file(log)) return recording::read_sensor_log(log, address);
  auto read = is_dashboard_log(log) ? read_dashboard_log(log, address) : FileLog(log, address).read();
  for (const std::string& warning : read.warnings) logging::warning(warning);
  return read;
}

std::vector<ImuSample> read_imu_log(const std::filesystem::path& log, std::optional<BeaconAddress> address) {
  if (!is_file(log)) return recording::read_imu_log(log, address);
  std::vector<ImuSample> samples;
  for (const Event& event : read_sensor_log(log, address).events) {
    if (const auto* imu = std::get_if<ImuSample>(&event)) samples.push_back(*imu);
  }
  return samples;
}

}  // namespace sonopose::bus_log
