#pragma once
/// \file
/// The publishers of each beacon: made after its first sample, and kept while it is gone if it may return.

#include "process/heard.hpp"
#include "process/stop_signal.hpp"
#include "ros2/relay/beacon_publishers.hpp"

#include <cstddef>
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

  /// `wakeup`: of the main thread; must outlive this object. `max_beacons`: that have publishers, present or
  /// gone.
  RelayedBeacons(process::Wakeup& wakeup, std::size_t max_beacons)
      : wakeup_(wakeup), max_beacons_(max_beacons) {}

  /// The publishers for a sample of a beacon. Null if they do not exist yet: then the main thread is woken.
  Publishers find_or_request(BeaconAddress address, SteadyTime now);

  /// Null if there are none.
  Publishers find(BeaconAddress address);

  /// Those that exist.
  std::map<BeaconAddress, Publishers> all();

  /// The beacons whose publishers were requested and not added. Main thread only.
  std::vector<BeaconAddress> requested();
  void add(BeaconAddress address, Publishers publishers);

  /// The publishers that were kept for a beacon which now returns. Null if there are none. Main thread only.
  Publishers take_kept(BeaconAddress address);

  struct Gone {
    BeaconAddress address = 0;
    bool kept = false;  ///< whether its publishers remain for its return
  };
  /// Forgets the beacons that are gone at `now` (see process::Heard) and returns them. The publishers of the
  /// established ones are kept: other processes would have to discover new ones, and Cyclone DDS 0.10 never
  /// frees all memory of an endpoint that it has discovered. Main thread only.
  std::vector<Gone> remove_gone(SteadyTime now);

  /// Gives up the publishers of those that have been gone longest while more than `max_beacons` beacons have
  /// some, and returns the addresses. Main thread only.
  std::vector<BeaconAddress> remove_surplus();

  /// The removed publishers that no thread uses any more. Main thread only, which destroys them.
  std::vector<Publishers> take_unused();

private:
  struct Beacon {
    Publishers publishers;  ///< null: to be created
    process::Heard heard;
  };
  struct Kept {
    BeaconAddress address = 0;
    Publishers publishers;
  };

  process::Wakeup& wakeup_;
  std::size_t max_beacons_;
  std::vector<Kept> kept_;           ///< the one that has been gone longest first; main thread only
  std::vector<Publishers> removed_;  ///< main thread only
  std::mutex mutex_;                 ///< guards the members below
  std::map<BeaconAddress, Beacon> beacons_;
  bool has_requests_ = false;
};

}  // namespace sonopose::ros2::relay
