#pragma once
/// \file
/// Writes the results of the estimators: poses, and the report of each fix.

#include "fusion/beacon_estimator.hpp"
#include "fusion/overload.hpp"
#include "fusion/pose_output.hpp"
#include "process/endpoint_counters.hpp"
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <atomic>
#include <cstdint>
#include <optional>

namespace sonopose::fusion {

/// Writes poses and reports. Use it from one thread at a time, except where noted. During an overload it
/// writes only the newest pose of a beacon.
class OutcomeWriter {
public:
  /// All arguments must outlive it. Once `stopping` is set, it no longer waits for consumers.
  OutcomeWriter(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
                dds::topics::Delivery delivery, PoseOutput& output, Overload& overload,
                process::EndpointCounters& endpoints, const std::atomic<bool>& stopping);

  /// `in_ns`: host time at which the fusion took the sample.
  void write(EventOutcome& outcome, BeaconAddress address, TimeNs in_ns) noexcept;

  /// Writes the pose that was held back in case a newer one followed.
  void write_newest() noexcept;

  /// Unregisters this beacon's reports, so that readers learn that they end. From any thread.
  void unregister(BeaconAddress address) noexcept;

  /// Number of samples that DDS did not accept. From any thread.
  [[nodiscard]] std::uint64_t unwritten() const { return unwritten_; }

  /// True if it has waited for a consumer since the last call. From any thread.
  bool take_waited() { return waited_.exchange(false); }

private:
  void write(FusedPose& pose) noexcept;
  void write_until_accepted(const auto& attempt) noexcept;

  bool lossless_;
  PoseOutput& output_;
  Overload& overload_;
  const std::atomic<bool>& stopping_;
  std::optional<FusedPose> newest_;  // during an overload, held back in case a newer one follows
  std::atomic<std::uint64_t> unwritten_ = 0;
  std::atomic<bool> waited_ = false;
  process::CountingWriterListener<sonopose_FixReport> report_listener_;
  dds::DataWriter<sonopose_FixReport> report_writer_;
};

}  // namespace sonopose::fusion
