#pragma once
/// \file
/// Detects other bridges that publish the same beacons: two bridges mix up the event numbers of a beacon.

#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <map>
#include <set>

namespace sonopose::bridge {

class OtherBridges {
public:
  OtherBridges(const dds::DomainParticipant& participant, const dds::qos::Provider& qos);

  /// Reads the statuses received since the last call and reports each new bridge once on standard error.
  /// `own` is this bridge's status writer; `is_ours(address)` selects the beacons that matter.
  template <class IsOurs>
  void update(dds::InstanceHandle own, const IsOurs& is_ours) {
    reader_.try_take_each([&](const sonopose_BeaconStatus& status, const dds::SampleInfo& info) {
      if (info.publication_handle() != own && is_ours(status.address)) {
        add(status.address, info.publication_handle());
      }
    });
    remove_gone();
  }

  /// How many other live bridges publish this beacon.
  [[nodiscard]] std::uint32_t count(BeaconAddress address) const;

private:
  void add(BeaconAddress address, dds::InstanceHandle writer);
  void remove_gone();

  dds::DataReader<sonopose_BeaconStatus> reader_;
  std::map<BeaconAddress, std::set<std::uint64_t>> writers_;  ///< publication handles
};

}  // namespace sonopose::bridge
