#include <sonopose/ros2/messages/time.hpp>

#include <catch2/catch.hpp>

#include <cstdlib>
#include <limits>
#include <optional>

namespace time_test {

using namespace sonopose;
using namespace sonopose::ros2;

TEST_CASE("The conversion of times to ROS 2 and back is exact") {
  for (const TimeNs time_ns : {TimeNs{0}, TimeNs{1}, TimeNs{999'999'999}, TimeNs{1'000'000'000},
                               TimeNs{1'700'000'000'123'456'789}, TimeNs{-1}, TimeNs{-2'000'000'001}}) {
    CAPTURE(time_ns);
    CHECK(to_ros(time_ns).nanosec < 1'000'000'000U);
    CHECK(from_ros(to_ros(time_ns)) == time_ns);
  }
  CHECK(to_ros(-1).sec == -1);
  CHECK(to_ros(-1).nanosec == 999'999'999U);
  CHECK(from_ros({5, 1'000'000'000U}) == std::nullopt);
}

SCENARIO("stamps increase strictly") {
  GIVEN("a stream with the last stamp 10 s") {
    constexpr TimeNs ten_s = 10'000'000'000;
    RisingStamp stamps;
    REQUIRE(stamps.next(ten_s) == ten_s);
    WHEN("a newer sample arrives") {
      THEN("its stamp is unchanged") {
        CHECK(stamps.next(ten_s + 5) == ten_s + 5);
      }
    }
    WHEN("two samples have the same time") {
      THEN("each stamp is one nanosecond later, and the next newer one is unchanged") {
        CHECK(stamps.next(ten_s) == ten_s + 1);
        CHECK(stamps.next(ten_s) == ten_s + 2);
        CHECK(stamps.next(ten_s + 1'000'000) == ten_s + 1'000'000);
      }
    }
    WHEN("a sample is 2 ms older") {
      THEN("it is dropped") {
        CHECK(stamps.next(ten_s - 2'000'000) == std::nullopt);
      }
    }
    WHEN("the clock is set back by two seconds") {
      THEN("the stream restarts") {
        CHECK(stamps.next(ten_s - 2'000'000'000) == ten_s - 2'000'000'000);
        CHECK(stamps.next(ten_s - 1'900'000'000) == ten_s - 1'900'000'000);
      }
    }
  }
  GIVEN("a stream where a newer sample makes an older one useless, such as poses") {
    RisingStamp stamps(0);
    REQUIRE(stamps.next(1'000) == 1'000);
    THEN("samples that are not newer are dropped") {
      CHECK(stamps.next(1'000) == std::nullopt);
      CHECK(stamps.next(999) == std::nullopt);
      CHECK(stamps.next(1'001) == 1'001);
    }
  }
}

SCENARIO("a stream is thinned to a rate on average") {
  constexpr TimeNs ms = 1'000'000;
  const auto admitted = [](RateThinner& limit, TimeNs from_ns, TimeNs step_ns, int count) {
    int published = 0;
    for (int i = 0; i < count; ++i) published += limit.admits(from_ns + i * step_ns) ? 1 : 0;
    return published;
  };
  const TimeNs ten_s = 10'000 * ms;
  GIVEN("ten seconds at 100 Hz") {
    THEN("30 Hz, which is no divisor, gives 300 messages, and a higher rate all of them") {
      RateThinner thirty(30);
      CHECK(std::abs(admitted(thirty, ten_s, 10 * ms, 1000) - 300) <= 1);
      RateThinner high(400);
      CHECK(admitted(high, ten_s, 10 * ms, 1000) == 1000);
      RateThinner none(0);
      CHECK(admitted(none, ten_s, 10 * ms, 1000) == 1000);
    }
  }
  GIVEN("a stream at 1 Hz") {
    RateThinner one(1);
    REQUIRE(one.admits(ten_s));
    THEN("a gap is not made up for") {
      CHECK(admitted(one, ten_s + 60'000 * ms, 10 * ms, 100) == 1);
    }
    THEN("the stream continues after the clock is set back") {
      CHECK(admitted(one, ten_s - 5'000 * ms, 10 * ms, 300) == 3);
    }
  }
}

TEST_CASE("Stamps of any value are admitted, and the stream continues") {
  constexpr TimeNs now_ns = 1'700'000'000'000'000'000;
  for (const TimeNs absurd_ns : {std::numeric_limits<TimeNs>::min(), std::numeric_limits<TimeNs>::max()}) {
    CAPTURE(absurd_ns);
    RisingStamp stamps;
    CHECK(stamps.next(absurd_ns) == absurd_ns);
    CHECK(stamps.next(-absurd_ns / 2) == -absurd_ns / 2);
    CHECK(stamps.next(absurd_ns) == absurd_ns);
    CHECK(stamps.next(now_ns) == now_ns);
    RateThinner limit(100);
    CHECK(limit.admits(absurd_ns));
    CHECK(limit.admits(now_ns));
    CHECK(limit.admits(absurd_ns));
  }
}

}  // namespace time_test
