#pragma once
/// \file
/// Asks a running fusion: which settings hold, to use others, to begin anew.

#include <sonopose/samples/live_settings.hpp>
#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/qos/provider.hpp>
#include "process/stop_signal.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

namespace sonopose::settings_client {

class SettingsClient {
public:
  /// Joins the domain. Throws dds::Error, dds::QosFileError.
  SettingsClient(const dds::DomainOptions& domain, const std::optional<std::filesystem::path>& qos_file);

  /// The settings of one beacon; where it has not been heard, what holds for any that has none of its own
  /// (under the address all_beacons). For all_beacons, that first, and then every beacon's that was heard, by
  /// address. Empty where none came within `timeout_s`.
  std::vector<EffectiveSettings> in_force(BeaconAddress address, double timeout_s);

  /// Sends a request, with an id of its own, and waits for its answer. Empty where none came within
  /// `timeout_s`.
  std::optional<SettingsReply> change(SettingsRequest request, double timeout_s);

  /// Calls `on_settings` for the settings of one beacon, or of all_beacons, that hold, and then whenever
  /// others do, until the stop or, where it is not 0, for `duration_s`.
  void watch(BeaconAddress address, const std::function<void(const EffectiveSettings&)>& on_settings,
             double duration_s, const process::StopSignal& stop);

  /// Re-initialises one beacon's engine, or all_beacons, and waits until it has been. Returns the beacons
  /// that were reset by address; empty where a fusion did not say so within `timeout_s`.
  std::vector<BeaconAddress> reset(BeaconAddress address, double timeout_s);

private:
  dds::QosProvider qos_;
  dds::DomainParticipant participant_;
};

}  // namespace sonopose::settings_client
