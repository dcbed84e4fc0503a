#include "observation/unmatched_positions.hpp"

#include <catch2/catch.hpp>

namespace unmatched_positions_test {

using namespace sonopose;
using observation::UnmatchedPositions;

Vector3d at(TimeNs time_ns) {
  return {static_cast<double>(time_ns), 0.0, 0.0};
}

SCENARIO("a position waits for its partner") {
  UnmatchedPositions positions;
  CHECK_FALSE(positions.extract(1));
  for (TimeNs time_ns = 10; time_ns <= 50; time_ns += 10) positions.store(time_ns, at(time_ns));
  CHECK_FALSE(positions.extract(25));
  CHECK(positions.extract(30) == at(30));
  THEN("it is found once, and earlier ones are lost") {
    CHECK_FALSE(positions.extract(30));
    CHECK_FALSE(positions.extract(10));
    CHECK(positions.extract(40) == at(40));
    CHECK(positions.extract(50) == at(50));
    CHECK_FALSE(positions.extract(50));
  }
  WHEN("the clock steps back") {
    positions.store(5, at(5));
    THEN("only what is later than the step is found") {
      CHECK_FALSE(positions.extract(40));
      CHECK(positions.extract(5) == at(5));
    }
  }
}

SCENARIO("positions without partners are limited to the latest") {
  UnmatchedPositions positions;
  for (TimeNs time_ns = 1; time_ns <= 10'000; ++time_ns) positions.store(time_ns, at(time_ns));
  CHECK_FALSE(positions.extract(10'000 - 2048));
  CHECK(positions.extract(10'000 - 2047) == at(10'000 - 2047));
  CHECK(positions.extract(10'000) == at(10'000));
}

}  // namespace unmatched_positions_test
