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
std::optional<std::array<std::uint8_t, 16>> participant_of(const sub::DataReader<T>& reader,
                                                           core::InstanceHandle writer) {
  const auto data = ext::matched_publication_data(reader, writer);
  return data ? std::optional(bytes_of(data->participant_key)) : std::nullopt;
}

}  // namespace

PinnedFusion::PinnedFusion(const domain::DomainParticipant& participant, const qos::Provider& qos,
                           std::uint64_t fusion_id)
    : fusion_id_(fusion_id), statuses_(make_reader(participant, qos, fusion_status)) {}

bool PinnedFusion::wrote(const sub::DataReader<sonopose_FusedPose>& poses, const sub::SampleInfo& info) {
  find_fusion();
  if (!fusion_) return false;
  const auto known = writers_.find(info.publication_handle().c_value());
  if (known != writers_.end()) return known->second;
  const auto participant = participant_of(poses, info.publication_handle());
  if (!participant) return false;
  constexpr std::size_t max_writers = 1024;  // a stranger can make any number
  if (writers_.size() >= max_writers) writers_.clear();
  return writers_[info.publication_handle().c_value()] = participant == fusion_;
}

void PinnedFusion::find_fusion() {
  ext::take_each(statuses_, [this](const sonopose_FusionStatus& status, const sub::SampleInfo& info) {
    if (fusion_ || status.fusion_id != fusion_id_) return;
    fusion_ = participant_of(statuses_, info.publication_handle());
  });
}

}  // namespace sonopose::dds::topics
