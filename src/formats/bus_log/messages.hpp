#pragma once
/// \file
/// Selects messages of a recording, finds their beacon, and writes them as JSON.

#include "bus_log/latched_start.hpp"
#include "bus_log/moment.hpp"
#include "files/error.hpp"
#include "mcap/reader.hpp"
#include "ros2/bag/message_definition.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace sonopose::bus_log {

/// Returns the beacon of a message; empty if its topic has none or is not native.
std::optional<BeaconAddress> beacon_of(const mcap::Channel& channel, const mcap::Message& message);

/// Writes one line without a newline: `topic`, `sequence`, `log_time_ns`, `publish_time_ns`, and `message`
/// with the fields of the IDL. A message of a foreign topic, or an unreadable one, has `data` in hexadecimal
/// digits instead.
std::string json_of(const mcap::Channel& channel, const mcap::Message& message);

/// Writes the messages of a recording in the same way, and those of ROS 2 with the fields of their schemas.
class MessageLines {
public:
  explicit MessageLines(const mcap::Reader& reader) : reader_{reader} {}

  std::string line_of(const mcap::Channel& channel, const mcap::Message& message);

private:
  const mcap::Reader& reader_;
  std::map<std::uint16_t, std::optional<ros2::bag::MessageDefinition>> definitions_;  ///< by schema
};

/// A selection of messages of a recording.
struct Choice {
  std::vector<std::string> topics{};      ///< names as of topics::short_name; empty: all
  std::optional<BeaconAddress> beacon{};  ///< only messages of this beacon
  std::optional<Moment> start{};
  std::optional<Moment> end{};
};

/// Error of a selection without a message: "run.mcap: none of its 15 messages is selected or readable".
[[nodiscard]] files::IoError nothing_selected(const std::vector<const mcap::Reader*>& readers,
                                              std::uint64_t message_count, const std::string& reason = {});

/// The chosen messages of a recording, by time or in file order. Throws files::IoError that lists the file's
/// topics if it lacks a topic of the choice.
class ChosenMessages {
public:
  ChosenMessages(const mcap::Reader& reader, const Choice& choice,
                 mcap::Selection::Damaged damaged = mcap::Selection::Damaged::refuse,
                 mcap::Selection::Order order = mcap::Selection::Order::log_time);

  /// Lets the state of latched topics at the start come first (latched_start.hpp).
  void begin_with_latched();

  /// Returns true if messages of a channel of the file can be chosen.
  [[nodiscard]] bool has(const mcap::Channel& channel) const {
    return !selection_.channel || selection_.channel(channel);
  }

  struct Chosen {
    const mcap::Channel* channel = nullptr;
    mcap::Message message;
  };
  /// The next message, valid until the next call; empty at the end. Throws files::IoError that lists the
  /// beacons if the end comes without a message of the chosen one.
  std::optional<Chosen> next();

  [[nodiscard]] const std::vector<std::string>& skipped() const { return messages_.skipped(); }
  /// Descriptions of what could not be read before the start.
  [[nodiscard]] const std::vector<std::string>& skipped_before() const { return latched_.damages; }

private:
  std::optional<mcap::Message> next_of_all();
  void require_beacon() const;

  const mcap::Reader& reader_;
  std::optional<BeaconAddress> beacon_;
  std::set<BeaconAddress> found_beacons_;
  mcap::Selection selection_;
  LatchedStart latched_;
  std::size_t next_latched_ = 0;
  mcap::Messages messages_;
};

}  // namespace sonopose::bus_log
