#include "fusion/bridge_backlog.hpp"

#include <catch2/catch.hpp>

#include <limits>

namespace bridge_backlog_test {

using namespace sonopose;
using namespace sonopose::fusion;

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs s = 1'000 * ms;

/// Samples every 10 ms that leave the bridge 5 ms later; the beacon's clock is an hour behind.
struct Feed {
  BridgeBacklog backlog{250 * ms};
  TimeNs sensor_ns = 0;
  SteadyTime now{7 * s};
  TimeNs bridge_clock_ns = 3'600 * s + 5 * ms - now.ns;

  /// Feeds the next sample, which leaves `after_ns` after the previous one. Returns true if it is behind.
  bool sample(TimeNs after_ns = 10 * ms) {
    sensor_ns += 10 * ms;
    now += after_ns;
    return backlog.on_sample(now.ns + bridge_clock_ns - sensor_ns, now);
  }

  /// Feeds samples and counts those that are behind.
  int behind_of(int samples, TimeNs after_ns = 10 * ms) {
    int count = 0;
    for (int i = 0; i < samples; ++i) count += sample(after_ns) ? 1 : 0;
    return count;
  }
};

SCENARIO("what a bridge sends after a stop is behind while it is more than 0.25 s older than usual") {
  Feed feed;
  REQUIRE(feed.behind_of(500) == 0);
  WHEN("the bridge was stopped for a second and sends the hundred samples at once") {
    REQUIRE(feed.sample(1 * s));  // 0.99 s older than usual
    THEN("those that are more than 0.25 s older than usual are behind") {
      CHECK(feed.behind_of(99, 0) == 73);  // 0.98 s … 0.26 s
      CHECK(feed.behind_of(500) == 0);
    }
  }
  WHEN("it is stopped twice, and the second time in its backlog") {
    REQUIRE(feed.sample(1 * s));
    REQUIRE(feed.behind_of(20, 0) == 20);
    REQUIRE(feed.sample(2 * s));
    THEN("the samples before the first stop remain the measure") {
      CHECK(feed.behind_of(300, 0) == 252);  // 2.77 s … 0.26 s
      CHECK(feed.behind_of(500) == 0);
    }
  }
  WHEN("it was stopped for a minute, and its backlog takes seconds") {
    REQUIRE(feed.sample(60 * s));
    THEN("all of it is behind") {
      CHECK(feed.behind_of(5'900, ms / 2) == 5'900);
    }
  }
  WHEN("it pauses for 0.2 s") {
    THEN("nothing is behind") {
      CHECK_FALSE(feed.sample(200 * ms));
      CHECK(feed.behind_of(100, 0) == 0);
    }
  }
  WHEN("the samples of a second are lost") {
    feed.sensor_ns += 1 * s;
    THEN("nothing is behind") {
      CHECK_FALSE(feed.sample(1010 * ms));
      CHECK(feed.behind_of(100) == 0);
    }
  }
  WHEN("a recording pauses for a second") {
    THEN("its samples are behind for 0.1 s") {
      REQUIRE(feed.sample(1 * s));
      CHECK(feed.behind_of(500) == 10);
    }
  }
  WHEN("the clock of the bridge steps forth by a minute, and soon back by half of it") {
    feed.bridge_clock_ns += 60 * s;
    REQUIRE(feed.sample());
    THEN("the samples are behind for 0.1 s, and after the step back as long") {
      CHECK(feed.behind_of(3) == 3);
      feed.bridge_clock_ns -= 30 * s;
      CHECK(feed.behind_of(4'000) == 11);
    }
  }
  WHEN("a recording is played at a fifth of its speed") {
    THEN("nothing is behind") {
      CHECK(feed.behind_of(1000, 50 * ms) == 0);
    }
  }
  WHEN("a stamp makes a sample seem too old") {
    feed.backlog.on_sample(std::numeric_limits<TimeNs>::max(), feed.now);
    THEN("what follows is judged as before") {
      CHECK(feed.behind_of(500) == 0);
      CHECK(feed.sample(1 * s));
    }
  }
  WHEN("a stamp makes a sample seem too young") {
    feed.backlog.on_sample(std::numeric_limits<TimeNs>::min(), feed.now);
    THEN("what follows is behind for 0.1 s") {
      CHECK(feed.behind_of(500) <= 11);
    }
  }
}

}  // namespace bridge_backlog_test
