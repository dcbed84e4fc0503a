#include "evaluation/verdicts.hpp"

#include <catch2/catch.hpp>

using namespace sonopose;

TEST_CASE("verdicts are told in words, in the order of their bits") {
  CHECK(evaluation::verdict_text(0) == "none");
  CHECK(evaluation::verdict_text(verdict_first | verdict_used) == "used|first");
  CHECK(evaluation::verdict_text(verdict_low_quality) == "low_quality");
}

TEST_CASE("each bit of a verdict is counted for itself") {
  evaluation::VerdictCounts counts;
  counts.add(verdict_used);
  counts.add(verdict_used | verdict_frozen);
  CHECK(counts.of(verdict_used) == 2);
  CHECK(counts.of(verdict_frozen) == 1);
  CHECK(counts.of(verdict_first) == 0);
}
