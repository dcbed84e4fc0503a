#pragma once
/// \file
/// One simulated beacon: events in the order in which a bridge would receive them, and the ground truth. It
/// only computes; the caller controls the pace.

#include "sim/scenario.hpp"
#include <sonopose/samples/samples.hpp>

#include <deque>
#include <limits>
#include <optional>
#include <vector>

namespace sonopose::sim {

/// Choice of a run of a scenario. Equal values give equal bits.
struct Run {
  std::uint64_t seed = 1;
  TimeNs start_time_ns = 1'700'000'000'000'000'000;  ///< stamp of the first IMU sample
  BeaconAddress address = 7;  ///< also part of the seed, so that the noise of beacons differs
  double duration_s = std::numeric_limits<double>::infinity();  ///< limit that all IMU samples precede
};

/// The scenario of this run, with its variation drawn. Drawing again changes nothing.
Scenario drawn(const Scenario& scenario, const Run& run);

/// One event, as it becomes available.
struct Step {
  Event event;
  /// True state of the tracked point at the time of an IMU sample, once per sample; empty if it was
  /// overtaken.
  std::optional<TruthSample> truth;
};

/// Yields a beacon's IMU samples at their own time, and all others at their receipt; at equal times IMU, fix,
/// heading, velocity. Event sequence numbers count from 1 in order of arrival: lost packets have none, and
/// each copy has its own. A late IMU sample follows the sample measured at its arrival. Fixes received after
/// the last IMU sample are dropped.
class Simulator {
public:
  /// Uses the scenario's motion and disturbances, as drawn for this run, with its own sensors or the given
  /// ones. Throws std::invalid_argument for invalid settings.
  Simulator(const Scenario& scenario, const Run& run);
  Simulator(const Scenario& scenario, const SensorSettings& sensors, const Run& run);

  /// Next event; empty after the run's duration.
  std::optional<Step> next();

  /// True state in this run, including turns and relocations.
  [[nodiscard]] Motion motion_at(TimeNs time_ns) const;

private:
  /// An IMU sample in transit.
  struct LateImu {
    TimeNs arrival_ns = 0;
    ImuSample sample;
  };

  [[nodiscard]] TimeNs time_of_sample(std::uint64_t index, double rate_hz, double phase) const;
  [[nodiscard]] double since_start_s(TimeNs time_ns) const;
  Step arrived(Event event);
  void take_imu_sample(TimeNs time_ns);
  void deliver(const ImuSample& sample, int copies);
  void emit_until(TimeNs time_ns);
  void emit_one();
  void measure_wheels();
  UltrasonicFix measure_fix(const Motion& motion, double time_s);
  void receive(const Event& event);

  Scenario scenario_;
  SensorSettings sensors_;
  Run run_;
  ImuModel imu_;
  UltrasonicModel ultrasonic_;
  PacketChannel imu_packets_;
  PacketChannel position_packets_;
  WheelModel wheels_;
  Random poor_fixes_;
  Random fix_faults_;
  Random imu_faults_;
  double fix_phase_;
  double start_yaw_rad_;
  std::uint64_t imu_count_ = 0;
  std::uint64_t emission_count_ = 0;
  std::uint64_t wheel_count_ = 0;
  std::uint64_t sequence_ = 0;
  Vector3d last_position_world_m_ = Vector3d::Zero();  ///< position of the last fix
  std::vector<LateImu> late_imu_;
  std::deque<Step> arrived_imu_;  ///< arrived, not yet returned
  std::deque<Event> under_way_;   ///< emitted, not yet received; in order of receipt
};

/// A whole run.
struct Recording {
  std::vector<Event> events;       ///< in order of arrival
  std::vector<TruthSample> truth;  ///< in order of time, one per IMU sample that was not overtaken
};

/// Runs a scenario with its own sensors to the end of the run or, if this is unlimited, of the scenario.
Recording record(const Scenario& scenario, const Run& run);

}  // namespace sonopose::sim
