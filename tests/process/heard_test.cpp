#include "process/heard.hpp"

#include <catch2/catch.hpp>

namespace heard_test {

using namespace sonopose;

constexpr TimeNs second_ns = 1'000'000'000;

process::Heard heard_at(SteadyTime time, int samples) {
  process::Heard heard;
  for (int i = 0; i < samples; ++i) heard.on_sample(time);
  return heard;
}

SCENARIO("a beacon is gone after a minute, or after five seconds if it was hardly heard") {
  constexpr SteadyTime time{100 * second_ns};
  const process::Heard hardly = heard_at(time, 99);
  CHECK_FALSE(hardly.is_gone(time + 5 * second_ns));
  CHECK(hardly.is_gone(time + 5 * second_ns + 1));
  const process::Heard often = heard_at(time, 100);
  CHECK_FALSE(often.is_gone(time + 60 * second_ns));
  CHECK(often.is_gone(time + 60 * second_ns + 1));
}

}  // namespace heard_test
