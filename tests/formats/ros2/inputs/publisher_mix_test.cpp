/// Publishers of one topic that send at the same time.

#include "ros2/inputs/publisher_mix.hpp"

#include <catch2/catch.hpp>

namespace publisher_mix_test {

using namespace sonopose;

SCENARIO("publishers that take turns are told from a driver that was started again") {
  ros2::PublisherMix mix;
  bool is_mixed = false;
  TimeNs now_ns = 1'000'000'000;
  const auto send = [&](std::uint64_t publisher) {
    is_mixed = mix.on(publisher, SteadyTime{now_ns += 10'000'000}) || is_mixed;
  };
  GIVEN("a driver that is started again every second") {
    for (std::uint64_t i = 0; i < 2000; ++i) send(1 + i / 100);
    THEN("nothing mixes") {
      CHECK_FALSE(is_mixed);
    }
  }
  GIVEN("a recording that is played beside the driver") {
    for (std::uint64_t i = 0; i < 10; ++i) send(1 + i % 2);
    THEN("they mix") {
      CHECK(is_mixed);
    }
  }
  GIVEN("two drivers, of which one takes over from the other every ten seconds") {
    for (std::uint64_t i = 0; i < 20'000; ++i) send(1 + i / 1000 % 2);
    THEN("nothing mixes") {
      CHECK_FALSE(is_mixed);
    }
  }
  GIVEN("publishers that are not known, as in a recording") {
    for (int i = 0; i < 10; ++i) send(0);
    THEN("nothing is said of them") {
      CHECK_FALSE(is_mixed);
    }
  }
}

}  // namespace publisher_mix_test
