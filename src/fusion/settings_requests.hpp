#pragma once
/// \file
/// Carries out requests to change settings.

#include "fusion/beacon_estimators.hpp"
#include "process/guarded.hpp"
#include <sonopose/samples/live_settings.hpp>

#include <deque>

namespace sonopose::fusion {

/// One thread. A request is worked out on copies: the estimators are locked only while settings are copied
/// or exchanged, so that poses do not wait for it.
class SettingsRequests {
public:
  explicit SettingsRequests(process::Guarded<BeaconEstimators>& estimators) : estimators_(estimators) {}

  /// Checks a request and applies it completely or, if the reply refuses it, not at all. A repeated request
  /// gets the reply to the first one.
  SettingsReply answer(const SettingsRequest& request);

private:
  void carry_out(const SettingsRequest& request, SettingsReply& reply);

  process::Guarded<BeaconEstimators>& estimators_;
  std::deque<SettingsReply> replies_;  ///< the latest
};

}  // namespace sonopose::fusion
