#include "fusion/sample_age.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>

namespace sample_age_test {

using namespace sonopose;
using namespace sonopose::fusion;

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs s = 1'000 * ms;

/// Samples every 10 ms that leave the bridge 5 ms later and arrive immediately. `behind_ns` is what the clock
/// of the stamps is behind that of the bridge's host, whose clock is not that of the fusion's host.
struct Feed {
  explicit Feed(TimeNs behind_ns) : sensor_ns(now.ns + bridge_clock_ns - behind_ns - 5 * ms) {}

  SampleAge age{250 * ms};
  std::uint64_t sequence = 0;
  SteadyTime now{7 * s};
  TimeNs bridge_clock_ns = 1'000'000 * s;  ///< minus the steady clock
  TimeNs host_clock_ns = 0;                ///< the same of the clock of this host
  TimeNs sensor_ns;
  TimeNs under_way_ns = 0;  ///< from the bridge to here

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
  // Stamps of the bridge's host, and of a clock that is an hour behind.
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
    feed.age.on_sample({++feed.sequence, greatest, least, greatest, feed.now});
    feed.age.on_sample({++feed.sequence, least, greatest, least, feed.now});
    THEN("soon the next ones are judged as before") {
      feed.old_of(500);
      CHECK(feed.old_of(500) == 0);
      CHECK(feed.sample(1 * s));
    }
  }
}

SCENARIO("samples that an overload delays remain old, however long it lasts") {
  Feed feed(0);
  REQUIRE(feed.old_of(500) == 0);
  WHEN("the fusion takes 0.4 to 0.5 s for each for ten minutes") {
    feed.now += 400 * ms;
    int old = 0;
    TimeNs least_late_ns = 1 * s;
    for (int i = 0; i < 60'000; ++i) {
      feed.under_way_ns = (400 + i % 100) * ms;
      const auto judgement = feed.judge_sample();
      old += judgement.is_old ? 1 : 0;
      least_late_ns = std::min(least_late_ns, judgement.late_ns);
    }
    THEN("all are old and late") {
      CHECK(old == 60'000);
      CHECK(least_late_ns >= 390 * ms);
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

SCENARIO("a fusion that is busy from its start takes nothing old for new") {
  GIVEN("a bridge and a fusion of one host") {
    Feed feed(0);
    feed.host_clock_ns = feed.bridge_clock_ns;
    WHEN("the fusion takes 0.4 to 0.6 s for each of its first samples") {
      THEN("they are old, and later ones are not") {
        for (int i = 0; i < 1'000; ++i) {
          feed.under_way_ns = (400 + 50 * (i % 5)) * ms;
          REQUIRE(feed.sample());
        }
        feed.under_way_ns = 0;
        CHECK(feed.old_of(500) == 0);
      }
    }
    WHEN("it takes 0.2 s for each, which is not old") {
      feed.under_way_ns = 200 * ms;
      THEN("nothing is late either: nobody knows a shorter time") {
        const SampleAge::Judgement judged = feed.judge_sample();
        CHECK_FALSE(judged.is_old);
        CHECK(judged.late_ns == 0);
      }
    }
  }
  GIVEN("a bridge on a host whose clock is 2 s behind") {
    Feed feed(0);
    feed.host_clock_ns = feed.bridge_clock_ns + 2 * s;
    THEN("its samples are old for three seconds at most") {
      CHECK(feed.old_of(290) == 290);
      feed.old_of(11);
      CHECK(feed.old_of(1'000) == 0);
    }
    THEN("so they are if the network delays one a second") {
      int old = 0;
      for (int second = 0; second < 20; ++second) {
        feed.under_way_ns = 40 * ms;
        old += feed.old_of(1);
        feed.under_way_ns = 2 * ms;
        old += feed.old_of(99);
      }
      CHECK(old <= 401);
    }
  }
  GIVEN("a bridge on a host whose clock is 2 s ahead") {
    Feed feed(0);
    feed.host_clock_ns = feed.bridge_clock_ns - 2 * s;
    THEN("nothing is old") {
      CHECK(feed.old_of(1'000) == 0);
    }
  }
}

SCENARIO("a difference of clocks makes samples old for a few seconds at most") {
  GIVEN("a beacon whose stamps are of the bridge's host") {
    Feed feed(0);
    REQUIRE(feed.old_of(500) == 0);
    WHEN("the clock of the bridge's host is set") {
      const TimeNs step_ns = GENERATE(-20, 20) * s;
      feed.bridge_clock_ns += step_ns;
      feed.sensor_ns += step_ns;
      THEN("nothing is old, until the bridge is stopped") {
        CHECK(feed.old_of(1'000) == 0);
        CHECK(feed.sample(1 * s));
      }
    }
    WHEN("the clocks of the two hosts drift apart for an hour") {
      const TimeNs per_sample_ns = GENERATE(-5'000, 5'000);  // 500 ppm
      int late = 0;
      for (int i = 0; i < 360'000; ++i) {
        feed.bridge_clock_ns += per_sample_ns;
        feed.sensor_ns += per_sample_ns;
        late += feed.judge_sample().late_ns > 1 * ms ? 1 : 0;
      }
      THEN("nothing is late") {
        CHECK(late == 0);
        CHECK(feed.sample(1 * s));
      }
    }
    WHEN("the player of a recording pauses for a second") {
      feed.under_way_ns = 1 * s;
      feed.now += 1 * s;
      THEN("its samples are old for ten seconds") {
        CHECK(feed.old_of(1'001) == 1'001);
        CHECK(feed.old_of(500) == 0);
      }
    }
    WHEN("the clock of the stamps is set back") {
      feed.sensor_ns -= 1 * s;
      THEN("its samples are old for a minute") {
        CHECK(feed.old_of(6'001) == 6'001);
        CHECK(feed.old_of(500) == 0);
      }
    }
    WHEN("a bridge with another clock replaces this one") {
      feed.sequence = 0;
      feed.bridge_clock_ns -= 1 * s;
      feed.sensor_ns += 2 * s;  // it took three seconds
      feed.now += 3 * s;
      THEN("nothing is old") {
        CHECK(feed.old_of(1'000) == 0);
      }
    }
  }
  GIVEN("stamps of a clock that is an hour behind") {
    Feed feed(3'600 * s);
    THEN("the samples are old for three seconds") {
      CHECK(feed.old_of(301) == 301);
      CHECK(feed.old_of(1'000) == 0);
    }
    AND_WHEN("they are those of a recording that is played at twice its speed") {
      const int old = feed.old_of(4'000, 5 * ms);
      THEN("they are old for ten seconds") {
        CHECK(old == 2'001);
      }
    }
  }
  GIVEN("a recording of last year, played at a fifth of its speed") {
    Feed feed(TimeNs{365} * 86'400 * s);
    THEN("nothing is old") {
      CHECK(feed.old_of(1'000, 50 * ms) == 0);
    }
  }
}

}  // namespace sample_age_test
