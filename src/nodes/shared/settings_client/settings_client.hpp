#pragma once
/// \file
/// Client of a running fusion: reads and changes its effective settings, and resets its estimators.

#include "process/stop_signal.hpp"
#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/samples/live_settings.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

namespace sonopose::settings_client {

/// A client of the fusions of one domain. Each call makes its endpoints and waits for the answers.
class SettingsClient {
public:
  /// Joins the domain. Throws dds::core::Exception, dds::qos::FileError.
  SettingsClient(const dds::DomainOptions& domain, const std::optional<std::filesystem::path>& qos_file);
  /// Uses a participant. Throws dds::qos::FileError.
  SettingsClient(dds::domain::DomainParticipant participant,
                 const std::optional<std::filesystem::path>& qos_file);

  /// Effective settings of one beacon. If the fusion has none of this beacon, returns the default settings of
  /// all beacons, with the address all_beacons. For all_beacons: first the default settings, then those of
  /// each known beacon, ordered by address. Empty if none arrived within `timeout_s`.
  std::vector<EffectiveSettings> effective(BeaconAddress address, double timeout_s);

  /// Settings that a configuration file needs to give those of every fusion again, changes that still wait
  /// included (EffectiveSettings), in any order. Always has all_beacons; empty if not everything arrived
  /// within `timeout_s`. Throws std::runtime_error if fusions have different settings.
  std::vector<EffectiveSettings> changed(double timeout_s);

  /// True if waiting must end early; called every 20 ms.
  using Stopped = std::function<bool()>;
  static bool never() { return false; }

  /// Sends a request with a new id and waits for the reply. Empty if none arrived within `timeout_s`, or
  /// before the stop.
  std::optional<SettingsReply> change(SettingsRequest request, double timeout_s,
                                      const Stopped& stopped = never);

  /// Calls `on_settings` with the effective settings of one beacon, or of all_beacons, and again for each
  /// change, until the stop or, unless it is 0, for `duration_s`.
  void observe(BeaconAddress address, const std::function<void(const EffectiveSettings&)>& on_settings,
               double duration_s, const process::StopSignal& stop);

  /// Resets the estimator of one beacon, or of all_beacons, and waits for the confirmation of every fusion.
  /// Returns the addresses of the beacons in order; empty if a fusion did not confirm within `timeout_s`,
  /// or before the stop.
  std::vector<BeaconAddress> reset(BeaconAddress address, double timeout_s, const Stopped& stopped = never);

private:
  dds::qos::Provider qos_;
  dds::domain::DomainParticipant participant_;
};

}  // namespace sonopose::settings_client
