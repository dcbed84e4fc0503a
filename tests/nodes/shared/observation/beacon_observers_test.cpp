#include "observation/beacon_observers.hpp"

#include <catch2/catch.hpp>

namespace sonopose::beacon_observers_test {

using namespace sonopose::observation;

constexpr TimeNs deadline_ns = 20'000'000;

FusedPose pose_of(BeaconAddress address) {
  FusedPose pose;
  pose.address = address;
  return pose;
}

SCENARIO("a beacon from which nothing comes is removed after a minute, one that was hardly heard after 5 s") {
  constexpr TimeNs second_ns = 1'000'000'000;
  BeaconObservers observers(deadline_ns);
  const dds::core::InstanceHandle writer{1};
  for (int i = 0; i < 200; ++i) observers.on(pose_of(7), 0, writer);
  observers.on(pose_of(8), 0, writer);
  const SteadyTime now = clocks::steady_now();
  CHECK(observers.remove_gone(now + 4 * second_ns, 0).empty());
  const auto hardly_heard = observers.remove_gone(now + 59 * second_ns, 0);
  REQUIRE(hardly_heard.size() == 1);
  CHECK(hardly_heard[0].address == 8);
  const auto gone = observers.remove_gone(now + 61 * second_ns, 0);
  REQUIRE(gone.size() == 1);
  CHECK(gone[0].address == 7);
  CHECK(gone[0].poses == 200);
  CHECK(observers.take_windows(0).empty());
  CHECK_FALSE(observers.served().pose_writer_of(7));
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
  observers.on(pose_of(7), 0, dds::core::InstanceHandle(1));
  const auto changes = observers.silence_changes();
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].address == 7);
  CHECK(changes[0].silent);
  CHECK(observers.silence_changes().empty());
}

}  // namespace sonopose::beacon_observers_test
