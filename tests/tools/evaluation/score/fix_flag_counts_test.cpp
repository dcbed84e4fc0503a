#include "evaluation/score/fix_flag_counts.hpp"

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

TEST_CASE("a fix is down-weighted if it is used, but less because of its innovation") {
  FixReport report;
  report.flags = fix_used;
  report.weight = 0.4;
  CHECK_FALSE(is_down_weighted(report));  // the documented engine: an ordinary innovation
  report.flags = fix_used | fix_outlier;
  CHECK(is_down_weighted(report));
  report.flags = fix_outlier;
  CHECK_FALSE(is_down_weighted(report));  // rejected
  report.flags = fix_used;
  report.innovation_covariance_m2.emplace();  // the Kalman engine: between its two gates
  CHECK(is_down_weighted(report));
  report.weight = 1.0;
  CHECK_FALSE(is_down_weighted(report));
}

TEST_CASE("a fix has one verdict") {
  FixReport report;
  CHECK(verdict_of(report) == FixVerdict::rejected);
  report.flags = fix_used;
  report.weight = 0.4;
  CHECK(verdict_of(report) == FixVerdict::used);
  report.innovation_covariance_m2.emplace();
  CHECK(verdict_of(report) == FixVerdict::down_weighted);
}

TEST_CASE("an innovation of zero is one only of a fix that was predicted and used") {
  FixReport report;
  report.flags = fix_low_quality;
  CHECK_FALSE(has_innovation(report));
  report.flags = fix_used | fix_first;
  CHECK_FALSE(has_innovation(report));
  report.flags = fix_used;
  CHECK(has_innovation(report));
  report.flags = fix_outlier;
  report.innovation_world_m.x() = 2.5;
  CHECK(has_innovation(report));
}

}  // namespace fix_flag_counts_test
