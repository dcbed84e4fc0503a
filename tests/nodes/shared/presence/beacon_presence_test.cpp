#include "presence/beacon_presence.hpp"

#include <catch2/catch.hpp>

namespace heard_test {

using namespace sonopose;

constexpr TimeNs second_ns = 1'000'000'000;

presence::BeaconPresence heard_at(SteadyTime time, int samples) {
  presence::BeaconPresence heard;
  for (int i = 0; i < samples; ++i) heard.on_sample(time);
  return heard;
}

SCENARIO("a beacon is gone after a minute, or after five seconds if it was hardly heard") {
  constexpr SteadyTime time{100 * second_ns};
  const presence::BeaconPresence hardly = heard_at(time, 99);
  CHECK_FALSE(hardly.is_gone(time + 5 * second_ns));
  CHECK(hardly.is_gone(time + 5 * second_ns + 1));
  const presence::BeaconPresence often = heard_at(time, 100);
  CHECK_FALSE(often.is_gone(time + 60 * second_ns));
  CHECK(often.is_gone(time + 60 * second_ns + 1));
}

}  // namespace heard_test
