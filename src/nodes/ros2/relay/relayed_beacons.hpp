#pragma once
/// \file
/// Publishers of each beacon: created after its first sample, and kept while it is gone if it may return.

#include "presence/beacon_presence.hpp"
#include "process/stop_signal.hpp"
#include "ros2/relay/beacon_publishers.hpp"
#include "threads/mutex.hpp"

#include <cstddef>
#include <map>
#include <memory>
#include <vector>

namespace sonopose::ros2::relay {

/// Finds publishers on Cyclone's receive threads; the main thread adds and removes them. Thread-safe.
class RelayedBeacons {
public:
  /// Shared, so that publishers in use can be removed.
  using Publishers = std::shared_ptr<BeaconPublishers>;

  /// `wakeup`: wakes the main thread; must outlive this object. `max_beacons`: most beacons with publishers,
  /// present or gone.
  RelayedBeacons(process::Wakeup& wakeup, std::size_t max_beacons)
      : wakeup_(wakeup), max_beacons_(max_beacons) {}

  /// Publishers for a sample of a beacon. If there are none yet, returns null and wakes the main thread.
  Publishers find_or_request(BeaconAddress address, SteadyTime now);

  /// Publishers of a beacon; null if there are none.
  Publishers find(BeaconAddress address);

  /// All existing publishers.
  std::map<BeaconAddress, Publishers> all();

  /// Beacons whose publishers were requested and not added. Main thread only.
  std::vector<BeaconAddress> requested();
  void add(BeaconAddress address, Publishers publishers);

  /// Returns the publishers kept for a returning beacon; null if there are none. Main thread only.
  Publishers take_kept(BeaconAddress address);

  struct Gone {
    BeaconAddress address = 0;
    bool kept = false;  ///< publishers remain for its return
  };
  /// Forgets the beacons that are gone at `now` (presence::BeaconPresence) and returns them. Keeps the
  /// publishers of established beacons: other processes would have to discover new ones, and Cyclone DDS 0.10
  /// never frees all memory of a discovered endpoint. Main thread only.
  std::vector<Gone> remove_gone(SteadyTime now);

  /// Removes publishers of the longest gone beacons while more than `max_beacons` have some. Returns the
  /// addresses. Main thread only.
  std::vector<BeaconAddress> remove_surplus();

  /// Removed publishers that no thread uses any more. The main thread calls this and destroys them.
  std::vector<Publishers> take_unused();

private:
  struct Beacon {
    Publishers publishers;  ///< null: to be created
    presence::BeaconPresence presence;
  };
  struct Kept {
    BeaconAddress address = 0;
    Publishers publishers;
  };

  process::Wakeup& wakeup_;
  std::size_t max_beacons_;
  std::vector<Kept> kept_;           ///< longest gone first; main thread only
  std::vector<Publishers> removed_;  ///< main thread only
  threads::Mutex mutex_;
  std::map<BeaconAddress, Beacon> beacons_ SONOPOSE_GUARDED_BY(mutex_);
  bool has_requests_ SONOPOSE_GUARDED_BY(mutex_) = false;
};

}  // namespace sonopose::ros2::relay
