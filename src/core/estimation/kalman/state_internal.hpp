#pragma once
// Shared by the sources of State: parameters of the judgement, likelihoods, and the steps of a judgement.

#include <sonopose/estimation/kalman/state.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace sonopose::estimation::kalman {

// Thresholds on the χ² of an innovation with 3 degrees of freedom:
inline constexpr double chi2_huber_threshold = 7.8;     // 5 % are above
inline constexpr double chi2_explain_threshold = 16.0;  // 0.1 % are above
inline constexpr double chi2_reject_threshold = 30.0;
inline constexpr double heading_chi2_reject_threshold =
    25.0;  // 1 degree of freedom: five standard deviations

inline constexpr double wrong_fix_likelihood = -4.5;       // logarithm; the fix lies anywhere within metres
inline constexpr TimeNs max_heading_age_ns = 500'000'000;  // age at which a start may still use a heading
inline constexpr int min_rejected_in_row = 3;              // fewer may be outliers
inline constexpr int min_track_fixes = 3;                  // number of fixes that make a track
inline constexpr double min_evidence_margin = 10.0;        // prior odds: most IMUs are right
inline constexpr double min_margin_over_tracks = 4.0;      // wrong tracks are more frequent
inline constexpr double max_start_score_deficit = 14.0;    // of a yaw that is tried
inline constexpr int min_rest_fixes = 2;  // enough to distinguish a rest from a smooth cruise

constexpr double square(double x) {
  return x * x;
}

constexpr double radians(double degrees) {
  return degrees * geometry::radians_per_degree;
}

/// Factor by which the covariance of a fix grows with its innovation.
inline double scale_of(const Innovation& innovation) {
  return std::max(1.0, innovation.squared_norm / chi2_huber_threshold);
}

/// Corrects a filter by a fix whose covariance, `covariance_m2`, grows with its innovation.
inline void correct_scaled(Filter& filter, const Innovation& innovation, const Matrix3d& covariance_m2) {
  filter.correct_fix(innovation, (scale_of(innovation) - 1.0) * covariance_m2);
}

/// Student's t with six degrees of freedom over three dimensions, up to a constant.
inline double log_likelihood(const Innovation& innovation) {
  return -4.5 * std::log1p(innovation.squared_norm / 6.0) - 0.5 * innovation.log_determinant;
}

/// Adds the log-likelihood of a fix that may also be wrong.
inline void add_evidence(double& evidence, double log_likelihood) {
  constexpr double forgetting_factor = 0.85;
  evidence = forgetting_factor * evidence + std::max(log_likelihood, wrong_fix_likelihood);
}

inline double squared_norm(const Filter::HeadingInnovation& innovation) {
  return square(innovation.value_rad) / innovation.variance_rad2;
}

/// Innovation of each hypothesis, in the order of the bank.
using Innovations = std::array<Innovation, HypothesisBank::capacity>;

/// A fix under judgement.
struct JudgedFix {
  const settings::Settings& settings;
  const FixMeasurement& fix;
  Matrix3d covariance_m2;
  double ahead_s;  ///< lead of the fix over the filters
  Innovations innovations;

  [[nodiscard]] const Innovation& innovation_of(const HypothesisBank& bank,
                                                const Hypothesis& hypothesis) const {
    return innovations[static_cast<std::size_t>(bank.index_of(hypothesis))];
  }
};

[[nodiscard]] Matrix3d covariance_of(const State& state, const FixMeasurement& fix);
/// Position of the tracked point at a fix, by the attitude of this filter.
[[nodiscard]] inline Vector3d tracked_at(const FixMeasurement& fix, const Filter& filter) {
  return fix.position_world_m - filter.q_body_to_world * fix.point_body_m;
}
[[nodiscard]] bool stands_still(const State& state, int min_fixes);
/// Holds a planar body in its plane, several times a second. `before_ns`: time of the previous sample.
void hold_plane(State& state, const settings::PlanarSettings& settings, TimeNs before_ns);
/// Rate of the body about the vertical.
[[nodiscard]] double yaw_rate_radps(const State& state);
/// Registers that the followed track jumped to this fix.
void note_jump(State& state, TimeNs fix_ns);
/// Registers a fix that the followed track has used.
void note_used(State& state, const FixMeasurement& fix);

// Yaw: the first fix, and the search for an unknown yaw.
void start_at(State& state, const FixMeasurement& fix, const settings::Settings& settings);
void prune_starts(State& state);
void search_yaw_again(State& state);
/// Searches again from the fixes alone if they contradict every start. Returns true if so.
bool restart_search(State& state);

// Headings.
/// Variance of the source, or the learned one.
[[nodiscard]] double variance_of(const State& state, const HeadingMeasurement& heading);
[[nodiscard]] Filter::HeadingInnovation heading_innovation(const State& state, const Filter& filter,
                                                           const settings::Settings& settings,
                                                           const HeadingMeasurement& heading);
void correct_by_heading(const State& state, Filter& filter, const settings::Settings& settings,
                        const HeadingMeasurement& heading, double variance_rad2);

/// True if the motion alone shows the yaw of a filter that headings do not correct.
[[nodiscard]] inline bool motion_shows_yaw(const Filter& filter) {
  constexpr double max_std_rad = radians(5.0);
  return filter.yaw_variance_rad2() < square(max_std_rad);
}

/// True if the yaw that the motion shows to a filter without headings certainly differs from theirs.
[[nodiscard]] bool contradicts_headings(const State& state, const Filter& filter);

// Other tracks.
[[nodiscard]] Hypothesis* find_other_track(State& state);
void end_other_track(State& state, TimeNs now_ns);
/// True if the fixes moved to another track a short time ago and far away: either may be right.
[[nodiscard]] bool has_left_track(const State& state);
void store_former_track(State& state, TimeNs left_ns, TimeNs left_for_ns);
void judge_rejected(State& state, const JudgedFix& judged, FixOutcome& outcome);
void judge_turned_map(State& state, const settings::Settings& settings, const HeadingMeasurement& heading,
                      double innovation_rad);

// The IMU.
void choose_model(State& state);
void update_evidence(State& state, const JudgedFix& judged);
void update_distrustful_models(State& state, bool is_suspicious);
/// Sets the biases that were estimated before the latest fault, if there was one, and their initial
/// variances.
void restore_trusted_biases(const ImuFaultDetector& detector, Filter& filter);
/// Levels a filter by the mean force, if that is gravity.
void level_by_mean_force(const State& state, Filter& filter);
/// Begins to judge fixes and headings again after a change of the model.
void forget_judgement(State& state);
/// Makes a distrustful model the best if it explains best what is rejected, or fits badly for a while.
bool switch_to_distrustful_model(State& state);
void predict_if_silent(State& state, const settings::Settings& settings, TimeNs measured_ns);
void end_imu_gap(State& state, TimeNs to_ns);
/// Discards filters that are not finite; the next fix then starts the estimate.
void recover_if_not_finite(State& state);

}  // namespace sonopose::estimation::kalman
