#include "recorder/trigger.hpp"

#include <sonopose/dds/topics/serialized_topics.hpp>

namespace sonopose::recorder {

const char* text_of(TriggerCause cause) {
  switch (cause) {
    case TriggerCause::none:
      return "no trigger";
    case TriggerCause::signal:
      return "a signal";
    case TriggerCause::topic:
      return "a sample of the trigger topic";
    case TriggerCause::status:
      return "the status of a pose";
  }
  return "";
}

void BadStatusTrigger::on_sample(std::span<const std::byte> pose) noexcept {
  const auto address = dds::topics::beacon_of(pose);
  if (!address) return;
  const std::uint32_t status = dds::topics::status_of_pose(pose);
  const bool is_good = (status & bad_status) == 0;
  if (!is_good && was_good_.test(*address)) trigger_.fire(TriggerCause::status);
  was_good_.set(*address, is_good && (status & status_initialising) == 0);
}

}  // namespace sonopose::recorder
