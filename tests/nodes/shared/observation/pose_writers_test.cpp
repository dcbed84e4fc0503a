#include "observation/pose_writers.hpp"

#include <catch2/catch.hpp>

namespace pose_writers_test {

using namespace sonopose;
using namespace sonopose::observation;
using Catch::Contains;

dds::Qos strength(std::int32_t value) {
  return dds::Qos() << dds::policy::OwnershipStrength{value};
}

/// Pose writer of a fusion that serves the beacons `served`.
PoseWriter fusion(const std::string& name, std::int32_t its_strength, std::set<BeaconAddress> served) {
  return {name, {name, "rover", 12}, strength(its_strength), true, std::move(served)};
}

SCENARIO("the pose writers of fusions are no problem while one consumer can tell them apart") {
  GIVEN("two standby fusions, each with a second writer of strength 0") {
    const std::vector writers{fusion("a", 200, {7}), fusion("a", 0, {7}), fusion("b", 100, {7}),
                              fusion("b", 0, {7})};
    THEN("there is no problem") {
      CHECK(problems_of(writers).empty());
    }
  }
  GIVEN("two fusions of one strength that share the beacons out") {
    THEN("there is no problem") {
      CHECK(problems_of({fusion("a", 100, {7, 8}), fusion("b", 100, {9})}).empty());
    }
  }
  GIVEN("two fusions of one strength in different partitions") {
    PoseWriter a = fusion("a", 100, {7});
    PoseWriter b = fusion("b", 100, {7});
    a.qos << dds::policy::Partition{{"east"}};
    b.qos << dds::policy::Partition{{"west"}};
    THEN("there is no problem") {
      CHECK(problems_of({a, b}).empty());
    }
  }
}

SCENARIO("two fusions of one strength for one beacon are a problem") {
  const auto problems = problems_of({fusion("a", 100, {7, 8}), fusion("b", 100, {8})});
  REQUIRE(problems.size() == 1);
  CHECK_FALSE(problems.front().foreign);
  CHECK_THAT(problems.front().what,
             Contains("a (process 12 on rover) and b (process 12 on rover) write poses of beacon 8"));
}

SCENARIO("a pose writer without fusion statuses is a problem, whatever its strength") {
  const std::int32_t its_strength = GENERATE(0, 1, 1000);
  PoseWriter intruder = fusion("intruder", its_strength, {});
  intruder.has_status = false;
  const auto problems = problems_of({fusion("a", 100, {7}), intruder});
  REQUIRE(problems.size() == 1);
  CHECK(problems.front().foreign);
  CHECK_THAT(problems.front().what, Contains("intruder (process 12 on rover) writes poses with strength " +
                                             std::to_string(its_strength)));
}

SCENARIO("a writer serves the beacons of its latest poses and of its serving statuses") {
  ServedBeacons served;
  const dds::InstanceHandle a{1};
  const dds::InstanceHandle b{2};
  FusedPose pose;
  pose.address = 7;
  served.on(pose, a);
  CHECK(served.of(a) == std::set<BeaconAddress>{7});
  served.on(pose, b);  // consumers now receive the other writer
  CHECK(served.of(a).empty());
  FusionStatus status;
  status.address = 8;
  status.role = FusionRole::serving;
  served.on(status, a);
  CHECK(served.of(a) == std::set<BeaconAddress>{8});
  status.role = FusionRole::stalled;
  served.on(status, a);
  CHECK(served.of(a).empty());
}

}  // namespace pose_writers_test
