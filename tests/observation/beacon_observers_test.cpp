#include "observation/beacon_observers.hpp"

#include <catch2/catch.hpp>

namespace beacon_observers_test {

using namespace sonopose;
using namespace sonopose::observation;

constexpr TimeNs deadline_ns = 20'000'000;

FusedPose pose_of(BeaconAddress address) {
  FusedPose pose;
  pose.address = address;
  return pose;
}

SCENARIO("a beacon from which nothing comes is removed after a minute") {
  BeaconObservers observers(deadline_ns);
  const dds::InstanceHandle writer{1};
  observers.on(pose_of(7), 0, writer);
  observers.on(pose_of(7), 0, writer);
  const SteadyTime now = clocks::steady_now();
  CHECK(observers.remove_gone(now + process::beacon_gone_after_ns - 1'000'000'000).empty());
  const auto gone = observers.remove_gone(now + process::beacon_gone_after_ns + 1'000'000'000);
  REQUIRE(gone.size() == 1);
  CHECK(gone[0].address == 7);
  CHECK(gone[0].poses == 2);
  CHECK(observers.take_windows(0).empty());
  CHECK(observers.served().of(writer).empty());
}

SCENARIO("what ends for an unknown beacon makes no beacon") {
  BeaconObservers observers(deadline_ns);
  observers.on_deadline_missed(7, 1);
  observers.on_gone(dds::topics::to_idl(pose_of(7)));
  CHECK(observers.take_windows(0).empty());
}

SCENARIO("a pose stream that falls silent is reported once") {
  BeaconObservers observers(0);  // any time without a pose is a silence
  TruthSample truth;
  truth.address = 8;
  observers.on(truth);
  observers.on(pose_of(7), 0, dds::InstanceHandle{1});
  const auto changes = observers.silence_changes();
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].address == 7);
  CHECK(changes[0].silent);
  CHECK(observers.silence_changes().empty());
}

}  // namespace beacon_observers_test
