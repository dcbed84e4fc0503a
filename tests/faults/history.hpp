#pragma once
/// \file
/// What a consumer received during a run, and what was done to the processes meanwhile.

#include "faults/plan.hpp"
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/status.hpp>

#include <cstdint>
#include <vector>

namespace sonopose::faults {

/// A process on the bus, by its participant: after a restart it is another one.
using ProcessId = std::uint64_t;

/// A pose as the consumer received it.
struct Arrival {
  SteadyTime received;
  TimeNs received_host_ns = 0;
  ProcessId process = 0;
  std::uint64_t writer = 0;
  std::int32_t strength = 0;  ///< of the writer
  BeaconAddress address = 0;
  std::uint64_t sequence = 0;
  TimeNs time_ns = 0;
  TimeNs bridge_time_ns = 0;  ///< of its IMU sample: with the address it names the sample
  std::uint32_t status = 0;
  std::uint32_t reset_counter = 0;
};

/// An IMU sample that the bridge published, as the consumer received it.
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

/// The consumer learned that a writer of poses is no longer alive.
struct LivelinessLoss {
  SteadyTime at;
  std::uint64_t writer = 0;
};

struct Interval {
  SteadyTime from;
  SteadyTime until = SteadyTime::max();
};

/// A step of the plan as it was played, until its end or until the restarted process is ready.
struct Episode {
  Step step;
  Interval interval;
};

/// A process of the plan, from its start to its end.
struct Life {
  Role role = Role::bridge;
  Interval interval;
};

struct History {
  Plan plan;
  std::vector<BeaconAddress> beacons;  ///< that were fed
  SteadyTime end;
  TimeNs imu_period_ns = 0;
  std::vector<Arrival> poses;  ///< in order of arrival, since the start of the faults
  std::vector<Published> imu;  ///< the same, from a second earlier on
  std::vector<FusionReport> statuses;
  std::vector<LivelinessLoss> losses;
  std::vector<Episode> episodes;
  std::vector<Life> lives;
  std::vector<Interval> stalls;         ///< in which the machine did not run this program
  std::uint64_t consumer_lost = 0;      ///< poses that the consumer's reader reports as lost
  std::uint64_t consumer_rejected = 0;  ///< or rejected
};

}  // namespace sonopose::faults
