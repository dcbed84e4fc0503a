#pragma once
/// \file
/// Settings while the fusion runs: a request, its reply, and the effective settings.

#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose {

/// One setting by its key and its value as text: "drift.jump_alpha", "0.5".
struct SettingAssignment {
  std::string key;
  std::string value;

  bool operator==(const SettingAssignment&) const = default;
};

/// Change settings of one beacon, or of all_beacons. Either all assignments are applied or none.
struct SettingsRequest {
  BeaconAddress address = 0;
  std::uint64_t request_id =
      0;  ///< chosen by the sender; a repeated one changes nothing, 0 never counts as repeated
  std::uint64_t from_sequence = 0;  ///< first event with the change; 0, or one that is past: the next
  std::vector<SettingAssignment> assignments;

  bool operator==(const SettingsRequest&) const = default;
};

/// The reply to one request.
struct SettingsReply {
  BeaconAddress address = 0;     ///< of the request
  std::uint64_t request_id = 0;  ///< of the request
  bool accepted = false;
  std::string reason;               ///< refused: why; accepted: a warning, or empty
  std::uint64_t from_sequence = 0;  ///< accepted, a known beacon: first event; otherwise as requested
  std::string details =
      {};  ///< accepted, all beacons: first event of each known one, "7: event 812, 9: event 501"

  bool operator==(const SettingsReply&) const = default;
};

/// The settings that one beacon's engine uses; under all_beacons, those of a beacon without its own.
struct EffectiveSettings {
  BeaconAddress address = 0;
  TimeNs time_ns = 0;                     ///< time of writing
  std::uint64_t from_sequence = 0;        ///< first event that they are used for
  std::vector<SettingAssignment> values;  ///< every setting, items 2, 3 and 4 as the preset sets them

  bool operator==(const EffectiveSettings&) const = default;
};

}  // namespace sonopose
