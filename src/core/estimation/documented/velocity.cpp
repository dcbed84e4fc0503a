#include <sonopose/estimation/documented/velocity.hpp>
#include <sonopose/samples/pose.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sonopose::estimation::documented::velocity {
namespace {

using PastFixes = std::array<PastFix, VelocityState::capacity>;

/// Snap by items 7, 8 and 28.
std::uint32_t snap_for(const VelocitySettings& settings, const FixVelocity& measured,
                       const FixAssessment& assessment) {
  const double ultrasonic_mps = measured.ultrasonic_world_mps.norm();
  const double inertial_mps = measured.inertial_world_mps.norm();
  if (ultrasonic_mps < settings.snap_min_speed_mps || measured.bend_m > settings.snap_max_bend_m) return 0;
  if (!assessment.trusted) return 0;
  const bool same_direction = measured.ultrasonic_world_mps.dot(measured.inertial_world_mps) > 0.0;
  if (settings.overshoot_fix && same_direction && inertial_mps > 2.0 * ultrasonic_mps) {
    return fix_snapped_over;
  }
  if (settings.undershoot_fix && ultrasonic_mps > 2.0 * inertial_mps) return fix_snapped_under;
  return 0;
}

/// Share by item 3. A fix after a longer pause than interval_wanted_s corrects as much as several at that
/// interval: with fewer fixes the loop through the attitude would oscillate. The first velocities of a run
/// are averaged: the n-th has a share of at least 1/n. If item 3 is zero, the velocity is not corrected.
double blend_of(const VelocitySettings& settings, const VelocityState& state, const FixVelocity& measured) {
  const double share = share_of_several(settings.blend_weight, measured.usual_fixes);
  if (state.settled() || settings.blend_weight <= 0.0) return share;
  return std::max(share, 1.0 / (state.velocities + 1));
}

/// Gate by items 26 and 27: one at rest, one half at the threshold, zero from twice the threshold on.
double accel_gate(const VelocitySettings& settings, double acceleration_mps2) {
  if (!settings.accel_gate) return 1.0;
  return std::max(0.0, 1.0 - acceleration_mps2 / (2.0 * settings.accel_gate_threshold_mps2));
}

/// Earlier fix to measure from: the latest that is old enough, otherwise the oldest.
const PastFix* reference_for(const VelocitySettings& settings, const PastFixes& fixes, int count,
                             const TimedFix& fix) {
  const PastFix* reference = nullptr;
  for (int i = 0; i < count; ++i) {
    const PastFix& past = fixes[static_cast<std::size_t>(i)];
    const double interval_s = seconds_between(past.measured_ns, fix.measured_ns);
    if (interval_s > settings.interval_max_s) break;
    if (interval_s < settings.interval_min_s) continue;
    reference = &past;
    if (interval_s >= settings.interval_wanted_s) break;
  }
  return reference;
}

/// Distance of a fix to the linear extrapolation of the two previous ones.
double bend_of(const VelocityState& state, const TimedFix& fix) {
  if (state.count < 2) return std::numeric_limits<double>::infinity();
  const PastFix& last = state.fixes[0];
  const PastFix& before = state.fixes[1];
  const double before_s = seconds_between(before.measured_ns, last.measured_ns);
  const double ahead_s = seconds_between(last.measured_ns, fix.measured_ns);
  if (before_s <= 0.0) return std::numeric_limits<double>::infinity();
  const Vector3d expected_world_m =
      last.position_world_m + (last.position_world_m - before.position_world_m) * (ahead_s / before_s);
  return (fix.measured_position_world_m - expected_world_m).norm();
}

std::optional<FixVelocity> measure_from(const PastFix* reference, const Kinematics& body,
                                        const TimedFix& fix) {
  if (reference == nullptr) return std::nullopt;
  const auto moved_world_m = body.displacement_between(reference->measured_ns, fix.measured_ns);
  if (!moved_world_m) return std::nullopt;
  const double interval_s = seconds_between(reference->measured_ns, fix.measured_ns);
  const Vector3d displacement_world_m = fix.measured_position_world_m - reference->position_world_m;
  FixVelocity measured;
  measured.ultrasonic_world_mps = displacement_world_m / interval_s;
  measured.inertial_world_mps = *moved_world_m / interval_s;
  measured.share = fix.share;
  measured.displacement_world_m = displacement_world_m;
  measured.interval_s = interval_s;
  return measured;
}

/// Number of fixes at the wanted interval that would have come since `last`, at least one.
double usual_fixes_since(const VelocitySettings& settings, const PastFix& last, const TimedFix& fix) {
  return std::max(1.0, seconds_between(last.measured_ns, fix.measured_ns) / settings.interval_wanted_s);
}

void remember(PastFixes& fixes, int& count, const TimedFix& fix) {
  std::copy_backward(fixes.begin(), fixes.end() - 1, fixes.end());
  fixes[0] = {fix.measured_ns, fix.measured_position_world_m};
  count = std::min(count + 1, VelocityState::capacity);
}

/// Weight of the two fixes' distance from the IMU's path.
double agreement_of(const FixVelocity& measured, double sigma_m) {
  const Vector3d excess_world_mps = measured.ultrasonic_world_mps - measured.inertial_world_mps;
  return trust::weight_of(excess_world_mps.norm() * measured.interval_s, sigma_m);
}

/// Weight of the difference between two excesses over the IMU's velocity: since the earlier fix and since the
/// last one. They are equal if the IMU is wrong, and differ if a fix between them was aside.
double agreement_of(const FixVelocity& measured, const std::optional<FixVelocity>& since_last,
                    double sigma_m) {
  if (!since_last) return 1.0;
  const Vector3d excess_world_mps = measured.ultrasonic_world_mps - measured.inertial_world_mps;
  const Vector3d latest_world_mps = since_last->ultrasonic_world_mps - since_last->inertial_world_mps;
  return trust::weight_of((excess_world_mps - latest_world_mps).norm() * measured.interval_s, sigma_m);
}

/// Velocity between outliers that agree with each other. From three on they agree on a velocity even if it is
/// far from the IMU's.
std::optional<FixVelocity> measure_rivals(const VelocitySettings& settings, VelocityState& state,
                                          const Kinematics& body, const TimedFix& fix,
                                          const FixAssessment& assessment) {
  if (assessment.rivals == 0) return std::nullopt;
  state.rival_count = std::min(state.rival_count, assessment.rivals - 1);
  auto measured = measure_from(reference_for(settings, state.rivals, state.rival_count, fix), body, fix);
  if (measured) measured->usual_fixes = usual_fixes_since(settings, state.rivals[0], fix);
  remember(state.rivals, state.rival_count, fix);
  if (!measured) return std::nullopt;
  measured->by_rivals = true;
  measured->bend_m = std::numeric_limits<double>::infinity();
  measured->agreement = assessment.rivals > 2
                            ? trust::weight_of(assessment.rival_residual_m, assessment.sigma_m)
                            : agreement_of(*measured, assessment.sigma_m);
  return measured;
}

/// Reliability of the velocity between the two fixes. A fix that was pushed aside by less than an outlier
/// agrees badly with the others. While trust is being rebuilt, fixes that agree with each other show the
/// velocity even if the position is in doubt.
double reliability_of(const FixVelocity& measured, const FixAssessment& assessment) {
  if (measured.by_rivals) return measured.agreement;
  if (assessment.trusted) return std::min(assessment.weight, measured.agreement);
  return std::max(assessment.weight, measured.agreement);
}

}  // namespace

double share_of_several(double share, double fixes) {
  return 1.0 - std::pow(1.0 - share, fixes);
}

void restart(VelocityState& state, const TimedFix& fix, bool velocity_known) {
  state.fixes[0] = {fix.measured_ns, fix.measured_position_world_m};
  state.count = 1;
  state.rival_count = 0;
  velocity_known ? state.settle() : state.unsettle();
}

std::optional<FixVelocity> measure(const VelocitySettings& settings, VelocityState& state,
                                   const Kinematics& body, const TimedFix& fix,
                                   const FixAssessment& assessment) {
  const auto by_rivals = measure_rivals(settings, state, body, fix, assessment);
  if (assessment.new_track) {
    constexpr int min_rivals = 3;
    if (state.rival_count >= min_rivals) {
      // The rivals have corrected the velocity since they began: it is known, and so are the fixes to
      // continue from.
      state.fixes = state.rivals;
      state.count = state.rival_count;
    } else {
      // If the track is accepted against the IMU, the velocity was most likely wrong.
      restart(state, fix, !assessment.track_accepted && state.settled());
    }
    state.rival_count = 0;
    return std::nullopt;
  }
  if (assessment.outlier && !assessment.forced) return by_rivals;
  auto measured = measure_from(reference_for(settings, state.fixes, state.count, fix), body, fix);
  if (measured) {
    measured->usual_fixes = usual_fixes_since(settings, state.fixes[0], fix);
    measured->bend_m = bend_of(state, fix);
    measured->agreement =
        std::max(agreement_of(*measured, assessment.sigma_m),
                 agreement_of(*measured, measure_from(state.fixes.data(), body, fix), assessment.sigma_m));
  }
  remember(state.fixes, state.count, fix);
  return measured;
}

VelocityChange correct(const VelocitySettings& settings, VelocityState& state, Kinematics& body,
                       const FixVelocity& measured, const FixAssessment& assessment) {
  VelocityChange done;
  done.flags = snap_for(settings, measured, assessment);
  if (done.flags != 0) {
    done.change_world_mps =
        measured.share.cwiseProduct(measured.ultrasonic_world_mps - body.velocity_world_mps);
  } else {
    // A forced convergence would not end without a correction of the velocity.
    const double reliability = std::max(reliability_of(measured, assessment), assessment.weight_floor);
    done.share = blend_of(settings, state, measured) * reliability *
                 accel_gate(settings, body.acceleration_world_mps2.norm());
    done.change_world_mps =
        done.share * measured.share.cwiseProduct(measured.ultrasonic_world_mps - measured.inertial_world_mps);
  }
  body.correct_velocity(done.change_world_mps);
  if (!state.settled()) state.velocities += static_cast<int>(std::lround(measured.usual_fixes));
  return done;
}

Vector3d initialise(VelocityState& state, Kinematics& body, const FixVelocity& measured) {
  state.velocities = 1;
  const Vector3d change_world_mps =
      measured.share.cwiseProduct(measured.ultrasonic_world_mps - body.velocity_world_mps);
  body.correct_velocity(change_world_mps);
  return change_world_mps;
}

}  // namespace sonopose::estimation::documented::velocity
