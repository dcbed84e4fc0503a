#include "fusion/standby.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

namespace standby_test {

using namespace sonopose;
using namespace sonopose::fusion;

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs stall_ns = 100 * ms;

/// Poses of beacon 7 every 10 ms.
struct Feed {
  Standby standby{{.strength = 100, .warm_up_s = 1.0}, stall_ns};
  SteadyTime now{1'000'000'000'000};
  TimeNs late_ns = 0;

  /// Feeds `count` poses and returns the last step.
  Standby::Step poses(int count, std::uint32_t status = 0) {
    Standby::Step step;
    for (int i = 0; i < count; ++i) {
      now += 10 * ms;
      step = standby.on_pose(7, status, late_ns, now);
    }
    return step;
  }

  std::vector<BeaconAddress> stalled() {
    std::vector<BeaconAddress> found;
    standby.find_stalled(now, found);
    std::sort(found.begin(), found.end());
    return found;
  }
};

SCENARIO("a beacon is claimed when its pose has been good for the warm-up") {
  Feed feed;
  CHECK(feed.standby.role(7) == FusionRole::warming);
  WHEN("it is good from the start") {
    CHECK(feed.poses(100).role == FusionRole::warming);  // 0.99 s
    THEN("it is claimed a warm-up later, and nothing is to be given up") {
      const auto step = feed.poses(1);
      CHECK(step.role == FusionRole::serving);
      CHECK_FALSE(step.release);
    }
  }
  WHEN("it is bad for half a second first, and once in between") {
    feed.poses(50, status_initialising);
    feed.poses(90);
    feed.poses(1, status_converging);
    THEN("the warm-up counts from the last bad one on") {
      CHECK(feed.poses(100).role == FusionRole::warming);
      CHECK(feed.poses(1).role == FusionRole::serving);
    }
  }
  WHEN("it never gets good") {
    THEN("it is claimed after six warm-ups anyway: the others have no better pose") {
      CHECK(feed.poses(600, status_initialising).role == FusionRole::warming);
      CHECK(feed.poses(2, status_initialising).role == FusionRole::serving);
    }
  }
  WHEN("its samples lag behind when it is warm") {
    feed.poses(100);
    feed.late_ns += stall_ns / 2;
    THEN("it is claimed as soon as they have caught up") {
      CHECK(feed.poses(50).role == FusionRole::warming);
      feed.late_ns -= stall_ns / 2;
      CHECK(feed.poses(1).role == FusionRole::serving);
    }
  }
  WHEN("it turns bad after it was claimed") {
    feed.poses(101);
    THEN("it stays claimed") {
      CHECK(feed.poses(50, status_converging | status_stale).role == FusionRole::serving);
    }
  }
}

SCENARIO("a beacon without further poses is released, and no other one") {
  Feed feed;
  for (int i = 0; i < 101; ++i) {
    feed.poses(1);
    feed.standby.on_pose(8, 0, 0, feed.now);
  }
  CHECK(feed.standby.next_stall() == feed.now + stall_ns + 1);
  GIVEN("a silence of beacon 7") {
    feed.standby.on_pose(8, 0, 0, feed.now + stall_ns / 2);
    feed.now += stall_ns + 1;
    THEN("it is listed twice, in case a pose was being written, and then no more") {
      CHECK(feed.stalled() == std::vector<BeaconAddress>{7});
      CHECK(feed.stalled() == std::vector<BeaconAddress>{7});
      CHECK(feed.stalled().empty());
      CHECK(feed.standby.role(7) == FusionRole::stalled);
      CHECK(feed.standby.role(8) == FusionRole::serving);
    }
    WHEN("poses come again, as fresh as ever") {
      feed.stalled();
      const auto step = feed.poses(1, status_imu_gap);
      THEN("it is claimed with the first good one") {
        CHECK(step.role == FusionRole::warming);
        CHECK_FALSE(step.release);  // already released
        CHECK(feed.poses(1).role == FusionRole::serving);
        CHECK(feed.stalled().empty());
      }
    }
    WHEN("poses come again, of samples that are older than they used to be") {
      feed.stalled();
      feed.late_ns += stall_ns;
      feed.poses(1);
      feed.late_ns -= stall_ns;
      THEN("the process was suspended and warms up again") {
        CHECK(feed.poses(99).role == FusionRole::warming);
        CHECK(feed.poses(1).role == FusionRole::serving);
      }
    }
  }
  GIVEN("a process that was stopped as a whole, so that poses come before the silence was noticed") {
    feed.now += 5 * stall_ns;
    feed.late_ns += 5 * stall_ns;
    const auto step = feed.poses(1);
    feed.late_ns -= 5 * stall_ns;
    THEN("the claim is taken back before that pose is written, and once more for one on its way") {
      CHECK(step.role == FusionRole::warming);
      CHECK(step.release);
      CHECK(step.skip);
      CHECK_FALSE(feed.poses(1).release);
      CHECK(feed.stalled() == std::vector<BeaconAddress>{7, 8});
      CHECK(feed.poses(50).role == FusionRole::warming);
    }
  }
}

SCENARIO("what has gathered while a process was stopped is skipped") {
  Feed feed;
  feed.poses(101);
  const auto skips = [&feed](TimeNs late_ns) { return feed.standby.on_pose(7, 0, late_ns, feed.now).skip; };
  // Takes the samples of a stop's backlog; returns the number of skipped poses.
  const auto skipped_of = [&](TimeNs samples, TimeNs taken_every_ns) {
    feed.now += samples * 10 * ms;
    int skipped = 0;
    for (TimeNs i = 0; i < samples; ++i) {
      feed.now += taken_every_ns;
      if (skips((samples - i) * 10 * ms + i * taken_every_ns)) ++skipped;
    }
    return skipped;
  };
  GIVEN("the 30 samples of a stop of 300 ms, taken within 10 ms") {
    const int skipped = skipped_of(30, ms / 3);
    THEN("the poses of all are skipped") {
      CHECK(skipped == 30);
    }
    THEN("later poses are written, even if their samples are delayed on their way") {
      feed.now += 30 * ms;
      CHECK_FALSE(skips(stall_ns / 2));
    }
  }
  GIVEN("the 60 samples of a stop of 600 ms, taken within 60 ms by a busy machine") {
    const int skipped = skipped_of(60, ms);
    THEN("the poses of all are skipped") {
      CHECK(skipped == 60);
    }
  }
  GIVEN("a clock of the bridge that is set back by 2 s, after a silence of 250 ms") {
    feed.now += 250 * ms;
    const auto skips_next = [&](int i) {
      feed.now += 10 * ms;
      return skips(2000 * ms + (i % 2) * ms);
    };
    THEN("its poses are soon written, because no process can write better ones") {
      for (int i = 0; i < 3; ++i) skips_next(i);
      for (int i = 3; i < 100; ++i) CHECK_FALSE(skips_next(i));
    }
  }
  GIVEN("a serving process whose samples begin to be late") {
    feed.late_ns = 2 * stall_ns;
    THEN("its poses are written") {
      CHECK_FALSE(feed.poses(10).skip);
    }
  }
}

SCENARIO("a process that steps down takes every claim back, with the beacon's next pose") {
  Feed feed;
  feed.poses(101);
  feed.standby.step_down();
  const auto step = feed.poses(1);
  CHECK(step.role == FusionRole::warming);
  CHECK(step.release);
  CHECK(feed.poses(1000).role == FusionRole::warming);
}

}  // namespace standby_test
