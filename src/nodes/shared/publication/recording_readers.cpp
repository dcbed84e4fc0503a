#include "publication/recording_readers.hpp"

#include "logging/log.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace sonopose::publication {

RecordingReaders::RecordingReaders(const dds::domain::DomainParticipant& participant,
                                   const dds::qos::Provider& qos, TopicWriters& writers, bool lossless)
    : writers_(writers), lossless_(lossless) {
  if (lossless_) lossy_fusions_.emplace(participant, qos);
}

void RecordingReaders::wait(const process::StopSignal& stop) {
  writers_.wait_for_readers();
  has_readers_ = lossless_;
  if (lossy_fusions_) lossy_fusions_->warn(stop);
}

void RecordingReaders::check() {
  if (!has_readers_ || writers_.has_reader() || writers_.stopped()) return;
  has_readers_ = false;
  has_unread_ = true;
  logging::warning("the last reader has ended before the recording: the rest of it is not received");
}

void RecordingReaders::finish(const process::StopSignal& stop) {
  const auto unread = writers_.wait_until_read();
  check();
  if (lossy_fusions_) lost_by_fusions_ = lossy_fusions_->count_lost(stop);
  if (unread.empty()) return;
  logging::warning(fmt::format("a reader has not received all of {}", fmt::join(unread, ", ")));
  has_unread_ |= lossless_;
}

}  // namespace sonopose::publication
