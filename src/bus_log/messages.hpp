#pragma once
/// \file
/// What is in the messages of a recording: the beacon, and all of it as JSON.

#include "mcap/reader.hpp"
#include <sonopose/samples/samples.hpp>

#include <optional>
#include <string>
#include <vector>

namespace sonopose::bus_log {

/// The beacon that a message belongs to; empty if its topic has none, or is not ours.
std::optional<BeaconAddress> beacon_of(const mcap::Channel& channel, const mcap::Message& message);

/// One line, without a newline: `topic`, `sequence`, `log_time_ns`, `publish_time_ns`, and `message` with the
/// fields of the IDL; `data`, in hexadecimal digits, for a message that is not of a topic of ours or cannot
/// be read.
std::string json_of(const mcap::Channel& channel, const mcap::Message& message);

/// Which messages of a recording.
struct Choice {
  std::vector<std::string> topics{};      ///< with or without "sonopose/"; empty: all
  std::optional<BeaconAddress> beacon{};  ///< messages of this one alone
  double start_s = 0;                     ///< after the first message of the file
  std::optional<double> end_s{};          ///< the same
};

/// The messages of a recording that a choice names, by time or in the order of the file. Throws
/// files::IoError if the file does not have a topic of the choice, and names those it has.
class ChosenMessages {
public:
  ChosenMessages(const mcap::Reader& reader, const Choice& choice,
                 mcap::Selection::Damaged damaged = mcap::Selection::Damaged::refuse,
                 mcap::Selection::Order order = mcap::Selection::Order::log_time);

  /// Whether messages of a channel of the file can be chosen.
  [[nodiscard]] bool has(const mcap::Channel& channel) const {
    return !selection_.channel || selection_.channel(channel);
  }

  struct Chosen {
    const mcap::Channel* channel = nullptr;
    mcap::Message message;
  };
  /// The next one, valid until the next call; empty at the end.
  std::optional<Chosen> next();

  [[nodiscard]] const std::vector<std::string>& skipped() const { return messages_.skipped(); }

private:
  const mcap::Reader& reader_;
  std::optional<BeaconAddress> beacon_;
  mcap::Selection selection_;
  mcap::Messages messages_;
};

}  // namespace sonopose::bus_log
