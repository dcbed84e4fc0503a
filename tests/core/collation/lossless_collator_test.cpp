/// The order of events on a lossless path, without a time limit.

#include <sonopose/collation/lossless_collator.hpp>

#include <catch2/catch.hpp>

#include <vector>

namespace lossless_collator_test {

using namespace sonopose;
using namespace sonopose::collation;

using Numbers = std::vector<std::uint64_t>;

struct Line {
  LosslessCollator collator;
  Numbers delivered;
  Numbers restarted_at;

  void push_all(std::initializer_list<std::uint64_t> sequences) {
    for (const auto sequence : sequences) push(sequence);
  }
  void push(std::uint64_t sequence) {
    ImuSample imu;
    imu.sequence = sequence;
    for (const CollatedEvent& next : collator.push(imu)) {
      delivered.push_back(sequence_of(next.event));
      if (next.restart) restarted_at.push_back(sequence_of(next.event));
    }
  }
};

TEST_CASE("a stream that is far ahead waits for the lagging one without a time limit") {
  Line line;
  for (std::uint64_t n = 2; n <= 10'000; ++n) line.push(n);
  CHECK(line.delivered.empty());
  line.push(1);
  REQUIRE(line.delivered.size() == 10'000);
  CHECK(line.delivered.back() == 10'000);
  CHECK(line.collator.counters().lost == 0);
}

TEST_CASE("the gap names the missing event and the number of waiting ones") {
  Line line;
  CHECK_FALSE(line.collator.gap());
  line.push_all({2, 3});
  REQUIRE(line.collator.gap());
  CHECK(line.collator.gap()->missing == 1);
  CHECK(line.collator.gap()->waiting == 2);
  line.push_all({1, 5});
  CHECK(line.collator.gap()->missing == 4);
  CHECK(line.collator.gap()->waiting == 1);
  line.push(4);
  CHECK_FALSE(line.collator.gap());
}

TEST_CASE("the first events of a log may arrive in any order: the numbering begins with 1") {
  Line line;
  line.push_all({3, 2, 1, 4});
  CHECK(line.delivered == Numbers{1, 2, 3, 4});
}

TEST_CASE("on a lossless path too, a duplicate is released once") {
  Line line;
  line.push_all({1, 2, 2, 4, 4, 3});
  CHECK(line.delivered == Numbers{1, 2, 3, 4});
  CHECK(line.collator.counters().duplicated == 2);
}

TEST_CASE("a log that is played again restarts the numbering") {
  Line line;
  line.push_all({1, 2, 3, 1, 2, 3, 4});
  CHECK(line.delivered == Numbers{1, 2, 3, 1, 2, 3, 4});
  CHECK(line.restarted_at == Numbers{1});
  CHECK(line.collator.counters().restarts == 1);
}

TEST_CASE("the first events of a repeated log may arrive in any order") {
  Line line;
  line.push_all({1, 2, 3, 3, 2, 1, 4});
  CHECK(line.delivered == Numbers{1, 2, 3, 1, 2, 3, 4});
  CHECK(line.restarted_at == Numbers{1});
  CHECK(line.collator.counters().restarts == 1);
  CHECK(line.collator.counters().duplicated == 0);
}

TEST_CASE("if more events wait than any transport buffers, the missing one is counted as lost") {
  Line line;
  line.push(1);
  for (std::uint64_t n = 0; n <= LosslessCollator::capacity; ++n) line.push(5 + n);
  CHECK(line.collator.counters().lost == 3);
  CHECK(line.delivered.size() == 2 + LosslessCollator::capacity);
}

}  // namespace lossless_collator_test
