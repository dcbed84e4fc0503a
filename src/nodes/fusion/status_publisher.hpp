#pragma once
/// \file
/// Publishes a fusion's status and estimates of each beacon, and logs problems for the user.

#include "fusion/beacon_estimators.hpp"
#include "fusion/gap_detector.hpp"
#include "fusion/overload.hpp"
#include "fusion/pose_publisher.hpp"
#include "logging/increase_log.hpp"
#include "process/endpoint_counters.hpp"
#include "threads/guarded.hpp"
#include "transitions/transition_log.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <cstdint>
#include <map>

namespace sonopose::fusion {

/// Publishes on one thread. `endpoints`: counters of all endpoints of the process; `log`: used by this
/// thread.
class StatusPublisher {
public:
  StatusPublisher(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos,
                  threads::Guarded<BeaconEstimators>& estimators, const PosePublisher& pose_publisher,
                  const Overload& overload, process::EndpointCounters& endpoints,
                  transitions::TransitionLog& log);

  /// Publishes status and estimate of every beacon, and logs losses and refusals since the last call.
  /// `unwritten`: samples of other topics that could not be written since the start.
  void publish_all(std::uint64_t unwritten);

  /// Publishes the status of one beacon.
  void publish_status(BeaconAddress address, std::uint64_t unwritten);

  /// Logs lossless beacons that wait for a lost event. `waited_for_consumer`: no events were taken for a part
  /// of the time since the last call.
  void log_gaps(bool waited_for_consumer);

  /// Logs late poses, and samples that could not be written, including `unwritten` of other parts; `is_last`:
  /// the process ends.
  void log_losses(std::uint64_t unwritten, bool is_last);

  /// Unregisters a beacon, so that consumers learn immediately that its status ends.
  void unregister(BeaconAddress address) noexcept;

private:
  [[nodiscard]] auto read(BeaconAddress address, const auto& read_from) const;
  void publish_estimate(BeaconAddress address);
  void log_input_use(BeaconAddress address);
  void log_overload();

  std::uint64_t fusion_id_;
  threads::Guarded<BeaconEstimators>& estimators_;
  const PosePublisher& pose_publisher_;
  const Overload& overload_;
  process::EndpointCounters& endpoints_;
  transitions::TransitionLog& log_;
  process::CountingWriterListener<sonopose_FusionStatus> status_listener_;
  dds::pub::DataWriter<sonopose_FusionStatus> status_writer_;
  dds::pub::DataWriter<sonopose_Estimate> estimate_writer_;
  GapDetector gaps_;
  std::uint64_t unwritten_ = 0;  ///< unwritten statuses and estimates
  logging::IncreaseLog unwritten_log_;
  logging::IncreaseLog incompatible_log_;
  std::map<BeaconAddress, logging::IncreaseLog> late_logs_;
  bool overload_reported_ = false;
};

}  // namespace sonopose::fusion
