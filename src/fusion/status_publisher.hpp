#pragma once
/// \file
/// Publishes a fusion's status and estimates of each beacon, and logs what it could not deliver.

#include "fusion/input_monitor.hpp"
#include "process/endpoint_counters.hpp"
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/status.hpp>

#include <cstdint>

namespace sonopose::fusion {

/// `endpoints` are the counters of all endpoints of the process.
class StatusPublisher {
public:
  StatusPublisher(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
                  process::EndpointCounters& endpoints);

  /// Adds what the process knows to `status` and writes it. `unwritten`: poses and reports that could not be
  /// written since the start. Returns false if the status could not be written.
  [[nodiscard]] bool publish(FusionStatus status, const InputCounters& inputs,
                             std::uint64_t unwritten) noexcept;
  [[nodiscard]] bool publish(Estimate estimate) noexcept;

  /// Logs the poses and reports that could not be written, and the incompatible endpoints, since the last
  /// call.
  void log_losses(std::uint64_t unwritten);

  /// Unregisters a beacon, so that consumers learn immediately that its status ends.
  void unregister(BeaconAddress address) noexcept;

private:
  std::uint64_t fusion_id_;
  process::EndpointCounters& endpoints_;
  process::CountingWriterListener<sonopose_FusionStatus> status_listener_;
  dds::DataWriter<sonopose_FusionStatus> status_writer_;
  dds::DataWriter<sonopose_Estimate> estimate_writer_;
  std::uint64_t unwritten_reported_ = 0;
  std::uint64_t incompatible_reported_ = 0;
};

}  // namespace sonopose::fusion
