#include "fusion/overload.hpp"

#include <catch2/catch.hpp>

namespace overload_test {

using namespace sonopose;
using namespace sonopose::fusion;

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs s = 1'000 * ms;

/// A fusion whose backlog thread is working.
struct Work {
  Overload overload;
  SteadyTime now{1'000 * s};
  TimeNs worked_ns = 0;

  void round() {
    overload.on_round(now, worked_ns);
    now += 5 * ms;
    worked_ns += 1 * ms;
  }
  /// Rounds of 5 ms that use a fifth of a core, write late poses and never catch up.
  void work_for(TimeNs duration_ns) {
    for (const SteadyTime end = now + duration_ns; now < end;) {
      overload.on_pose(21 * ms, now);
      round();
    }
  }
  /// Rounds that each empty the queue.
  void keep_up_for(TimeNs duration_ns) {
    for (const SteadyTime end = now + duration_ns; now < end;) {
      round();
      overload.on_caught_up(now);
    }
  }
};

SCENARIO("events are deferred while samples are late") {
  GIVEN("a fusion") {
    Work work;
    REQUIRE_FALSE(work.overload.is_deferring());
    WHEN("samples are late by up to 20 ms") {
      work.overload.on_pose(20 * ms, work.now);
      THEN("the receiving thread goes on fusing") {
        CHECK_FALSE(work.overload.is_deferring());
      }
    }
    WHEN("one is later") {
      work.overload.on_pose(21 * ms, work.now);
      THEN("it stops, until no sample was late for a second and nothing is left") {
        CHECK(work.overload.is_deferring());
        work.keep_up_for(1 * s);
        CHECK(work.overload.is_deferring());
        work.keep_up_for(10 * ms);
        CHECK_FALSE(work.overload.is_deferring());
        CHECK_FALSE(work.overload.is_overloaded());
      }
    }
  }
}

SCENARIO("poses are spaced while the backlog does not end") {
  GIVEN("late samples") {
    Work work;
    work.overload.on_pose(30 * ms, work.now);
    WHEN("the backlog thread always catches up within 50 ms") {
      for (int i = 0; i < 20; ++i) {
        work.work_for(45 * ms);
        work.keep_up_for(5 * ms);
      }
      THEN("every pose is written") {
        CHECK_FALSE(work.overload.is_overloaded());
      }
    }
    WHEN("it is suspended for a second, and then catches up") {
      work.round();
      work.now += 1 * s;
      work.round();
      work.keep_up_for(5 * ms);
      THEN("every pose is written") {
        CHECK_FALSE(work.overload.is_overloaded());
      }
    }
    WHEN("it works without a pause, but no pose is late any more") {
      work.now += 30 * ms;
      for (int i = 0; i < 100; ++i) work.round();
      THEN("every pose is written") {
        CHECK_FALSE(work.overload.is_overloaded());
      }
    }
    WHEN("it does not for 50 ms") {
      work.work_for(60 * ms);
      THEN("each beacon has at most 25 poses in a second") {
        CHECK(work.overload.pose_spacing_ns() == 40 * ms);
      }
      AND_WHEN("it works on without a pause for a second") {
        work.work_for(1 * s);
        THEN("each beacon still has 16") {
          CHECK(work.overload.pose_spacing_ns() == 60 * ms);
        }
        AND_WHEN("it keeps up again") {
          work.keep_up_for(3 * s);
          THEN("every pose is written, and the receiving thread fuses") {
            CHECK_FALSE(work.overload.is_overloaded());
            CHECK_FALSE(work.overload.is_deferring());
          }
        }
        AND_WHEN("it keeps up for less than half a second") {
          work.keep_up_for(400 * ms);
          THEN("nothing changes yet") {
            CHECK(work.overload.pose_spacing_ns() == 60 * ms);
            CHECK(work.overload.is_deferring());
          }
        }
      }
    }
  }
}

}  // namespace overload_test
