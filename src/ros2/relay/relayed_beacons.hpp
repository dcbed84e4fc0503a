#pragma once
/// \file
/// The publishers of each beacon: made after its first sample, and removed when it is gone.

#include "process/heard.hpp"
#include "process/stop_signal.hpp"
#include "ros2/relay/beacon_publishers.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace sonopose::ros2::relay {

/// Thread-safe: Cyclone's receive threads find publishers, the main thread adds and removes them.
class RelayedBeacons {
public:
  /// Shared, so that publishers can be in use while they are removed.
  using Publishers = std::shared_ptr<BeaconPublishers>;

  /// `wakeup`: of the main thread; must outlive this object.
  explicit RelayedBeacons(process::Wakeup& wakeup) : wakeup_(wakeup) {}

  /// The publishers for a sample of a beacon. Null if they do not exist yet: then the main thread is woken.
  Publishers find_or_request(BeaconAddress address, SteadyTime now);

  /// Null if there are none.
  Publishers find(BeaconAddress address);

  /// Those that exist.
  std::map<BeaconAddress, Publishers> all();

  /// The beacons whose publishers were requested and not added. Main thread only.
  std::vector<BeaconAddress> requested();
  void add(BeaconAddress address, Publishers publishers);

  /// Forgets the beacons that are gone at `now` (see process::Heard) and returns them. Main thread only.
  std::vector<BeaconAddress> remove_gone(SteadyTime now);

  /// The removed publishers that no thread uses any more. Main thread only, which destroys them.
  std::vector<Publishers> take_unused();

private:
  struct Beacon {
    Publishers publishers;  ///< null: to be created
    process::Heard heard;
  };

  process::Wakeup& wakeup_;
  std::vector<Publishers> removed_;  ///< main thread only
  std::mutex mutex_;                 ///< guards the members below
  std::map<BeaconAddress, Beacon> beacons_;
  bool has_requests_ = false;
};

}  // namespace sonopose::ros2::relay
