#include "bridge/pacer.hpp"

#include "bridge/collecting_sink.hpp"
#include "clocks/clocks.hpp"
#include "support/wait_until.hpp"

#include <catch2/catch.hpp>

#include <limits>
#include <stdexcept>
#include <thread>

namespace pacer_test {

using namespace sonopose;
using namespace sonopose::bridge;
using namespace sonopose::publication;
using namespace sonopose::process;
using sonopose::test::CollectingSink;

constexpr TimeNs begin_ns = 1'700'000'000'000'000'000;
constexpr TimeNs ms = 1'000'000;
constexpr TimeNs hour = 3'600'000 * ms;

SCENARIO("a pacer plays recorded time at its rate") {
  CollectingSink sink;
  const StopSignal stop;
  GIVEN("real time") {
    Pacer pacer(1.0);
    REQUIRE(pacer.wait_for(begin_ns, sink, stop));
    const SteadyTime began = clocks::steady_now();
    THEN("150 ms of the recording take 150 ms, counted from the first moment, however it is divided") {
      for (TimeNs passed_ns = 0; passed_ns <= 150 * ms; passed_ns += 50 * ms) {
        REQUIRE(pacer.wait_for(begin_ns + passed_ns, sink, stop));
      }
      CHECK(clocks::steady_now() - began >= 149 * ms);
    }
    THEN("after a restart an hour earlier, what follows by 50 ms takes 50 ms") {
      pacer.restart_at(begin_ns - hour);
      REQUIRE(pacer.wait_for(begin_ns - hour + 50 * ms, sink, stop));
      CHECK(clocks::steady_now() - began >= 49 * ms);
    }
    THEN("times in the past are due at once") {
      REQUIRE(pacer.wait_for(begin_ns - hour, sink, stop));
      CHECK(clocks::steady_now() - began < hour);
    }
    THEN("the sink is ticked several times a second while nothing is due") {
      REQUIRE(pacer.wait_for(begin_ns + 450 * ms, sink, stop));
      CHECK(sink.ticks >= 2);
    }
  }
  GIVEN("a thousand times real time") {
    Pacer pacer(1000.0);
    const SteadyTime began = clocks::steady_now();
    THEN("a minute of the recording takes 60 ms") {
      REQUIRE(pacer.wait_for(begin_ns, sink, stop));
      REQUIRE(pacer.wait_for(begin_ns + hour / 60, sink, stop));
      CHECK(clocks::steady_now() - began >= 60 * ms);
      CHECK(clocks::steady_now() - began < hour / 60);
    }
  }
  GIVEN("rate 0") {
    Pacer pacer(0.0);
    const SteadyTime began = clocks::steady_now();
    THEN("an hour of the recording is due at once") {
      REQUIRE(pacer.wait_for(begin_ns, sink, stop));
      REQUIRE(pacer.wait_for(begin_ns + hour, sink, stop));
      CHECK(clocks::steady_now() - began < hour);
    }
    THEN("the sink is still ticked several times a second") {
      TimeNs time_ns = begin_ns;
      while (sink.ticks < 3) REQUIRE(pacer.wait_for(++time_ns, sink, stop));
      CHECK(clocks::steady_now() - began >= 300 * ms);
    }
  }
}

SCENARIO("a pacer ends its wait at the stop") {
  CollectingSink sink;
  StopSignal stop;
  GIVEN("a sample that is due in an hour") {
    Pacer pacer(1.0);
    REQUIRE(pacer.wait_for(begin_ns, sink, stop));
    WHEN("another thread requests the stop") {
      const std::jthread other([&stop] { stop.request(); });
      THEN("the wait reports it") {
        CHECK_FALSE(pacer.wait_for(begin_ns + hour, sink, stop));
      }
    }
  }
  GIVEN("rate 0, which never waits") {
    Pacer pacer(0.0);
    REQUIRE(pacer.wait_for(begin_ns, sink, stop));
    stop.request();
    THEN("it is noticed, although nothing is waited for") {
      CHECK(test::wait_until([&] { return !pacer.wait_for(begin_ns, sink, stop); }));
    }
  }
}

TEST_CASE("an invalid rate is refused with its value") {
  CHECK_THROWS_WITH(Pacer(-1.0), Catch::Contains("-1"));
  CHECK_THROWS_AS(Pacer(std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
  CHECK_THROWS_AS(Pacer(std::numeric_limits<double>::infinity()), std::invalid_argument);
}

SCENARIO("a recording with absurd stamps is paced") {
  constexpr TimeNs least = std::numeric_limits<TimeNs>::min();
  constexpr TimeNs greatest = std::numeric_limits<TimeNs>::max();
  CollectingSink sink;
  GIVEN("a pacer that is as fast as possible, and one in real time") {
    StopSignal stop;
    Pacer fast(0.0);
    Pacer paced(1e-6);
    WHEN("the stamps jump over all times that exist") {
      THEN("what is past is due at once, and what is centuries ahead waits until it is stopped") {
        for (const TimeNs time_ns : {least, greatest, begin_ns, least})
          CHECK(fast.wait_for(time_ns, sink, stop));
        CHECK(paced.wait_for(begin_ns, sink, stop));
        CHECK(paced.wait_for(least, sink, stop));
        stop.request();
        CHECK_FALSE(paced.wait_for(greatest, sink, stop));
      }
    }
  }
}

}  // namespace pacer_test
