#pragma once
/// \file
/// The parameter services of the relay's node (`ros2 param`), `~/reset`, and services that set poses, for
/// clients with rmw_cyclonedds.

#include "presence/beacon_admission.hpp"
#include "ros2/relay/aiding_inputs.hpp"
#include "ros2/relay/parameter_changes.hpp"
#include "ros2/relay/parameter_events.hpp"
#include "ros2/relay/parameters.hpp"
#include "ros2/relay/startup_settings.hpp"
#include "settings_client/settings_client.hpp"
#include "threads/mutex.hpp"
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/ros2/messages/service_types.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace sonopose::ros2::relay {

struct ParameterServerOptions {
  std::optional<std::filesystem::path> qos_file;
  std::vector<StartupSetting> startup_settings;  ///< sent when a fusion appears and no other is known
  OptionParameters own_parameters = {};          ///< read-only
  presence::AddressSet addresses = {};           ///< beacons with parameters of their own
  std::size_t max_beacons = presence::BeaconAdmission::default_max_beacons;  ///< most with settings at a time
};

/// Serves parameters through the settings topics of the fusion, like sonopose-settings. `serve` must run on a
/// thread that may block; use all other members on the node's thread.
class ParameterServer {
public:
  /// `wake`, if given, is called when there is something to serve, under the rules of a listener. Throws
  /// dds::core::Exception, dds::qos::FileError.
  ParameterServer(ros2::Node& node, const dds::domain::DomainParticipant& participant,
                  const ParameterServerOptions& options, std::function<void()> wake = {});

  /// Adds services. Call it before they are offered.
  void add(std::vector<SetPoseService> services) { set_poses_ = std::move(services); }

  /// Creates or withdraws the services; there are none at first. The node announces the change. May wait for
  /// `serve`.
  void offer_services(ros2::Node& node, bool offered);

  /// Replies to all pending requests, and publishes changes of parameters. Waits for the fusion at most two
  /// seconds per change or reset, and not beyond the stop. Returns true if a request could not be replied to
  /// yet: call it again after 20 ms.
  bool serve(const Stopped& stopped = settings_client::SettingsClient::never);

private:
  struct Services {
    Services(ros2::Node& node, const std::function<void()>& wake,
             const std::vector<SetPoseService>& set_poses);
    template <class Action>
    void for_each(const Action& action) const {
      std::apply([&](const auto&... service) { (action(service), ...); },
                 std::tie(list, get, get_types, describe, set, set_atomically, reset));
      for (const auto& service : set_pose) action(service);
    }

    ros2::Service<ros2::ListParameters> list;
    ros2::Service<ros2::GetParameters> get;
    ros2::Service<ros2::GetParameterTypes> get_types;
    ros2::Service<ros2::DescribeParameters> describe;
    ros2::Service<ros2::SetParameters> set;
    ros2::Service<ros2::SetParametersAtomically> set_atomically;
    ros2::Service<ros2::Trigger> reset;
    std::vector<ros2::Service<ros2::SetPose>> set_pose;  ///< in the order of `set_poses_`
  };

  class SettingsListener final : public dds::sub::NoOpDataReaderListener<sonopose_EffectiveSettings> {
  public:
    explicit SettingsListener(const std::function<void()>& wake) : wake_(wake) {}
    void on_data_available(dds::sub::DataReader<sonopose_EffectiveSettings>& /*reader*/) noexcept override {
      wake_();
    }

  private:
    const std::function<void()>& wake_;
  };

  void take_settings();
  void apply_startup_settings();
  void list(const ros2::ListParameters::Request& request, const auto& reply);
  void get(const ros2::GetParameters::Request& request, const auto& reply);
  void get_types(const ros2::GetParameterTypes::Request& request, const auto& reply);
  void describe(const ros2::DescribeParameters::Request& request, const auto& reply);
  void set(const ros2::SetParameters::Request& request, const auto& reply);
  void set_atomically(const ros2::SetParametersAtomically::Request& request, const auto& reply);
  void reset(const auto& reply);
  /// Resets the beacons of `addresses_` and no others. Returns their addresses.
  std::vector<BeaconAddress> reset_beacons();
  bool refuses(const std::string& excess);
  /// Returns the error of a change of the first read-only parameter among these; empty without one.
  [[nodiscard]] std::string read_only_error(std::span<const ros2::Parameter> parameters) const;
  void log_refusal(const std::string& reason);

  std::function<void()> wake_;
  settings_client::SettingsClient client_;
  presence::AddressSet addresses_;
  ParameterChanges changes_{client_, addresses_};
  Stopped stopped_ = settings_client::SettingsClient::never;  ///< that of `serve`
  std::vector<SettingsRequest> startup_requests_;
  OptionParameters own_parameters_;
  SteadyTime next_refusal_;        ///< not logged before
  bool reported_invalid_ = false;  ///< a value of the settings
  bool applied_startup_ = false;
  SettingsByBeacon effective_;
  ParameterEvents events_;
  std::vector<SetPoseService> set_poses_;
  threads::Mutex services_mutex_;
  std::optional<Services> services_ SONOPOSE_GUARDED_BY(services_mutex_);
  // The reader is last, so that its listener is destroyed after it.
  presence::BeaconAdmission admission_;
  SettingsListener settings_listener_;
  dds::sub::DataReader<sonopose_EffectiveSettings> settings_;
};

}  // namespace sonopose::ros2::relay
