#include "plots/run_curves.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace run_curves_test {

using namespace sonopose;
using namespace sonopose::plots;

TEST_CASE("a long run is thinned to a bounded number of moments that keep the peaks") {
  recording::SensorLog log;
  ImuSample first;
  first.sensor_time_ns = 1;
  log.events.emplace_back(first);
  constexpr int poses = 50'000;
  for (const TimeNs time_ns : {TimeNs{1}, to_ns(0.01) * poses}) {
    log.truth.push_back({.time_ns = time_ns});
  }
  log.truth.insert(log.truth.begin() + 1, {.time_ns = to_ns(0.01) * 777});
  RunCurves curves("fused", {}, {}, log);
  for (int k = 0; k < poses; ++k) {
    FusedPose pose;
    pose.time_ns = k == 0 ? 1 : to_ns(0.01) * k;
    if (k == 777) {
      pose.position_world_m.x() = 3.0;
      pose.status = status_stale;
    }
    curves.add(pose);
  }
  const auto& moments = curves.moments();
  CHECK(moments.size() <= Detail().moments);
  CHECK(moments.size() > Detail().moments / 4);
  double worst_m = 0.0;
  std::size_t stale = 0;
  for (std::size_t k = 0; k < moments.size(); ++k) {
    if (moments[k].error_m > worst_m) worst_m = moments[k].error_m;
    stale += (moments[k].status & status_stale) != 0 ? 1U : 0U;
    if (k > 0) REQUIRE(moments[k].time_s > moments[k - 1].time_s);
  }
  CHECK(worst_m == 3.0);
  CHECK(stale == 1);
  CHECK(moments.back().time_s == Approx(0.01 * (poses - 1)));
}

TEST_CASE("innovations are drawn along the track and to the left of it") {
  const recording::SensorLog log;
  RunCurves curves("fused", {}, {}, log);
  FusedPose pose;
  pose.velocity_world_mps = {0.0, 2.0, 0.0};  // northwards
  curves.add(pose);
  FixReport report;
  report.flags = fix_used;
  report.innovation_world_m = {0.3, 0.1, 0.0};  // 30 cm to the east, 10 cm to the north
  report.innovation_covariance_m2 = Covariance<3>::from_diagonal({0.04, 0.01, 0.01});
  curves.add(report);
  const FixMark& fix = curves.fixes().front();
  CHECK(fix.along_m == Approx(0.1));
  CHECK(fix.left_m == Approx(-0.3));
  CHECK(fix.along_std_m == Approx(0.1));
  CHECK(fix.left_std_m == Approx(0.2));
}

TEST_CASE("a fix that was refused before its innovation was computed has none to draw") {
  const recording::SensorLog log;
  RunCurves curves("fused", {}, {}, log);
  FixReport report;
  report.flags = fix_low_quality;
  curves.add(report);
  CHECK(std::isnan(curves.fixes().front().along_m));
  CHECK(std::isnan(curves.fixes().front().left_m));
}

TEST_CASE("the speed between fixes is that of one tag, and unknown of several") {
  const bool has_several = GENERATE(false, true);
  recording::SensorLog log;
  log.events.emplace_back(UltrasonicFix{});
  UltrasonicFix other;
  if (has_several) other.point_body_m.y() = 0.3;
  log.events.emplace_back(other);
  RunCurves curves("fused", {}, {}, log);
  for (int i = 0; i < 2; ++i) {
    FixReport report;
    report.flags = fix_used;
    report.emission_time_ns = to_ns(1.0 + 0.1 * i);
    report.position_world_m.x() = 0.2 * i;
    curves.add(report);
  }
  CHECK(std::isnan(curves.fixes().back().speed_mps) == has_several);
}

TEST_CASE("a silence of the IMU is a span without poses, whatever the detail") {
  const recording::SensorLog log;
  RunCurves curves("fused", {}, {}, log, {.moments = 8});
  for (int i = 0; i < 1000; ++i) {
    FusedPose pose;
    pose.time_ns = to_ns(1.0 + 0.01 * i + (i < 500 ? 0.0 : 2.0));
    if (i == 500) pose.status = status_imu_gap;
    curves.add(pose);
  }
  REQUIRE(curves.silences().size() == 1);
  CHECK(curves.silences().front().begin_s == Approx(1.0 + 4.99));
  CHECK(curves.silences().front().end_s == Approx(1.0 + 7.0));
}

TEST_CASE("a thinned fix is the one that an engineer looks for") {
  const recording::SensorLog log;
  RunCurves curves("fused", {}, {}, log);
  constexpr int fixes = 40'000;
  for (int i = 0; i < fixes; ++i) {
    FixReport report;
    report.flags = i == 5000 ? fix_low_quality : fix_used;
    report.innovation_world_m.x() = i == 20'000 ? 1.0 : 0.01;
    curves.add(report);
  }
  CHECK(curves.fixes().size() <= Detail().fixes);
  const auto count = [&](const auto& wanted) {
    return std::count_if(curves.fixes().begin(), curves.fixes().end(), wanted);
  };
  CHECK(count([](const FixMark& fix) { return fix.flags == fix_low_quality; }) == 1);
  CHECK(count([](const FixMark& fix) { return fix.innovation_m == 1.0; }) == 1);
  const Histogram histogram = curves.histogram();
  CHECK(std::accumulate(histogram.along.begin(), histogram.along.end(), std::size_t{0}) == fixes - 1);
}

}  // namespace run_curves_test
