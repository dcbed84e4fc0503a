#include "fusion/status_publisher.hpp"

#include "clocks/clocks.hpp"
#include "process/random_id.hpp"
#include <sonopose/dds/topics/conversions.hpp>

#include <fmt/format.h>

#include <cstdio>

namespace sonopose::fusion {

namespace topics = dds::topics;

StatusPublisher::StatusPublisher(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
                                 process::EndpointCounters& endpoints)
    : fusion_id_(process::random_id()),
      endpoints_(endpoints),
      status_listener_(endpoints),
      status_writer_(topics::make_writer(participant, qos, topics::fusion_status, &status_listener_)),
      estimate_writer_(topics::make_writer(participant, qos, topics::estimate)) {}

bool StatusPublisher::publish(FusionStatus status, const InputCounters& inputs,
                              std::uint64_t unwritten) noexcept {
  status.fusion_id = fusion_id_;
  status.time_ns = clocks::host_now();
  status.imu_deadlines_missed = inputs.imu_deadlines_missed;
  status.fix_deadlines_missed = inputs.fix_deadlines_missed;
  status.heading_deadlines_missed = inputs.heading_deadlines_missed;
  status.bridge_losses = inputs.bridge_losses;
  status.pose_deadlines_missed = endpoints_.offered_deadlines_missed;
  status.liveliness_lost = endpoints_.liveliness_lost;
  status.samples_lost = endpoints_.samples_lost;
  status.samples_rejected = endpoints_.samples_rejected;
  status.incompatible_qos = endpoints_.incompatible_qos;
  status.poses_unwritten = unwritten;
  return status_writer_.try_write(topics::to_idl(status)) >= 0;
}

bool StatusPublisher::publish(Estimate estimate) noexcept {
  estimate.fusion_id = fusion_id_;
  return estimate_writer_.try_write(topics::to_idl(estimate)) >= 0;
}

void StatusPublisher::log_losses(std::uint64_t unwritten) {
  if (unwritten != unwritten_reported_) {
    fmt::print(stderr, "sonopose-fusion: {} poses or reports could not be written: a consumer is too slow\n",
               unwritten - unwritten_reported_);
    unwritten_reported_ = unwritten;
  }
  const std::uint64_t incompatible = endpoints_.incompatible_qos;
  if (incompatible != incompatible_reported_) {
    fmt::print(
        stderr,
        "sonopose-fusion: {} readers or writers with incompatible QoS; run sonopose-doctor to list them\n",
        incompatible - incompatible_reported_);
    incompatible_reported_ = incompatible;
  }
}

void StatusPublisher::unregister(BeaconAddress address) noexcept {
  sonopose_FusionStatus status{};
  status.address = address;
  status.fusion_id = fusion_id_;
  status_writer_.try_unregister_instance(status);
  sonopose_Estimate estimate{};
  estimate.address = address;
  estimate.fusion_id = fusion_id_;
  estimate_writer_.try_unregister_instance(estimate);
}

}  // namespace sonopose::fusion
