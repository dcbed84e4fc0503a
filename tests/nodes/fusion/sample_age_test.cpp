#include "fusion/sample_age.hpp"

#include <catch2/catch.hpp>

#include <limits>

namespace sample_age_test {

using namespace sonopose;
using namespace sonopose::fusion;

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs s = 1'000 * ms;

/// Samples every 10 ms that leave the bridge 5 ms later and arrive immediately. `beacon_behind_ns` is the
/// difference of the host's clock and that of the stamps.
struct Feed {
  explicit Feed(TimeNs beacon_behind_ns) : sensor_ns(1'000'000 * s - beacon_behind_ns - 5 * ms) {}

  SampleAge age{250 * ms};
  std::uint64_t sequence = 0;
  TimeNs sensor_ns;
  SteadyTime now{7 * s};
  TimeNs bridge_clock_ns = 1'000'000 * s - now.ns;  ///< minus the steady clock
  TimeNs host_clock_ns = bridge_clock_ns;           ///< minus the steady clock
  TimeNs under_way_ns = 0;                          ///< from the bridge to the pose

  SampleAge::Judgement judge_sample(TimeNs after_ns = 10 * ms) {
    sensor_ns += 10 * ms;
    now += after_ns;
    return age.on_sample({.sequence = ++sequence,
                          .sensor_ns = sensor_ns,
                          .bridge_ns = now.ns - under_way_ns + bridge_clock_ns,
                          .host_ns = now.ns + host_clock_ns,
                          .now = now});
  }

  /// Feeds the next sample, which is judged `after_ns` after the previous one. Returns true if it is old.
  bool sample(TimeNs after_ns = 10 * ms) { return judge_sample(after_ns).is_old; }

  /// Feeds samples and counts the old ones.
  int old_of(int samples, TimeNs after_ns = 10 * ms) {
    int count = 0;
    for (int i = 0; i < samples; ++i) count += sample(after_ns) ? 1 : 0;
    return count;
  }
};

SCENARIO("what a bridge sends after a stop is old while it is more than 0.25 s late") {
  // Stamps of the host's clock, and of a clock that is an hour behind.
  const bool agree = GENERATE(true, false);
  Feed feed(agree ? 0 : 3'600 * s);
  feed.old_of(500);
  REQUIRE(feed.old_of(500) == 0);
  WHEN("the bridge was stopped for a second and sends the hundred samples at once") {
    REQUIRE(feed.sample(1 * s));  // 0.99 s older than usual
    THEN("those that are more than 0.25 s late are old") {
      const int old = feed.old_of(99, 0);  // 0.98 s … 0.26 s, or to 0.25 s and the usual 5 ms
      CHECK(old >= 73);
      CHECK(old <= 74);
      CHECK(feed.old_of(500) == 0);
    }
  }
  WHEN("it is stopped twice, and the second time in its backlog") {
    REQUIRE(feed.sample(1 * s));
    REQUIRE(feed.old_of(20, 0) == 20);
    REQUIRE(feed.sample(2 * s));
    THEN("the samples before the first stop remain the measure") {
      const int old = feed.old_of(300, 0);  // 2.77 s … 0.26 s
      CHECK(old >= 252);
      CHECK(old <= 253);
      CHECK(feed.old_of(500) == 0);
    }
  }
  WHEN("it was stopped for a minute, and its backlog takes seconds") {
    REQUIRE(feed.sample(60 * s));
    THEN("all of it is old") {
      CHECK(feed.old_of(5'900, ms / 2) == 5'900);
    }
  }
  WHEN("it was stopped for two seconds, and a busy machine delays the second sample of its backlog") {
    REQUIRE(feed.sample(2 * s));
    REQUIRE(feed.sample(115 * ms));
    THEN("the rest is old until it is less than 0.25 s late") {
      CHECK(feed.old_of(180, 0) == 180);
      feed.old_of(30, 0);
      CHECK(feed.old_of(500) == 0);
    }
  }
  WHEN("it pauses for 0.2 s") {
    THEN("nothing is old") {
      CHECK_FALSE(feed.sample(200 * ms));
      CHECK(feed.old_of(100, 0) == 0);
    }
  }
  WHEN("the samples of a second are lost") {
    feed.sensor_ns += 1 * s;
    THEN("nothing is old") {
      CHECK_FALSE(feed.sample(1010 * ms));
      CHECK(feed.old_of(100) == 0);
    }
  }
  WHEN("stamps make samples seem too old and too young") {
    constexpr TimeNs least = std::numeric_limits<TimeNs>::min();
    constexpr TimeNs greatest = std::numeric_limits<TimeNs>::max();
    feed.age.on_sample({feed.sequence, greatest, least, least, feed.now});
    feed.age.on_sample({feed.sequence, least, -1, -1, feed.now});
    THEN("soon the next ones are judged as before") {
      feed.old_of(500);
      CHECK(feed.old_of(500) == 0);
      CHECK(feed.sample(1 * s));
    }
  }
}

SCENARIO("samples that an overload delays remain old, however long it lasts") {
  GIVEN("a beacon whose stamps are of the host's clock") {
    Feed feed(0);
    REQUIRE(feed.old_of(500) == 0);
    WHEN("the fusion takes 0.4 s for each for a minute") {
      feed.under_way_ns = 400 * ms;
      feed.now += 400 * ms;
      const int old = feed.old_of(6'000);
      const TimeNs late_ns = feed.judge_sample().late_ns;
      THEN("all are old, and arrive late until the end") {
        CHECK(old == 6'000);
        CHECK(late_ns >= 350 * ms);
        AND_WHEN("the overload ends") {
          feed.under_way_ns = 0;
          feed.now += -400 * ms;
          THEN("nothing is old any more") {
            CHECK(feed.old_of(500) == 0);
          }
        }
      }
    }
  }
}

SCENARIO("a new fusion recognises the backlog of a stopped bridge") {
  GIVEN("a fusion that starts while the bridge has been stopped for 17 s") {
    Feed feed(0);
    feed.now += 17 * s;
    WHEN("the bridge continues") {
      const int old = feed.old_of(1'600, ms / 2);
      THEN("its backlog is old, and what follows is not") {
        CHECK(old == 1'600);
        feed.old_of(180, 0);
        CHECK(feed.old_of(500) == 0);
      }
    }
    WHEN("the bridge is stopped again in its backlog") {
      REQUIRE(feed.sample());
      REQUIRE(feed.sample(5 * s));
      THEN("its backlog is old") {
        CHECK(feed.old_of(2'100, ms / 2) == 2'100);
      }
    }
  }
}

SCENARIO("a difference of clocks makes samples old for a few seconds at most") {
  GIVEN("a beacon whose stamps are of the host's clock") {
    Feed feed(0);
    REQUIRE(feed.old_of(500) == 0);
    WHEN("the clock of the bridge is set back") {
      feed.bridge_clock_ns -= 20 * s;
      feed.sensor_ns -= 20 * s;
      feed.old_of(401);
      THEN("after four seconds nothing is old, until the bridge is stopped") {
        CHECK(feed.old_of(1'000) == 0);
        CHECK(feed.sample(1 * s));
      }
    }
    WHEN("the clock of the bridge is advanced") {
      feed.bridge_clock_ns += 20 * s;
      feed.sensor_ns += 20 * s;
      THEN("nothing is old, until the bridge is stopped") {
        CHECK(feed.old_of(1'000) == 0);
        CHECK(feed.sample(1 * s));
      }
    }
    WHEN("the clock of the fusion is set") {
      feed.host_clock_ns += GENERATE(-20, 20) * s;
      THEN("nothing is old, until the bridge is stopped") {
        CHECK(feed.old_of(1'000) == 0);
        CHECK(feed.sample(1 * s));
      }
    }
    WHEN("a bridge with another clock replaces this one") {
      feed.sequence = 0;
      feed.bridge_clock_ns -= 1 * s;
      feed.sensor_ns += 2 * s;  // it took three seconds
      feed.now += 3 * s;
      feed.old_of(401);
      THEN("after four seconds nothing is old") {
        CHECK(feed.old_of(1'000) == 0);
      }
    }
  }
  GIVEN("a recording of last year") {
    Feed feed(365 * 86'400 * s);
    THEN("nothing is old, also at a fifth of its speed") {
      CHECK(feed.old_of(500) == 0);
      CHECK(feed.old_of(1'000, 50 * ms) == 0);
      AND_WHEN("it pauses for a second") {
        feed.now += 1 * s;
        THEN("its samples are old for a second") {
          const int old = feed.old_of(500);
          CHECK(old >= 100);
          CHECK(old <= 102);
        }
      }
    }
  }
}

}  // namespace sample_age_test
