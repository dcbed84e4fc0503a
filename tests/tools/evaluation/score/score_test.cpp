#include "evaluation/score/score.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <limits>

namespace score_test {

using namespace sonopose;
using evaluation::Scorer;

constexpr double degree = geometry::radians_per_degree;

TruthSample truth_at(double time_s, const Vector3d& position_world_m) {
  TruthSample truth;
  truth.time_ns = to_ns(time_s);
  truth.position_world_m = position_world_m;
  return truth;
}

FusedPose pose_at(double time_s, const Vector3d& position_world_m) {
  FusedPose pose;
  pose.time_ns = to_ns(time_s);
  pose.position_world_m = position_world_m;
  return pose;
}

TEST_CASE("errors are summarised by root mean square, 95th percentile and maximum") {
  std::vector<double> errors;
  for (int i = 100; i >= 1; --i) errors.push_back(i);
  const auto summary = evaluation::error_summary_of(errors);
  CHECK(summary.p95 == 95.0);
  CHECK(summary.max == 100.0);
  CHECK(summary.rmse == Approx(std::sqrt(3383.5)));  // (n+1)(2n+1)/6
  CHECK(evaluation::error_summary_of({3.0}).p95 == 3.0);
  CHECK(std::isnan(evaluation::error_summary_of({}).rmse));
}

TEST_CASE("the position error is the distance to the interpolated truth, not aligned") {
  const std::vector<TruthSample> truth{truth_at(1.0, {0, 0, 0}), truth_at(1.1, {1, 0, 0})};
  Scorer scorer(truth, 0);
  scorer.add(pose_at(0.9, {7, 7, 7}));         // before the truth
  scorer.add(pose_at(1.05, {0.5, 0.3, 0.4}));  // 0.5 m off
  scorer.add(pose_at(1.1, {1, 0, 1.2}));       // 1.2 m off
  scorer.add(pose_at(1.2, {7, 7, 7}));         // after the truth
  const auto score = scorer.score();
  CHECK(score.poses == 2);
  CHECK(score.poses_without_truth == 2);
  CHECK(score.position_m.rmse == Approx(std::sqrt((0.25 + 1.44) / 2)));
  CHECK(score.position_m.max == Approx(1.2));
}

TEST_CASE("sparse truth is compared with the poses around its stamps") {
  const std::vector<TruthSample> truth{truth_at(1.004, {0, 0, 0}), truth_at(1.204, {0.2, 0, 0}),
                                       truth_at(1.404, {0.4, 0.3, 0})};
  Scorer scorer(truth, 0);
  // Along x at 1 m/s, exactly on the first two.
  for (int i = 0; i <= 50; ++i) scorer.add(pose_at(1.0 + 0.01 * i, {-0.004 + 0.01 * i, 0, 0}));
  const auto score = scorer.score();
  CHECK(score.poses == 3);
  CHECK(score.poses_without_truth == 48);
  CHECK(score.position_m.max == Approx(0.3));
  CHECK(score.position_m.rmse == Approx(0.3 / std::sqrt(3.0)));
}

TEST_CASE("a pose with a wrong time does not affect the score of other poses") {
  const std::vector<TruthSample> truth{truth_at(1.0, {0, 0, 0}), truth_at(1.1, {1, 0, 0}),
                                       truth_at(1.2, {2, 0, 0})};
  Scorer scorer(truth, 0);
  for (const double time_s : {1.05, 1000.0, 1.1, 1.2, 0.1, 1.15, 1.0}) {
    scorer.add(pose_at(time_s, {10.0 * (time_s - 1.0), 0.5, 0}));
  }
  CHECK(scorer.score().poses == 5);
  CHECK(scorer.score().poses_without_truth == 2);
  CHECK(scorer.score().position_m.max == Approx(0.5));
}

TEST_CASE("poses before the scored span, in a gap of the truth, or without a truth are not scored") {
  auto unknown = truth_at(1.0, Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  unknown.velocity_world_mps = {1, 0, 0};
  const std::vector<TruthSample> truth{truth_at(0.5, {0, 0, 0}), unknown, truth_at(1.5, {0, 0, 0})};
  Scorer scorer(truth, to_ns(0.8));
  scorer.add(pose_at(0.5, {1, 0, 0}));
  scorer.add(pose_at(1.0, {1, 0, 0}));
  scorer.add(pose_at(1.25, {1, 0, 0}));
  const auto score = scorer.score();
  CHECK(score.poses == 0);
  CHECK(score.poses_without_truth == 2);  // those in the scored span
  CHECK(std::isnan(score.position_m.rmse));
  CHECK(score.velocity_rmse_mps == Approx(1.0));  // the truth is known at this sample
}

TEST_CASE("the attitude error separates into heading and inclination") {
  auto truth = truth_at(1.0, Vector3d::Zero());
  truth.q_body_to_world = geometry::rotation_about_z(1.0);
  const std::vector<TruthSample> track{truth};
  const auto error_of = [&](const Quaterniond& q_off_world) {
    Scorer scorer(track, 0);
    auto pose = pose_at(1.0, Vector3d::Zero());
    pose.q_body_to_world = q_off_world * truth.q_body_to_world;
    scorer.add(pose);
    return scorer.score();
  };
  const auto turned = error_of(geometry::rotation_about_z(-3.0 * degree));
  CHECK(turned.yaw_rmse_deg == Approx(3.0));
  CHECK(turned.tilt_rmse_deg == Approx(0.0).margin(1e-5));
  const auto tilted = error_of(geometry::rotation_by({2.0 * degree, 0, 0}));
  CHECK(tilted.yaw_rmse_deg == Approx(0.0).margin(1e-9));
  CHECK(tilted.tilt_rmse_deg == Approx(2.0));
  const auto over = error_of(geometry::rotation_about_z(181.0 * degree));
  CHECK(over.yaw_rmse_deg == Approx(179.0));
}

}  // namespace score_test
