/// The order of events where nothing is lost: waited for without end.

#include <sonopose/collation/lossless_collator.hpp>

#include <catch2/catch.hpp>

#include <vector>

using namespace sonopose;
using namespace sonopose::collation;

namespace {

using Numbers = std::vector<std::uint64_t>;

struct Line {
  LosslessCollator collator;
  Numbers delivered;

  void push_all(std::initializer_list<std::uint64_t> sequences) {
    for (const auto sequence : sequences) push(sequence);
  }
  void push(std::uint64_t sequence) {
    ImuSample imu;
    imu.sequence = sequence;
    collator.push(imu, [this](const Event& out) { delivered.push_back(sequence_of(out)); });
  }
};

}  // namespace

TEST_CASE("a stream that runs far ahead waits for the one that lags, however long") {
  Line line;
  for (std::uint64_t n = 2; n <= 10'000; ++n) line.push(n);
  CHECK(line.delivered.empty());
  line.push(1);
  REQUIRE(line.delivered.size() == 10'000);
  CHECK(line.delivered.back() == 10'000);
  CHECK(line.collator.counters().lost == 0);
}

TEST_CASE("what is waited for, and by how many, can be asked") {
  Line line;
  CHECK_FALSE(line.collator.gap());
  line.push_all({2, 3});
  REQUIRE(line.collator.gap());
  CHECK(line.collator.gap()->missing == 1);
  CHECK(line.collator.gap()->held == 2);
  line.push_all({1, 5});
  CHECK(line.collator.gap()->missing == 4);
  CHECK(line.collator.gap()->held == 1);
  line.push(4);
  CHECK_FALSE(line.collator.gap());
}

TEST_CASE("a log's first events may come in any order: numbering begins with 1") {
  Line line;
  line.push_all({3, 2, 1, 4});
  CHECK(line.delivered == Numbers{1, 2, 3, 4});
}

TEST_CASE("losslessly too, what comes twice is delivered once") {
  Line line;
  line.push_all({1, 2, 2, 4, 4, 3});
  CHECK(line.delivered == Numbers{1, 2, 3, 4});
  CHECK(line.collator.counters().duplicated == 2);
}

TEST_CASE("a log that is played again begins anew") {
  Line line;
  line.push_all({1, 2, 3, 1, 2, 3, 4});
  CHECK(line.delivered == Numbers{1, 2, 3, 1, 2, 3, 4});
  CHECK(line.collator.counters().restarts == 1);
}

TEST_CASE("a log that is played again may begin with any of its numbers") {
  Line line;
  line.push_all({1, 2, 3, 3, 2, 1, 4});
  CHECK(line.delivered == Numbers{1, 2, 3, 1, 2, 3, 4});
  CHECK(line.collator.counters().restarts == 1);
  CHECK(line.collator.counters().duplicated == 0);
}

TEST_CASE("more than any transport holds back: what is missing is lost after all") {
  Line line;
  line.push(1);
  for (std::uint64_t n = 0; n <= LosslessCollator::capacity; ++n) line.push(5 + n);
  CHECK(line.collator.counters().lost == 3);
  CHECK(line.delivered.size() == 2 + LosslessCollator::capacity);
}
