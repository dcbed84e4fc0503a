#include <sonopose/estimation/kalman/checkpoints.hpp>

#include <catch2/catch.hpp>

namespace kalman_checkpoints_test {

using namespace sonopose;
using namespace sonopose::estimation::kalman;

constexpr TimeNs epoch_ns = 1'700'000'000'000'000'000;

State state_at(double time_s) {
  State state;
  state.imu.time_ns = epoch_ns + to_ns(time_s);
  return state;
}

double time_s(const Checkpoint& checkpoint) {
  return seconds_between(epoch_ns, checkpoint.state.imu.time_ns);
}

SCENARIO("checkpoints reach back more than a second, and are dense only in the last tenths") {
  const double step_s = GENERATE(0.001, 0.005, 0.01, 0.013, 0.05, 0.1, 0.2);
  GIVEN("ten seconds of samples every " << step_s << " s") {
    Checkpoints checkpoints;
    double now_s = 0.0;
    for (int k = 0; k * step_s < 10.0; ++k) {
      now_s = k * step_s;
      const State state = state_at(now_s);
      if (checkpoints.is_due(state.imu.time_ns)) checkpoints.add(state, 0);
    }
    THEN("the oldest is older than any fix that may come, but not by much") {
      CHECK(now_s - time_s(checkpoints.oldest()) > 1.0);
      CHECK(now_s - time_s(checkpoints.oldest()) < 1.5 + step_s);
    }
    THEN("little has to be repeated for a recent fix, and at most a quarter of a second for an old one") {
      const double recent_s = now_s - 0.15;
      const double old_s = now_s - 0.9;
      Checkpoints other = checkpoints;
      CHECK(recent_s - time_s(checkpoints.rewind(epoch_ns + to_ns(recent_s))) < 0.08 + step_s);
      CHECK(old_s - time_s(other.rewind(epoch_ns + to_ns(old_s))) < 0.25 + step_s);
    }
    WHEN("it goes back, and the same samples follow again") {
      Checkpoints again = checkpoints;
      again.rewind(epoch_ns + to_ns(now_s - 0.5));
      const double from_s = time_s(again.latest());
      for (int k = 0; k * step_s < 10.0; ++k) {
        const State state = state_at(k * step_s);
        if (k * step_s > from_s && again.is_due(state.imu.time_ns)) again.add(state, 0);
      }
      THEN("the checkpoints are the same as before") {
        CHECK(time_s(again.oldest()) == time_s(checkpoints.oldest()));
        while (time_s(checkpoints.latest()) > time_s(checkpoints.oldest())) {
          REQUIRE(time_s(again.latest()) == time_s(checkpoints.latest()));
          const TimeNs before_ns = checkpoints.latest().state.imu.time_ns - 1;
          checkpoints.rewind(before_ns);
          again.rewind(before_ns);
        }
      }
    }
  }
}

}  // namespace kalman_checkpoints_test
