#pragma once
/// \file
/// The settings in effect, as metadata of a file: readable without the type of their samples.

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
  /// `channel_id`: of the effective settings; 0 if they are not recorded.
  explicit SettingsLog(std::uint16_t channel_id) : channel_id_(channel_id) {}

  /// A record for each change in a chunk. Those of one beacon have only what differs from those of all
  /// beacons.
  std::vector<mcap::Metadata> on(const mcap::Chunk& chunk);

  /// Another file begins, which knows nothing yet.
  void clear() { last_.clear(); }

private:
  using Values = std::map<std::string, std::string>;

  std::uint16_t channel_id_;
  std::map<BeaconAddress, Values> last_;
};

}  // namespace sonopose::recorder
