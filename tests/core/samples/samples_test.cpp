/// Helpers of the native types: whole nanoseconds, and the common properties of the event kinds.

#include <sonopose/samples/fix_refusal.hpp>
#include <sonopose/samples/samples.hpp>

#include <catch2/catch.hpp>

#include <concepts>
#include <limits>

namespace samples_test {

using namespace sonopose;

// Times of different clocks do not convert into each other.
static_assert(!std::convertible_to<HostTime, SteadyTime>);
static_assert(!std::convertible_to<SteadyTime, HostTime>);
static_assert(!std::equality_comparable_with<HostTime, SteadyTime>);
template <class A, class B>
concept Subtractable = requires(A a, B b) {
  a - b;
};
static_assert(Subtractable<SteadyTime, SteadyTime>);
static_assert(!Subtractable<HostTime, SteadyTime>);

TEST_CASE("seconds become the nearest nanosecond and come back") {
  CHECK(to_ns(1.5) == 1'500'000'000);
  CHECK(to_ns(0.0) == 0);
  CHECK(to_ns(0.6e-9) == 1);
  CHECK(to_ns(-0.6e-9) == -1);
  CHECK(to_ns(0.068) == 68'000'000);
  CHECK(to_ns(-0.068) == -68'000'000);
  CHECK(seconds_between(1'000'000'000, 3'500'000'000) == 2.5);
  CHECK(seconds_between(3'500'000'000, 1'000'000'000) == -2.5);
}

TEST_CASE("differences keep their nanoseconds at today's epoch") {
  const TimeNs now_ns = 1'760'000'000'123'456'789;
  CHECK(seconds_between(now_ns, now_ns + 1) == 1e-9);
}

TEST_CASE("times of any value have a difference and a sum") {
  constexpr TimeNs least = std::numeric_limits<TimeNs>::min();
  constexpr TimeNs greatest = std::numeric_limits<TimeNs>::max();
  CHECK(saturated_difference(greatest, least) == greatest);
  CHECK(saturated_difference(least, greatest) == least);
  CHECK(saturated_sum(greatest, 1) == greatest);
  CHECK(saturated_sum(least, -1) == least);
  CHECK(saturated_sum(greatest, least) == -1);
  CHECK(seconds_between(least, greatest) > 9e9);
  CHECK(seconds_between(greatest, least) < -9e9);
}

TEST_CASE("an event has a beacon, a sequence number and a time of availability") {
  ImuSample imu;
  imu.address = 3;
  imu.sequence = 11;
  imu.sensor_time_ns = 500;
  imu.bridge_time_ns = 900;  // used for latency only
  UltrasonicFix fix;
  fix.address = 4;
  fix.sequence = 12;
  fix.emission_time_ns = 500;
  fix.received_time_ns = 700;
  PairHeading heading;
  heading.address = 5;
  heading.sequence = 13;
  heading.emission_time_ns = 500;
  heading.received_time_ns = 701;

  CHECK(address_of(imu) == 3);
  CHECK(address_of(fix) == 4);
  CHECK(address_of(heading) == 5);
  CHECK(sequence_of(imu) == 11);
  CHECK(sequence_of(fix) == 12);
  CHECK(sequence_of(heading) == 13);
  CHECK(available_at_ns(imu) == 500);
  CHECK(available_at_ns(fix) == 700);
  CHECK(available_at_ns(heading) == 701);
}

TEST_CASE("a refused fix has a cause, an outlier has none") {
  const auto refusal = [](std::uint32_t flags, TimeNs emission_ns, TimeNs engine_ns) {
    FixReport report;
    report.flags = flags;
    report.emission_time_ns = emission_ns;
    report.applied_time_ns = engine_ns;
    return refusal_of(report);
  };
  CHECK_FALSE(refusal(fix_used, 900, 1000));
  CHECK_FALSE(refusal(fix_outlier, 900, 1000));
  CHECK(refusal(fix_low_quality, 900, 1000) == FixRefusal::low_quality);
  CHECK(refusal(fix_too_late, 100, 1000) == FixRefusal::too_old);
  CHECK(refusal(fix_invalid, 2000, 1000) == FixRefusal::too_new);
  CHECK(refusal(fix_invalid, 900, 1000) == FixRefusal::invalid);
  CHECK(refusal(fix_invalid, 900, 0) == FixRefusal::no_imu);
}

TEST_CASE("steady times differ by durations") {
  const SteadyTime begin{1'000'000'000};
  CHECK(begin + 500 - begin == 500);
  CHECK(begin - 500 < begin);
  CHECK(seconds_between(begin, begin + 2'500'000'000) == 2.5);
  CHECK(SteadyTime::max() > begin);
}

}  // namespace samples_test
