#include "bridge/address_owners.hpp"

#include <catch2/catch.hpp>

namespace address_owners_test {

using namespace sonopose;
using bridge::AddressOwners;
using transport::Sender;

SCENARIO("the address of a beacon belongs to one sender") {
  constexpr std::uint8_t beacon = 7;
  const Sender modem{.address = {10}, .port = 49100};
  const Sender other{.address = {10}, .port = 40000};
  const SteadyTime start{1'000'000'000};
  GIVEN("a modem that sends a beacon") {
    AddressOwners owners;
    REQUIRE(owners.accepts(beacon, modem, start));
    WHEN("another sender uses the same address") {
      THEN("it is refused, as long as the modem sends") {
        for (int second = 1; second < 60; ++second) {
          const SteadyTime now = start + to_ns(second);
          CHECK_FALSE(owners.accepts(beacon, other, now));
          CHECK(owners.accepts(beacon, modem, now));
        }
      }
    }
    WHEN("another sender uses another address") {
      THEN("it is accepted") {
        CHECK(owners.accepts(8, other, start));
      }
    }
    WHEN(
        "it sends the map of the stationary beacons every ten seconds, and another sender a map of its own") {
      THEN("that is refused meanwhile, and accepted when the modem has been silent for long enough") {
        REQUIRE(owners.accepts({}, modem, start));
        for (int second = 1; second < 60; ++second) {
          const SteadyTime now = start + to_ns(second);
          CHECK(owners.accepts(beacon, modem, now));
          CHECK(owners.accepts(8, other, now));
          CHECK_FALSE(owners.accepts({}, other, now));
          if (second % 10 == 0) CHECK(owners.accepts({}, modem, now));
        }
        CHECK(owners.accepts({}, other, start + to_ns(59) + AddressOwners::release_ns));
      }
    }
    WHEN("the modem restarts with another port") {
      const SteadyTime restarted = start + AddressOwners::release_ns;
      THEN("it is accepted when the former one has been silent for long enough") {
        CHECK_FALSE(owners.accepts(beacon, other, restarted - 1));
        CHECK(owners.accepts(beacon, other, restarted));
        CHECK_FALSE(owners.accepts(beacon, modem, restarted));
      }
    }
  }
}

}  // namespace address_owners_test
