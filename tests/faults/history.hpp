#pragma once
/// \file
/// Data that a consumer received during a run, and the faults that were injected meanwhile.

#include "faults/plan.hpp"
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/status.hpp>

#include <cstdint>
#include <vector>

namespace sonopose::faults {

/// Identifies a process by its DDS participant; a restarted process has a new id.
using ProcessId = std::uint64_t;

/// A pose received by the consumer.
struct Arrival {
  SteadyTime received;
  TimeNs received_host_ns = 0;
  ProcessId process = 0;
  std::uint64_t writer = 0;
  std::int32_t strength = 0;  ///< strength of the writer
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;
  TimeNs time_ns = 0;
  TimeNs bridge_time_ns = 0;  ///< bridge time of the IMU sample; identifies it together with the address
  std::uint32_t status = 0;
  std::uint32_t reset_counter = 0;
};

/// An IMU sample published by the bridge, as received by the consumer.
struct Published {
  SteadyTime received;
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;
  TimeNs bridge_time_ns = 0;
};

struct FusionReport {
  SteadyTime received;
  ProcessId process = 0;
  FusionStatus status;
};

/// Notice to the consumer that a writer of poses is no longer alive.
struct LivelinessLoss {
  SteadyTime at;
  std::uint64_t writer = 0;
};

struct Interval {
  SteadyTime from;
  SteadyTime until = SteadyTime::max();
};

/// A step of the plan as played. It ends with the fault, or when the restarted process is ready.
struct Episode {
  Step step;
  Interval interval;
};

/// Lifetime of a process of the plan.
struct Life {
  Role role = Role::bridge;
  Interval interval;
};

struct History {
  Plan plan;
  std::vector<BeaconAddress> beacons;  ///< beacons that were fed
  SteadyTime end;
  TimeNs imu_period_ns = 0;
  std::vector<Arrival> poses;  ///< in order of arrival, since the start of the faults
  std::vector<Published> imu;  ///< in order of arrival, from one second earlier
  std::vector<FusionReport> statuses;
  std::vector<LivelinessLoss> losses;
  std::vector<Episode> episodes;
  std::vector<Life> lives;
  std::vector<Interval> stalls;         ///< intervals in which the machine did not run this program
  std::uint64_t consumer_lost = 0;      ///< poses reported as lost by the consumer's reader
  std::uint64_t consumer_rejected = 0;  ///< poses reported as rejected
};

}  // namespace sonopose::faults
