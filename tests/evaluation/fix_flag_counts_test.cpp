#include "evaluation/fix_flag_counts.hpp"

#include <catch2/catch.hpp>

namespace fix_flag_counts_test {

using namespace sonopose;

TEST_CASE("fix flags are named in the order of their bits") {
  CHECK(evaluation::fix_flag_text(0) == "none");
  CHECK(evaluation::fix_flag_text(fix_first | fix_used) == "used|first");
  CHECK(evaluation::fix_flag_text(fix_low_quality) == "low_quality");
  CHECK(evaluation::fix_flag_text(fix_too_late) == "too_late");
}

TEST_CASE("each fix flag is counted separately") {
  evaluation::FixFlagCounts counts;
  counts.add(fix_used);
  counts.add(fix_used | fix_frozen);
  CHECK(counts.of(fix_used) == 2);
  CHECK(counts.of(fix_frozen) == 1);
  CHECK(counts.of(fix_first) == 0);
}

}  // namespace fix_flag_counts_test
