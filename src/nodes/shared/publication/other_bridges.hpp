#pragma once
/// \file
/// Detects other bridges that publish the same beacons: two bridges mix up a beacon's event numbers.

#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/samples/samples.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <set>

namespace sonopose::publication {

/// Knows which other bridges publish the beacons of this one, by their statuses.
class OtherBridges {
public:
  OtherBridges(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos);

  /// Starts watching a beacon of this bridge. Statuses of unwatched beacons are not received.
  void watch(BeaconAddress address) { watched_.set(address, true); }
  /// Stops watching a beacon, and forgets its other bridges.
  void forget(BeaconAddress address) {
    watched_.set(address, false);
    writers_.erase(address);
  }

  /// Reads the statuses received since the last call and logs each new bridge once. `own`: this bridge's
  /// status writer.
  void update(dds::core::InstanceHandle own);

  /// Number of other live bridges that publish this beacon.
  [[nodiscard]] std::uint32_t count(BeaconAddress address) const;

private:
  /// Filter set by one thread, read by those that receive.
  class Watched final : public dds::topics::AddressFilter {
  public:
    void set(BeaconAddress address, bool watched) { flags_[address] = watched; }
    bool accepts(BeaconAddress address) noexcept override { return flags_[address]; }

  private:
    std::array<std::atomic<bool>, std::size_t{std::numeric_limits<BeaconAddress>::max()} + 1> flags_{};
  };

  void add(BeaconAddress address, dds::core::InstanceHandle writer);
  void remove_gone();

  Watched watched_;
  dds::sub::DataReader<sonopose_BeaconStatus> reader_;
  std::map<BeaconAddress, std::set<std::uint64_t>> writers_;  ///< publication handles
};

}  // namespace sonopose::publication
