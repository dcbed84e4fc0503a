#pragma once
/// \file
/// The settings on the bus: answers requests and publishes the settings in effect.

#include "fusion/beacon_estimators.hpp"
#include "fusion/changed_settings.hpp"
#include "fusion/settings_requests.hpp"
#include "logging/bounded_log.hpp"
#include "presence/address_set.hpp"
#include "threads/guarded.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>

namespace sonopose::fusion {

/// Serves settings on a thread of its own, so that no pose waits for a request. After each answer it pauses
/// for as long as the answer took, which leaves the processor to the poses during a flood of requests. The
/// reader keeps the latest requests meanwhile.
class SettingsServer {
public:
  /// Answers requests for `addresses` and for all beacons.
  SettingsServer(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                 threads::Guarded<BeaconEstimators>& estimators, presence::AddressSet addresses);
  SettingsServer(const SettingsServer&) = delete;
  SettingsServer& operator=(const SettingsServer&) = delete;
  /// Publishes the last changes.
  ~SettingsServer();

  /// Replaces all settings from the next event of each beacon on, and with them accepted requests.
  void replace(config::FusionConfig config);

  /// Schedules the publication of settings that changed with an event.
  void on_change() noexcept { wake_.trigger_value(true); }

  /// Ends the publication of the settings of a beacon, or for all_beacons.
  void unregister(BeaconAddress address) noexcept;

  /// Number of settings and replies that a slow reader prevented from being written.
  [[nodiscard]] std::uint64_t unwritten() const { return unwritten_; }

private:
  void serve();
  void replace_requested();
  void try_answer(const sonopose_SettingsRequest& request);
  void answer(const sonopose_SettingsRequest& request);
  void log(const SettingsRequest& request, const SettingsReply& reply);
  void publish_changes();
  void publish(const SettingsChange& change);
  void publish_changed(BeaconAddress address);
  void publish(dds::pub::DataWriter<sonopose_EffectiveSettings>& writer, EffectiveSettings settings);
  void write(const auto& attempt);

  threads::Guarded<BeaconEstimators>& estimators_;
  presence::AddressSet addresses_;
  SettingsRequests requests_;
  ChangedSettings changed_settings_{estimators_, addresses_};
  static constexpr std::uint64_t max_logged_per_minute = 60;
  logging::BoundedLog log_{max_logged_per_minute};
  std::uint64_t last_logged_id_ = 0;  ///< request id; a sender repeats its request until the reply arrives
  dds::pub::DataWriter<sonopose_EffectiveSettings> settings_writer_;
  dds::pub::DataWriter<sonopose_EffectiveSettings> changed_writer_;
  dds::pub::DataWriter<sonopose_SettingsReply> reply_writer_;
  dds::sub::DataReader<sonopose_SettingsRequest> request_reader_;
  dds::core::cond::GuardCondition wake_;
  threads::Guarded<std::optional<config::FusionConfig>> replacement_;
  std::atomic<bool> stopping_ = false;
  std::atomic<std::uint64_t> unwritten_ = 0;
  std::thread thread_;
};

}  // namespace sonopose::fusion
