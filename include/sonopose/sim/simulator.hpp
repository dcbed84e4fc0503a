#pragma once
/// \file
/// One simulated beacon: the events that a bridge would get from it, in the order in which it would get them,
/// and the truth behind them. Computation alone: the caller decides how fast the time goes.

#include <sonopose/core/samples.hpp>
#include <sonopose/sim/sensors.hpp>
#include <sonopose/sim/trajectory.hpp>

#include <deque>
#include <limits>
#include <optional>

namespace sonopose::sim {

/// Which run of a scenario. The same values give the same bits.
struct Run {
  std::uint64_t seed = 1;
  TimeNs start_time_ns = 0;   ///< stamp of the first IMU sample
  BeaconAddress address = 7;  ///< also a part of the seed: two beacons have their own noise
  double duration_s = std::numeric_limits<double>::infinity();  ///< the last IMU sample comes before this
};

/// One event, as it becomes available.
struct Step {
  Event event;
  std::optional<TruthSample> truth;  ///< with each IMU sample: the state of the tracked point at its time
};

/// Yields a beacon's IMU samples at their own time, and fixes and headings at their receipt; at equal times
/// IMU, fix, heading. Event sequence numbers run from 1. A fix that is received after the last IMU sample's
/// time does not come.
class Simulator {
public:
  /// Throws std::invalid_argument where the settings make no sense.
  Simulator(const Scenario& scenario, const SensorSettings& settings, const Run& run);

  /// The next event, or nothing after the run's duration.
  std::optional<Step> next();

private:
  [[nodiscard]] TimeNs time_of_sample(std::uint64_t index, double rate_hz, double phase) const;
  [[nodiscard]] Motion motion_at(TimeNs time_ns) const;
  void emit_until(TimeNs time_ns);
  void emit_one();
  Step take_imu_sample(TimeNs time_ns);

  Scenario scenario_;
  SensorSettings settings_;
  Run run_;
  ImuModel imu_;
  UltrasonicModel ultrasonic_;
  double fix_phase_;
  std::uint64_t imu_count_ = 0;
  std::uint64_t emission_count_ = 0;
  std::uint64_t sequence_ = 0;
  std::deque<Event> under_way_;  ///< emitted, not yet received; in order of receipt
};

}  // namespace sonopose::sim
