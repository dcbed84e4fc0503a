#pragma once
/// \file
/// Watches the readers of a recording that a source plays.

#include "process/stop_signal.hpp"
#include "publication/lossy_fusions.hpp"
#include "publication/topic_writers.hpp"

#include <cstdint>
#include <optional>

namespace sonopose::publication {

/// Waits for the readers of a recording, and logs what they did not receive. Not thread-safe.
class RecordingReaders {
public:
  /// `qos` and `writers` must outlive it. `lossless`: the writers wait for their readers.
  RecordingReaders(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                   TopicWriters& writers, bool lossless);

  /// Waits until each stream has a reader.
  void wait(const process::StopSignal& stop);

  /// Warns once if the last reader of a lossless recording has ended: writes without readers succeed.
  void check();

  /// Waits until the readers have received everything.
  void finish(const process::StopSignal& stop);

  /// Number of events that fusions have lost, plus one if a part of the recording reached no reader. Counts
  /// only in lossless mode.
  [[nodiscard]] std::uint64_t lost() const { return lost_by_fusions_ + (has_unread_ ? 1 : 0); }

private:
  TopicWriters& writers_;
  bool lossless_;
  std::optional<LossyFusions> lossy_fusions_;  ///< empty unless lossless
  std::uint64_t lost_by_fusions_ = 0;
  bool has_readers_ = false;  ///< a lossless recording that has had a reader all the time
  bool has_unread_ = false;   ///< a part of a lossless recording reached no reader
};

}  // namespace sonopose::publication
