#include <sonopose/dds/topics/pinned_fusion.hpp>

#include <algorithm>
#include <iterator>

namespace sonopose::dds::topics {
namespace {

std::array<std::uint8_t, 16> bytes_of(const dds_guid_t& guid) {
  std::array<std::uint8_t, 16> bytes{};
  std::copy(std::begin(guid.v), std::end(guid.v), bytes.begin());
  return bytes;
}

/// Returns the participant of a writer; nothing if the reader is no longer matched with it.
template <class T>
std::optional<std::array<std::uint8_t, 16>> participant_of(const DataReader<T>& reader,
                                                           InstanceHandle writer) {
  try {
    return bytes_of(reader.matched_publication_data(writer).participant_key);
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

PinnedFusion::PinnedFusion(const DomainParticipant& participant, const qos::Provider& qos,
                           std::uint64_t fusion_id)
    : fusion_id_(fusion_id), statuses_(make_reader(participant, qos, fusion_status)) {}

bool PinnedFusion::wrote(const DataReader<sonopose_FusedPose>& poses, const SampleInfo& info) {
  find_fusion();
  if (!fusion_) return false;
  const auto known = writers_.find(info.publication_handle().value);
  if (known != writers_.end()) return known->second;
  const auto participant = participant_of(poses, info.publication_handle());
  if (!participant) return false;
  constexpr std::size_t max_writers = 1024;  // a stranger can make any number
  if (writers_.size() >= max_writers) writers_.clear();
  return writers_[info.publication_handle().value] = participant == fusion_;
}

void PinnedFusion::find_fusion() {
  statuses_.take_each([this](const sonopose_FusionStatus& status, const SampleInfo& info) {
    if (fusion_ || status.fusion_id != fusion_id_) return;
    fusion_ = participant_of(statuses_, info.publication_handle());
  });
}

}  // namespace sonopose::dds::topics
