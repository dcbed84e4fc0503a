#include "bridge/beacon_recorder.hpp"

#include <string>
#include <utility>

namespace sonopose::bridge {

BeaconRecorder::BeaconRecorder(std::filesystem::path folder)
    : folder_(std::move(folder)), first_(std::make_unique<recording::SensorLogWriter>(folder_)) {}

void BeaconRecorder::flush() {
  first_->flush();
  for (const auto& entry : further_) entry.second->flush();
}

recording::SensorLogWriter& BeaconRecorder::log_of(BeaconAddress address) {
  auto& log = by_address_[address];
  if (log == nullptr && by_address_.size() == 1) log = first_.get();
  if (log == nullptr) {
    auto further =
        std::make_unique<recording::SensorLogWriter>(folder_ / ("beacon_" + std::to_string(address)));
    log = further.get();
    further_.emplace(address, std::move(further));
  }
  return *log;
}

}  // namespace sonopose::bridge
