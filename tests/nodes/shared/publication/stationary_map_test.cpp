#include "publication/stationary_map.hpp"

#include <catch2/catch.hpp>

#include <utility>

namespace stationary_map_test {

using namespace sonopose;
using sonopose::publication::StationaryMap;

StationaryBeacon beacon_at(BeaconAddress address, std::optional<Vector3d> position_world_m) {
  StationaryBeacon beacon;
  beacon.address = address;
  beacon.position_world_m = std::move(position_world_m);
  return beacon;
}

SCENARIO("only changes of the map are published") {
  GIVEN("a map with beacon 2 at (1, 2, 3) m") {
    StationaryMap map;
    REQUIRE(map.update(beacon_at(2, Vector3d(1, 2, 3))));
    WHEN("the hardware repeats it") {
      THEN("nothing has changed") {
        CHECK_FALSE(map.update(beacon_at(2, Vector3d(1, 2, 3))));
      }
    }
    WHEN("it moves by a millimetre") {
      THEN("that is a change, once") {
        CHECK(map.update(beacon_at(2, Vector3d(1, 2, 3.001))));
        CHECK_FALSE(map.update(beacon_at(2, Vector3d(1, 2, 3.001))));
        CHECK(map.update(beacon_at(2, Vector3d(1, 2, 3.002))));
      }
    }
    WHEN("its position is not known any more") {
      THEN("that is a change, once, and so is its return") {
        CHECK(map.update(beacon_at(2, std::nullopt)));
        CHECK_FALSE(map.update(beacon_at(2, std::nullopt)));
        CHECK(map.update(beacon_at(2, Vector3d(1, 2, 3))));
      }
    }
    WHEN("another beacon is at the same place") {
      THEN("it is new") {
        CHECK(map.update(beacon_at(3, Vector3d(1, 2, 3))));
        CHECK(map.beacons().size() == 2);
      }
    }
  }
}

}  // namespace stationary_map_test
