#pragma once
/// \file
/// Detects velocities of a beacon that its engine does not use, and those that contradict the estimate.

#include <sonopose/samples/estimator_counters.hpp>
#include <sonopose/settings/settings.hpp>

#include <optional>
#include <string>

namespace sonopose::fusion {

/// Use of the velocities of one beacon, such as those of wheels. Call `update` about once a second.
class TwistUse {
public:
  /// Calls without a used velocity until the user is told: an engine uses none before the first fix.
  static constexpr int max_unused_updates = 10;

  /// Takes the present counters. Returns a message for the user when all velocities have been unused, and
  /// when most of those since the last call contradict the estimate or no longer do.
  std::optional<std::string> update(const EstimatorCounters& counted, const settings::Settings& settings);

private:
  EstimatorCounters before_;
  int unused_updates_ = 0;
  bool contradicts_ = false;
};

}  // namespace sonopose::fusion
