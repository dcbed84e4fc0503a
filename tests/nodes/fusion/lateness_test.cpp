#include "fusion/lateness.hpp"

#include <catch2/catch.hpp>

namespace lateness_test {

using namespace sonopose;
using namespace sonopose::fusion;

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs s = 1'000 * ms;

/// Samples every 10 ms from a bridge whose clock is 3 s ahead.
struct Feed {
  Lateness lateness;
  SteadyTime now{1'000 * s};
  TimeNs offset_ns = -3 * s;

  TimeNs sample(TimeNs delay_ns) {
    now += 10 * ms;
    return lateness.on_sample(offset_ns + delay_ns, now);
  }

  /// Feeds samples for this time and returns the lateness of the last one.
  TimeNs samples_for(TimeNs duration_ns) {
    TimeNs late_ns = 0;
    for (const SteadyTime end = now + duration_ns; now < end;) late_ns = sample(1 * ms);
    return late_ns;
  }
};

SCENARIO("a sample is late by what it took longer than the fastest recent one") {
  Feed feed;
  CHECK(feed.samples_for(10 * s) == 0);
  WHEN("a sample takes 40 ms longer") {
    THEN("it is late by that, and the next is not") {
      CHECK(feed.sample(41 * ms) == 40 * ms);
      CHECK(feed.sample(1 * ms) == 0);
    }
  }
  WHEN("the process is stopped for a minute and finds old samples") {
    feed.now += 60 * s;
    THEN("they are late, though the window has passed") {
      CHECK(feed.sample(60 * s) == 60 * s - 1 * ms);
      CHECK(feed.sample(2 * s) == 2 * s - 1 * ms);
      CHECK(feed.sample(1 * ms) == 0);
    }
  }
  WHEN("a clock steps forth and back by a second") {
    feed.offset_ns += 1 * s;
    CHECK(feed.sample(1 * ms) == 1 * s);
    THEN("samples are late for at most two windows, and after the step back not at all") {
      CHECK(feed.samples_for(4 * s + 20 * ms) == 0);
      feed.offset_ns -= 1 * s;
      CHECK(feed.sample(1 * ms) == 0);
      CHECK(feed.samples_for(5 * s) == 0);
    }
  }
  WHEN("a stamp is absurd") {
    feed.lateness.on_sample(std::numeric_limits<TimeNs>::min(), feed.now);
    THEN("the lateness is limited") {
      CHECK(feed.lateness.on_sample(std::numeric_limits<TimeNs>::max(), feed.now) ==
            std::numeric_limits<TimeNs>::max());
    }
  }
}

}  // namespace lateness_test
