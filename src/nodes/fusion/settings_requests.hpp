#pragma once
/// \file
/// Carries out requests to change settings.

#include "fusion/beacon_estimators.hpp"
#include "threads/guarded.hpp"
#include <sonopose/samples/live_settings.hpp>

#include <deque>

namespace sonopose::fusion {

/// Carries out requests on copies, on one thread. Estimators are locked only to copy or exchange settings, so
/// that poses do not wait.
class SettingsRequests {
public:
  explicit SettingsRequests(threads::Guarded<BeaconEstimators>& estimators) : estimators_(estimators) {}

  /// Checks a request and applies all of it or, if the reply refuses it, nothing. A repeated request gets the
  /// first reply.
  SettingsReply answer(const SettingsRequest& request);

private:
  void carry_out(const SettingsRequest& request, SettingsReply& reply);

  threads::Guarded<BeaconEstimators>& estimators_;
  std::deque<SettingsReply> replies_;  ///< latest replies
};

}  // namespace sonopose::fusion
