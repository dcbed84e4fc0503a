#pragma once
/// \file
/// Accepts the poses of one fusion alone.

#include <sonopose/dds/topics/topics.hpp>

#include <array>
#include <cstdint>
#include <map>
#include <optional>

namespace sonopose::dds::topics {

/// Tells a fusion's poses from those of other processes, by the `fusion_id` in its statuses. The process that
/// first shows this id is the one; a second process that shows it later is not. DDS delivers the poses of the
/// strongest writer alone, so a stronger stranger leaves a consumer without poses instead of with false ones.
/// An id is new at each start of a fusion, and no proof: a stranger who shows it first is taken for the
/// fusion. Only DDS Security proves who writes. `sonopose-monitor --json` prints the ids. Not thread-safe.
class PinnedFusion {
public:
  /// `participant` is that of the reader of poses. Throws core::Exception.
  PinnedFusion(const domain::DomainParticipant& participant, const qos::Provider& qos,
               std::uint64_t fusion_id);

  /// Returns true if the fusion wrote this sample of `poses`, also if it has ended since. Returns false
  /// before the first status with its id, and for a sample of an unknown writer that has gone. Throws
  /// core::Exception.
  [[nodiscard]] bool wrote(const sub::DataReader<sonopose_FusedPose>& poses, const sub::SampleInfo& info);

private:
  using Participant = std::array<std::uint8_t, 16>;

  void find_fusion();

  std::uint64_t fusion_id_;
  sub::DataReader<sonopose_FusionStatus> statuses_;
  std::optional<Participant> fusion_;
  std::map<std::uint64_t, bool> writers_;  ///< by handle: true for those of the fusion
};

}  // namespace sonopose::dds::topics
