#pragma once
// Notices that another bridge publishes a beacon of this one's: two of them spoil its event numbers.

#include <sonopose/samples/samples.hpp>
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <cstdint>
#include <map>
#include <set>

namespace sonopose::bridge {

class OtherBridges {
public:
  OtherBridges(const dds::DomainParticipant& participant, const dds::QosProvider& qos);

  /// Looks at what came since the last call; `own` writes this bridge's statuses. Tells the user of each
  /// other one once. `is_ours(address)` says which beacons matter.
  template <class IsOurs>
  void look(dds::InstanceHandle own, const IsOurs& is_ours) {
    reader_.try_take_each([&](const sonopose_BeaconStatus& status, const dds::SampleInfo& info) {
      if (info.publication_handle() != own && is_ours(status.address)) {
        note(status.address, info.publication_handle());
      }
    });
    forget_gone();
  }

  /// How many others live that publish this beacon.
  [[nodiscard]] std::uint32_t count(BeaconAddress address) const;

private:
  void note(BeaconAddress address, dds::InstanceHandle writer);
  void forget_gone();

  dds::DataReader<sonopose_BeaconStatus> reader_;
  std::map<BeaconAddress, std::set<std::uint64_t>> writers_;  ///< publication handles
};

}  // namespace sonopose::bridge
