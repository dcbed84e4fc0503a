#include "evaluation/score/baseline.hpp"

#include <catch2/catch.hpp>

namespace baseline_test {

using namespace sonopose;

UltrasonicFix fix_at(double time_s, double x_m) {
  UltrasonicFix fix;
  fix.emission_time_ns = to_ns(time_s);
  fix.position_world_m = {x_m, 0, 0};
  return fix;
}

TEST_CASE("the last fix stays constant, the extrapolated fix moves with its velocity") {
  evaluation::Baseline baseline;
  CHECK_FALSE(baseline.last_fix());
  CHECK_FALSE(baseline.extrapolated(to_ns(1.0)));
  baseline.on(fix_at(1.0, 4.0));
  CHECK(baseline.extrapolated(to_ns(1.3))->x() == 4.0);  // one fix has no velocity
  baseline.on(fix_at(1.1, 4.2));
  CHECK(baseline.last_fix()->x() == 4.2);
  CHECK(baseline.extrapolated(to_ns(1.15))->x() == Approx(4.3));
  baseline.on(fix_at(1.05, 9.0));  // measured before the latest fix
  CHECK(baseline.last_fix()->x() == 4.2);
}

TEST_CASE("fixes with a long gap between them are not extrapolated") {
  evaluation::Baseline baseline;
  baseline.on(fix_at(1.0, 4.0));
  baseline.on(fix_at(3.0, 9.0));
  CHECK(baseline.extrapolated(to_ns(3.1))->x() == 9.0);
}

}  // namespace baseline_test
