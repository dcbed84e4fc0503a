/// One bridge with several beacons: each is tracked independently.

#include "support/bus.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>

namespace sonopose::many_beacons_test {

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
    Consumer<sonopose_FusionStatus> statuses{bus, dds::topics::fusion_status, dds::topics::Delivery::live};
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
      THEN("each has a pose at every IMU sample, or the missing ones are counted") {
        BeaconAddress address = 20;
        for (const auto& [tracked, track] : tracks) {
          CHECK(tracked == address++);
          constexpr TimeNs period_ns = 10'000'000;
          TimeNs missing = 0;
          for (std::size_t i = 1; i < track.size(); ++i) {
            const TimeNs step_ns = track[i].time_ns - track[i - 1].time_ns;
            const TimeNs periods = (step_ns + period_ns / 2) / period_ns;
            REQUIRE(std::abs(step_ns - periods * period_ns) <= periods);
            missing += periods - 1;
          }
          const TimeNs ended_ns = track.back().fusion_out_time_ns;
          FusionStatus status;
          REQUIRE(statuses.wait_for([&, beacon = tracked](const FusionStatus& latest) {
            status = latest;
            return latest.address == beacon && latest.time_ns > ended_ns;
          }));
          CHECK(missing <= static_cast<TimeNs>(status.events_lost + status.poses_skipped));
        }
      }
    }
  }
}

}  // namespace sonopose::many_beacons_test
