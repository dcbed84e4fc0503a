#pragma once
/// \file
/// Settings while the fusion runs: a request, its reply, and the effective settings.

#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose {

inline namespace native {

/// One setting by its key and its value as text: "documented.drift.jump_alpha", "0.5".
struct SettingAssignment {
  std::string key;
  std::string value;

  bool operator==(const SettingAssignment&) const = default;
};

/// Request to change settings of one beacon, or of all_beacons. All assignments are applied, or none.
struct SettingsRequest {
  BeaconAddress address = 0;
  std::uint64_t request_id =
      0;  ///< chosen by the sender; a repeated one changes nothing, 0 never counts as repeated
  std::uint64_t from_sequence = 0;  ///< first event with the change; 0 or a past event: the next one
  std::vector<SettingAssignment> assignments;

  bool operator==(const SettingsRequest&) const = default;
};

/// Reply to one request.
struct SettingsReply {
  BeaconAddress address = 0;     ///< address of the request
  std::uint64_t request_id = 0;  ///< id of the request
  bool accepted = false;
  std::string reason;  ///< refused: the reason; accepted: a warning, or empty
  std::uint64_t from_sequence =
      0;  ///< first event with the change, if accepted for a known beacon; otherwise as requested
  /// First event of each known beacon, if accepted for all, and the beacons that keep their own values of all
  /// the settings: "7: event 812, 9: event 501; unchanged: 8".
  std::string details = {};

  bool operator==(const SettingsReply&) const = default;
};

/// Settings of one beacon's engine; under all_beacons, those of a beacon without its own. On the topic of
/// changed settings, it has only what a configuration file needs: the values that differ from the defaults,
/// and a beacon's own values that differ from those for all.
struct EffectiveSettings {
  BeaconAddress address = 0;
  TimeNs time_ns = 0;                     ///< time of writing
  std::uint64_t from_sequence = 0;        ///< first event for which they are used
  std::vector<SettingAssignment> values;  ///< every setting; items 2, 3 and 4 as the preset sets them

  bool operator==(const EffectiveSettings&) const = default;
};

}  // namespace native

}  // namespace sonopose
