/// Restoration of the order of three streams.

#include <sonopose/collation/collator.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <map>
#include <vector>

namespace collator_test {

using namespace sonopose;
using namespace sonopose::collation;

constexpr TimeNs ms = 1'000'000;

/// A collator and its output; one event per millisecond.
struct Line {
  Collator collator{5 * ms};
  std::vector<std::uint64_t> delivered;
  std::vector<TimeNs> times_ns;  ///< times of the delivered samples
  std::vector<std::uint64_t> restarted_at;
  SteadyTime now{1000 * ms};

  void push(const Event& event) {
    for (const CollatedEvent& next : collator.push(event, now)) {
      delivered.push_back(sequence_of(next.event));
      times_ns.push_back(available_at_ns(next.event));
      if (next.restart) restarted_at.push_back(sequence_of(next.event));
    }
    now += ms;
  }
  void push(std::uint64_t sequence) {
    ImuSample imu;
    imu.sequence = sequence;
    push(Event(imu));
  }
  void push_all(std::initializer_list<std::uint64_t> sequences) {
    for (const auto sequence : sequences) push(sequence);
  }
};

using Numbers = std::vector<std::uint64_t>;

TEST_CASE("events in order pass immediately, with any first number") {
  Line line;
  for (std::uint64_t n = 41; n < 50; ++n) {
    line.push(n);
    REQUIRE(line.delivered.back() == n);
  }
  CHECK(line.collator.counters().lost == 0);
  CHECK(line.collator.counters().duplicated == 0);
}

TEST_CASE("an event without a number passes at once") {
  Line line;
  line.push_all({unnumbered, 1, 3, unnumbered});
  CHECK(line.delivered == Numbers{unnumbered, 1, unnumbered});
  line.push(2);
  CHECK(line.delivered == Numbers{unnumbered, 1, unnumbered, 2, 3});
  CHECK(line.collator.counters().lost == 0);
  CHECK(line.collator.counters().duplicated == 0);
}

TEST_CASE("a gap that is filled in time loses nothing") {
  Line line;
  line.push_all({1, 2, 4, 5});
  CHECK(line.delivered == Numbers{1, 2});
  line.push(3);
  CHECK(line.delivered == Numbers{1, 2, 3, 4, 5});
  CHECK(line.collator.counters().lost == 0);
}

TEST_CASE("a gap that is not filled within the timeout is counted as lost") {
  Line line;
  line.push_all({1, 2, 4, 5, 6, 7, 8});  // 4 arrived at 3 ms: its timeout of 5 ms is still running
  CHECK(line.delivered == Numbers{1, 2});
  line.push_all({9, 10});
  CHECK(line.delivered == Numbers{1, 2, 4, 5, 6, 7, 8, 9, 10});
  CHECK(line.collator.counters().lost == 1);
  WHEN("the missing event arrives later") {
    line.push(3);
    THEN("it is too late") {
      CHECK(line.delivered.size() == 9);
      CHECK(line.collator.counters().duplicated == 1);
    }
  }
}

TEST_CASE("two gaps are given up each after its own timeout") {
  Line line;
  line.push_all({1, 3, 5});
  line.now += 10 * ms;
  line.push(6);
  CHECK(line.delivered == Numbers{1, 3, 5, 6});
  CHECK(line.collator.counters().lost == 2);
}

TEST_CASE("three streams that overtake each other are released in the bridge's order") {
  Line line;
  const auto imu = [](std::uint64_t n) {
    ImuSample e;
    e.sequence = n;
    return Event(e);
  };
  const auto fix = [](std::uint64_t n) {
    UltrasonicFix e;
    e.sequence = n;
    return Event(e);
  };
  const auto heading = [](std::uint64_t n) {
    PairHeading e;
    e.sequence = n;
    return Event(e);
  };
  for (const Event& event :
       {imu(1), imu(2), imu(5), heading(4), imu(6), fix(3), imu(7), imu(10), heading(9), fix(8)}) {
    line.push(event);
  }
  CHECK(line.delivered == Numbers{1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
  CHECK(line.collator.counters().lost == 0);
  CHECK(line.collator.counters().duplicated == 0);
}

TEST_CASE("a duplicate is released once") {
  Line line;
  line.push_all({1, 2, 2, 3, 1, 5, 5, 4});
  CHECK(line.delivered == Numbers{1, 2, 3, 4, 5});
  CHECK(line.collator.counters().duplicated == 3);
}

TEST_CASE("a bridge that restarts its numbering loses only events that do not arrive") {
  Line line;
  Numbers pushed;
  for (std::uint64_t n = 1000; n < 1050; ++n) pushed.push_back(n);
  const std::uint64_t first = GENERATE(1U, 5U, 500U);
  for (std::uint64_t n = first; n <= first + 20; ++n) pushed.push_back(n);
  for (const std::uint64_t n : pushed) line.push(n);
  CHECK(line.delivered == pushed);
  CHECK(line.collator.counters().restarts == 1);
  CHECK(line.restarted_at == Numbers{first});
  CHECK(line.collator.counters().lost == (first <= 5 ? first - 1 : 0));  // more is a part of a recording
  CHECK(line.collator.counters().duplicated == 0);
}

TEST_CASE("a bridge that restarts its numbering loses no event if another stream is taken first") {
  Line line;
  for (std::uint64_t n = 1000; n < 1050; ++n) line.push(n);
  line.delivered.clear();
  Numbers backlog{12, 19, 26};  // the fixes
  for (std::uint64_t n = 5; n <= 30; ++n) {
    if (n != 12 && n != 19 && n != 26) backlog.push_back(n);
  }
  for (const std::uint64_t n : backlog) {
    line.push(n);
    line.now = line.now - ms;  // all are taken at the same time
  }
  CHECK(line.delivered.front() == 5);
  CHECK(line.delivered.size() == 26);
  CHECK(std::is_sorted(line.delivered.begin(), line.delivered.end()));
  CHECK(line.restarted_at == Numbers{5});
  CHECK(line.collator.counters().lost == 4);
  CHECK(line.collator.counters().duplicated == 0);
}

TEST_CASE("an old duplicate is no event of a restarted numbering") {
  Line line;
  const auto push_at = [&line](std::uint64_t sequence, TimeNs time_ns) {
    ImuSample imu;
    imu.sequence = sequence;
    imu.sensor_time_ns = time_ns;
    line.push(Event(imu));
  };
  for (std::uint64_t n = 1; n <= 50; ++n) push_at(n, static_cast<TimeNs>(n) * ms);
  push_at(20, 20 * ms);
  for (std::uint64_t n = 1; n <= 25; ++n) push_at(n, (10'000 + static_cast<TimeNs>(n)) * ms);
  CHECK(line.delivered.size() == 75);
  CHECK(std::is_sorted(line.delivered.begin() + 50, line.delivered.end()));
  CHECK(std::is_sorted(line.times_ns.begin(), line.times_ns.end()));
  CHECK(line.collator.counters().lost == 0);
  CHECK(line.collator.counters().duplicated == 1);
}

TEST_CASE("a stream that lags behind another by more than the timeout is late, and no restart") {
  // Every tenth event arrives immediately, the others 8 ms later, as from two sockets of an overloaded
  // receiver.
  std::multimap<TimeNs, std::uint64_t> arrivals;
  for (std::uint64_t n = 1; n <= 1000; ++n) {
    arrivals.emplace((static_cast<TimeNs>(n) + (n % 10 == 0 ? 0 : 8)) * ms, n);
  }
  Line line;
  for (const auto& [arrival_ns, n] : arrivals) {
    line.now = SteadyTime{arrival_ns};
    line.push(n);
  }
  CHECK(std::is_sorted(line.delivered.begin(), line.delivered.end()));
  CHECK(line.collator.counters().restarts == 0);
  CHECK(line.collator.counters().lost + line.delivered.size() <= 1000);
}

TEST_CASE("a restart releases the events that were waiting") {
  Line line;
  line.push_all({1000, 1001, 1003});
  line.push_all({1, 2, 3, 4, 5});
  CHECK(line.delivered == Numbers{1000, 1001, 1003, 1, 2, 3, 4, 5});
  CHECK(line.restarted_at == Numbers{1});
}

TEST_CASE("a gap that is wider than the buffer is given up immediately") {
  Line line;
  line.push_all({1, 2, 1'000'000, 1'000'001});
  CHECK(line.delivered == Numbers{1, 2, 1'000'000, 1'000'001});
  CHECK(line.collator.counters().lost == 1'000'000 - 3);
}

TEST_CASE("more waiting events than the capacity give the gap up early, in order") {
  Line line;
  line.collator = Collator(TimeNs{3600} * 1000 * ms);
  line.push(1);
  for (std::uint64_t n = 3; n < 3 + 2 * Collator::capacity; ++n) line.push(n);
  CHECK(line.delivered.front() == 1);
  CHECK(line.delivered.back() == 2 + 2 * Collator::capacity);
  CHECK(line.delivered.size() == 1 + 2 * Collator::capacity);
  CHECK(std::is_sorted(line.delivered.begin(), line.delivered.end()));
  CHECK(line.collator.counters().lost == 1);
}

TEST_CASE("of two bridges with the same address, the first stays complete and in order") {
  Line line;
  for (std::uint64_t n = 0; n < 200; ++n) {
    line.push(5000 + n);
    line.push(1 + n);
  }
  CHECK(line.delivered.size() == 200);
  CHECK(line.delivered.front() == 5000);
  CHECK(line.delivered.back() == 5199);
  CHECK(line.collator.counters().restarts == 0);
  CHECK(line.collator.counters().duplicated == 200);
}

TEST_CASE("a corrupt number neither blocks the following events nor counts as a loss") {
  Line line;
  for (std::uint64_t n = 1; n <= 10; ++n) line.push(n);
  line.push(GENERATE(UINT64_MAX, UINT64_MAX - 1, std::uint64_t{1} << 63U, max_lost + 12));
  for (std::uint64_t n = 11; n <= 40; ++n) line.push(n);
  CHECK(line.delivered.back() == 40);
  CHECK(line.collator.counters().lost <=
        11);  // at most those before the collator follows the old numbering again
  CHECK(line.collator.counters().restarts >= 1);
}

}  // namespace collator_test
