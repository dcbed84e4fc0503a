#include "publication/other_bridges.hpp"

#include "logging/later.hpp"
#include "logging/log.hpp"

#include <fmt/format.h>

namespace sonopose::publication {

OtherBridges::OtherBridges(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos)
    : reader_(dds::topics::make_reader(participant, qos, dds::topics::beacon_status, nullptr,
                                       dds::topics::Delivery::live, &watched_)) {}

void OtherBridges::update(dds::core::InstanceHandle own) {
  dds::ext::try_take_each(reader_,
                          [&](const sonopose_BeaconStatus& status, const dds::sub::SampleInfo& info) {
                            const bool is_other = info.publication_handle() != own;
                            if (is_other && watched_.accepts(status.address))
                              add(status.address, info.publication_handle());
                          });
  remove_gone();
}

void OtherBridges::add(BeaconAddress address, dds::core::InstanceHandle writer) {
  if (!writers_[address].insert(writer.c_value()).second) return;
  logging::later([address] {
    logging::warning(fmt::format(
        "another bridge publishes beacon {} too: its poses will be wrong until one of them is stopped",
        address));
  });
}

void OtherBridges::remove_gone() {
  std::set<std::uint64_t> living;
  for (const auto handle : dds::ext::matched_publications(reader_)) living.insert(handle.c_value());
  for (auto& entry : writers_) {
    std::erase_if(entry.second, [&living](std::uint64_t handle) { return !living.contains(handle); });
  }
}

std::uint32_t OtherBridges::count(BeaconAddress address) const {
  const auto found = writers_.find(address);
  return found == writers_.end() ? 0 : static_cast<std::uint32_t>(found->second.size());
}

}  // namespace sonopose::publication
