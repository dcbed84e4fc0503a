/// One bridge with several beacons: each is tracked independently.

#include "support/bus.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>

namespace many_beacons_test {

using namespace sonopose;
using namespace sonopose::test;

using Tracks = std::map<BeaconAddress, std::vector<FusedPose>>;

Tracks tracks_of(const std::vector<FusedPose>& poses) {
  Tracks tracks;
  for (const FusedPose& pose : poses) tracks[pose.address].push_back(pose);
  return tracks;
}

SCENARIO("a bridge with five beacons") {
  GIVEN("five simulated beacons with addresses from 20, at 100 Hz each") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, dds::topics::pose);
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({"--beacons", "5", "--address", "20"});
    WHEN("they have run for a second") {
      REQUIRE(poses.wait_until([&] {
        const Tracks tracks = tracks_of(poses.samples);
        return tracks.size() == 5 && std::all_of(tracks.begin(), tracks.end(), [](const auto& track) {
                 return track.second.size() >= 100;
               });
      }));
      const Tracks tracks = tracks_of(poses.samples);
      THEN("each has a pose at every IMU sample, one period apart") {
        BeaconAddress address = 20;
        for (const auto& [tracked, track] : tracks) {
          CHECK(tracked == address++);
          for (std::size_t i = 1; i < track.size(); ++i) {
            REQUIRE(std::abs(track[i].time_ns - track[i - 1].time_ns - 10'000'000) <= 1);
          }
        }
      }
    }
  }
}

}  // namespace many_beacons_test
