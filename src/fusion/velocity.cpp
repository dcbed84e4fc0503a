#include <sonopose/core/pose.hpp>
#include <sonopose/fusion/velocity.hpp>

#include <algorithm>

namespace sonopose::fusion::velocity {
namespace {

/// Items 7, 8 and 28.
std::uint32_t snap_for(const VelocitySettings& settings, const FixVelocity& measured) {
  const double ultrasonic_mps = measured.ultrasonic_world_mps.norm();
  const double inertial_mps = measured.inertial_world_mps.norm();
  if (ultrasonic_mps < settings.snap_min_speed_mps) return 0;
  const bool same_direction = measured.ultrasonic_world_mps.dot(measured.inertial_world_mps) > 0.0;
  if (settings.overshoot_fix && same_direction && inertial_mps > 2.0 * ultrasonic_mps) {
    return verdict_snapped_over;
  }
  if (settings.undershoot_fix && ultrasonic_mps > 2.0 * inertial_mps) return verdict_snapped_under;
  return 0;
}

/// Items 26 and 27: one at rest, one half at the threshold, zero from twice the threshold on.
double accel_gate(const VelocitySettings& settings, double acceleration_mps2) {
  if (!settings.accel_gate) return 1.0;
  return std::max(0.0, 1.0 - acceleration_mps2 / (2.0 * settings.accel_gate_threshold_mps2));
}

/// The earlier fix to measure from: the latest that lies far enough back, else the oldest.
const PastFix* reference_for(const VelocitySettings& settings, const VelocityState& state,
                             const TimedFix& fix) {
  const PastFix* reference = nullptr;
  for (int i = 0; i < state.count; ++i) {
    const PastFix& past = state.fixes[static_cast<std::size_t>(i)];
    const double interval_s = seconds_between(past.measured_ns, fix.measured_ns);
    if (interval_s > settings.interval_max_s) break;
    if (interval_s < settings.interval_min_s) continue;
    reference = &past;
    if (interval_s >= settings.interval_wanted_s) break;
  }
  return reference;
}

std::optional<FixVelocity> measure_from(const PastFix* reference, const Kinematics& body,
                                        const TimedFix& fix) {
  if (reference == nullptr) return std::nullopt;
  const auto moved_world_m = body.moved(reference->measured_ns, fix.measured_ns);
  if (!moved_world_m) return std::nullopt;
  const double interval_s = seconds_between(reference->measured_ns, fix.measured_ns);
  const Vector3d displacement_world_m = fix.measured_position_world_m - reference->position_world_m;
  return FixVelocity{displacement_world_m / interval_s, *moved_world_m / interval_s, displacement_world_m,
                     interval_s};
}

void remember(VelocityState& state, const TimedFix& fix) {
  std::copy_backward(state.fixes.begin(), state.fixes.end() - 1, state.fixes.end());
  state.fixes[0] = {fix.measured_ns, fix.measured_position_world_m};
  state.count = std::min(state.count + 1, VelocityState::capacity);
}

}  // namespace

void restart(VelocityState& state, const TimedFix& fix) {
  state.fixes[0] = {fix.measured_ns, fix.measured_position_world_m};
  state.count = 1;
}

std::optional<FixVelocity> measure(const VelocitySettings& settings, VelocityState& state,
                                   const Kinematics& body, const TimedFix& fix, bool good) {
  if (!good) return std::nullopt;
  const auto measured = measure_from(reference_for(settings, state, fix), body, fix);
  remember(state, fix);
  return measured;
}

VelocityChange correct(const VelocitySettings& settings, Kinematics& body, const FixVelocity& measured,
                       const Verdict& verdict) {
  VelocityChange done;
  done.verdict = snap_for(settings, measured);
  if (done.verdict != 0) {
    done.change_world_mps = measured.ultrasonic_world_mps - body.velocity_world_mps;
  } else {
    // A forced convergence would never end if the velocity that led astray were not corrected too.
    const double reliability = std::max(verdict.weight, verdict.weight_floor);
    done.share =
        settings.blend_weight * reliability * accel_gate(settings, body.acceleration_world_mps2.norm());
    done.change_world_mps = done.share * (measured.ultrasonic_world_mps - measured.inertial_world_mps);
  }
  body.correct_velocity(done.change_world_mps);
  return done;
}

Vector3d adopt(Kinematics& body, const FixVelocity& measured) {
  const Vector3d change_world_mps = measured.ultrasonic_world_mps - body.velocity_world_mps;
  body.correct_velocity(change_world_mps);
  return change_world_mps;
}

}  // namespace sonopose::fusion::velocity
