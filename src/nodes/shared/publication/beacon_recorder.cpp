#include "publication/beacon_recorder.hpp"

#include <optional>
#include <string>
#include <utility>

namespace sonopose::publication {

BeaconRecorder::BeaconRecorder(const std::filesystem::path& folder, recording::LogSettings settings)
    : folder_(folder), settings_(std::move(settings)) {}

BeaconRecorder::~BeaconRecorder() {
  if (!finished_) folder_.remove_if_empty();
}

void BeaconRecorder::flush() {
  for (auto& entry : logs_) entry.second.flush();
}

void BeaconRecorder::finish() {
  if (is_empty()) return;
  flush();
  std::optional<BeaconAddress> only;
  if (logs_.size() == 1) only = logs_.begin()->first;
  logs_.clear();
  if (only) {
    folder_.commit(part_of(*only));
  } else {
    folder_.commit();
  }
  finished_ = true;
}

std::filesystem::path BeaconRecorder::part_of(BeaconAddress address) const {
  return part() / ("beacon_" + std::to_string(address));
}

recording::SensorLogWriter& BeaconRecorder::log_of(BeaconAddress address) {
  const auto found = logs_.find(address);
  if (found != logs_.end()) return found->second;
  return logs_.try_emplace(address, part_of(address), settings_).first->second;
}

}  // namespace sonopose::publication
