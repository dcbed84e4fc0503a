#pragma once
/// \file
/// Changes of parameters that a client of ROS 2 requests, as few requests to the fusion.

#include "presence/address_set.hpp"
#include "ros2/relay/parameters.hpp"
#include "settings_client/settings_client.hpp"
#include <sonopose/ros2/messages/service_types.hpp>

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace sonopose::ros2::relay {

/// Time that a fusion has for a reply.
inline constexpr double reply_timeout_s = 2.0;

// Limits of a request, which any program can send.
inline constexpr std::size_t max_names = 1000;
inline constexpr std::size_t max_name_bytes = 256;
inline constexpr std::size_t max_text_bytes = 256U << 10U;  ///< names and values together

/// The reason for refusing a request with so many names and bytes; empty if it is within the limits.
std::string excess_of(std::size_t names, std::size_t bytes);

/// Checks the names and the text values of these parameters against the limits.
std::string excess_of(std::span<const ros2::Parameter> parameters);

/// True when the process ends, so that nothing may wait any longer.
using Stopped = settings_client::SettingsClient::Stopped;

/// Sends changes to the fusion. Each request to it waits at most two seconds for the reply, and ends at the
/// stop.
class ParameterChanges {
public:
  /// `client` must outlive this object. `addresses`: the beacons whose own settings may change.
  explicit ParameterChanges(settings_client::SettingsClient& client,
                            const presence::AddressSet& addresses = {})
      : client_(client), addresses_(addresses.with(all_beacons)) {}

  /// Changes each parameter that can be changed: those of one beacon by one request, or up to
  /// sixteen of them one by one if the fusion refuses them together. Returns an error for each parameter,
  /// empty on success.
  std::vector<std::string> set(std::span<const ros2::Parameter> parameters, const Stopped& stopped);

  /// Changes all parameters or none. Returns the error, empty on success.
  std::string set_atomically(std::span<const ros2::Parameter> parameters, const Stopped& stopped);

private:
  struct Change {
    std::size_t place = 0;  ///< in the request
    SettingAssignment assignment = {};
  };
  using Changes = std::map<BeaconAddress, std::vector<Change>>;
  struct Outcome {
    std::string error = {};   ///< empty on success
    bool is_refusal = false;  ///< by the fusion
  };

  Outcome send(const SettingsRequest& request, const Stopped& stopped);

  settings_client::SettingsClient& client_;
  presence::AddressSet addresses_;  ///< including all_beacons
};

}  // namespace sonopose::ros2::relay
