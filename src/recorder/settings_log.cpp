#include "recorder/settings_log.hpp"

#include "recorder/chunk_messages.hpp"
#include <sonopose/dds/binding/cdr.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/idl_types.hpp>

namespace sonopose::recorder {

std::vector<mcap::Metadata> SettingsLog::on(const mcap::Chunk& chunk) {
  std::vector<mcap::Metadata> records;
  for (const mcap::Chunk::Entry& entry : chunk.entries()) {
    if (entry.channel_id != channel_id_) continue;
    const dds::CdrSample<sonopose_EffectiveSettings> sample(message_at(chunk, entry).data);
    if (sample.get() == nullptr) continue;
    const EffectiveSettings settings = dds::topics::from_idl(*sample.get());
    Values values;
    for (const SettingAssignment& assignment : settings.values) values[assignment.key] = assignment.value;
    const auto [known, is_new] = last_.try_emplace(settings.address);
    if (!is_new && known->second == values) continue;
    known->second = values;
    mcap::TextMap text{{"log_time_ns", std::to_string(entry.log_time_ns)},
                       {"from_event_sequence", std::to_string(settings.from_sequence)}};
    const auto general = last_.find(all_beacons);
    if (settings.address != all_beacons) text["address"] = std::to_string(settings.address);
    for (const auto& [key, value] : values) {
      const bool is_general = settings.address != all_beacons && general != last_.end() &&
                              general->second.contains(key) && general->second.at(key) == value;
      if (!is_general) text[key] = value;
    }
    records.push_back({"sonopose.settings", std::move(text)});
  }
  return records;
}

}  // namespace sonopose::recorder
