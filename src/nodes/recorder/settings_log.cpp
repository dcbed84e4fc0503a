#include "recorder/settings_log.hpp"

#include "mcap/chunk_messages.hpp"
#include <sonopose/dds/psm/cdr.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/idl_types.hpp>

#include <optional>
#include <utility>

namespace sonopose::recorder {

std::vector<mcap::Metadata> SettingsLog::on(const mcap::Chunk& chunk) {
  std::vector<mcap::Metadata> records;
  std::optional<std::uint64_t> all_changed_ns;
  for (const mcap::Chunk::Entry& entry : chunk.entries()) {
    if (entry.channel_id != channel_id_) continue;
    const dds::CdrSample<sonopose_EffectiveSettings> sample(message_at(chunk, entry).data);
    if (sample.get() == nullptr) continue;
    const EffectiveSettings settings = dds::topics::from_idl(*sample.get());
    Known now{.values = {}, .from_sequence = settings.from_sequence};
    for (const SettingAssignment& assignment : settings.values) now.values[assignment.key] = assignment.value;
    const auto [known, is_new] = known_.try_emplace(settings.address);
    if (!is_new && known->second.values == now.values) continue;
    known->second = std::move(now);
    if (settings.address == all_beacons) all_changed_ns = entry.log_time_ns;
    records.push_back(record_of(settings.address, entry.log_time_ns));
  }
  if (all_changed_ns) add_left_behind(*all_changed_ns, records);
  return records;
}

bool SettingsLog::equals_common(BeaconAddress address) const {
  const auto all = known_.find(all_beacons);
  return address != all_beacons && all != known_.end() && known_.at(address).values == all->second.values;
}

mcap::Metadata SettingsLog::record_of(BeaconAddress address, std::uint64_t log_time_ns) {
  Known& known = known_.at(address);
  known.equals_common = equals_common(address);
  mcap::TextMap text;
  if (!known.equals_common) text.insert(known.values.begin(), known.values.end());
  text["log_time_ns"] = std::to_string(log_time_ns);
  text["from_event_sequence"] = std::to_string(known.from_sequence);
  if (address != all_beacons) text["address"] = std::to_string(address);
  return {"sonopose.settings", std::move(text)};
}

/// Records the beacons that kept their values when the common settings, which they had, changed.
void SettingsLog::add_left_behind(std::uint64_t log_time_ns, std::vector<mcap::Metadata>& records) {
  for (const auto& [address, known] : known_) {
    if (known.equals_common && !equals_common(address)) records.push_back(record_of(address, log_time_ns));
  }
}

}  // namespace sonopose::recorder
