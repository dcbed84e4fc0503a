#pragma once
/// \file
/// Writes messages of a recording to the bus.

#include "mcap/records.hpp"
#include "process/stop_signal.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/serialized_topics.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace sonopose::player {

/// Reason for not playing a channel of a file; empty if it is played. `schema` is null if the channel has
/// none.
std::string obstacle_to(const mcap::Channel& channel, const mcap::Schema* schema);

/// Writers of the topics of a recording, which publish its messages as they are, but for their times.
class Republisher {
public:
  /// Creates one writer for each native topic among the names. Throws dds::core::Exception.
  Republisher(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
              const std::vector<std::string>& topics, dds::topics::Delivery delivery);

  /// Moves the times of the following messages, both stamps and contents.
  void shift_times(TimeNs shift_ns) { shift_ns_ = shift_ns; }

  enum class Outcome : std::uint8_t {
    published,
    refused,   ///< not of the topic's type, or stopped while waiting for readers
    unplayed,  ///< end of an instance of a topic without a writer
  };
  /// Writes a message of that topic, or ends the instance that the message names.
  Outcome publish(const std::string& topic, const mcap::Message& message, const process::StopSignal& stop);

  struct Readers {
    std::size_t all = 0;  ///< total of all writers
    std::size_t min = 0;  ///< smallest number of one writer
  };
  [[nodiscard]] Readers readers();
  /// Waits until the readers have received everything, for at most ten seconds per topic, or until the stop.
  /// Returns the topics that lack acknowledgements then.
  [[nodiscard]] std::vector<std::string> wait_until_read(const process::StopSignal& stop);

private:
  struct Stream {
    const dds::topics::SerializedTopic* topic;
    dds::SerializedWriter writer;
  };

  Outcome end_instance(const mcap::Message& message, const process::StopSignal& stop);
  static Outcome forward(Stream& stream, std::span<const std::byte> bytes, TimeNs stamp_ns,
                         dds::ext::Change change, const process::StopSignal& stop);
  [[nodiscard]] TimeNs shifted(std::uint64_t time_ns) const;

  std::map<std::string, Stream> streams_;
  TimeNs shift_ns_ = 0;
  std::vector<std::byte> moved_;  ///< message with shifted times
};

}  // namespace sonopose::player
