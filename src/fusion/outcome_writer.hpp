#pragma once
/// \file
/// Writes what the estimators give: poses, and the report of each fix.

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

/// To be used by one thread at a time, except where it says otherwise. While the fusion is overloaded, it
/// writes only the newest pose of a beacon.
class OutcomeWriter {
public:
  /// Everything must outlive it. Once `stopping` is set, it no longer waits for consumers.
  OutcomeWriter(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
                dds::topics::Delivery delivery, PoseOutput& output, Overload& overload,
                process::EndpointCounters& endpoints, const std::atomic<bool>& stopping);

  /// `in_ns`: when the fusion took the sample, host time.
  void write(EventOutcome& outcome, BeaconAddress address, TimeNs in_ns) noexcept;

  /// Writes a pose that was not written yet, since a newer one might have followed.
  void write_newest() noexcept;

  /// Unregisters this beacon's reports, so that readers learn that they end. From any thread.
  void unregister(BeaconAddress address) noexcept;

  /// How many samples DDS did not accept. From any thread.
  [[nodiscard]] std::uint64_t unwritten() const { return unwritten_; }

  /// Whether it has waited for a consumer since the last call. From any thread.
  bool take_waited() { return waited_.exchange(false); }

private:
  void write(FusedPose& pose) noexcept;
  void write_until_accepted(const auto& attempt) noexcept;

  bool lossless_;
  PoseOutput& output_;
  Overload& overload_;
  const std::atomic<bool>& stopping_;
  std::optional<FusedPose> newest_;  // overloaded: not written yet, since a newer one may follow
  std::atomic<std::uint64_t> unwritten_ = 0;
  std::atomic<bool> waited_ = false;
  process::CountingWriterListener<sonopose_FixReport> report_listener_;
  dds::DataWriter<sonopose_FixReport> report_writer_;
};

}  // namespace sonopose::fusion
