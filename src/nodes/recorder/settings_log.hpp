#pragma once
/// \file
/// The effective settings as metadata of a file, readable without the type of their samples.

#include "mcap/chunk.hpp"
#include "mcap/records.hpp"
#include <sonopose/samples/live_settings.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace sonopose::recorder {

class SettingsLog {
public:
  /// `channel_id`: channel of the effective settings; 0 if they are not recorded.
  explicit SettingsLog(std::uint16_t channel_id) : channel_id_(channel_id) {}

  /// Returns a record for each change in a chunk. The record of a beacon has all its settings, or none as
  /// long as they equal those of all beacons.
  std::vector<mcap::Metadata> on(const mcap::Chunk& chunk);

  /// Starts another file, which contains no settings yet.
  void clear() { known_.clear(); }

private:
  struct Known {
    std::map<std::string, std::string> values;
    std::uint64_t from_sequence = 0;
    bool equals_common = false;  ///< state in the last record
  };

  [[nodiscard]] bool equals_common(BeaconAddress address) const;
  mcap::Metadata record_of(BeaconAddress address, std::uint64_t log_time_ns);
  void add_left_behind(std::uint64_t log_time_ns, std::vector<mcap::Metadata>& records);

  std::uint16_t channel_id_;
  std::map<BeaconAddress, Known> known_;
};

}  // namespace sonopose::recorder
