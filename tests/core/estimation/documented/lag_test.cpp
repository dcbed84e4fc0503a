/// Gain of a first-order lag against the exponential function.

#include <sonopose/estimation/documented/lag.hpp>

#include <catch2/catch.hpp>

#include <cmath>

namespace lag_test {

using sonopose::estimation::documented::lag_share;

SCENARIO("a first-order lag follows a step by the exponential law") {
  GIVEN("times on both sides of the end of the series") {
    for (const double x : {1e-12, 1e-6, 1e-3, 0.02, 0.0999, 0.1, 0.5, 5.0, 50.0}) {
      THEN("the share is 1 - exp(-x)") {
        INFO("x " << x);
        CHECK(lag_share(x) == Approx(-std::expm1(-x)).epsilon(1e-15));
      }
    }
  }
  GIVEN("no time") {
    THEN("nothing is followed") {
      CHECK(lag_share(0.0) == 0.0);
    }
  }
}

}  // namespace lag_test
