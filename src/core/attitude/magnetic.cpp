#include <sonopose/attitude/magnetic.hpp>
#include <sonopose/attitude/rejection.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::attitude::magnetic {
namespace {

template <class Scalar>
bool are_alike(const MagneticSettings& settings, const FieldComponents<Scalar>& a,
               const FieldComponents<Scalar>& b) {
  const Scalar norm_a_t = std::sqrt(a.level_t * a.level_t + a.up_t * a.up_t);
  const Scalar norm_b_t = std::sqrt(b.level_t * b.level_t + b.up_t * b.up_t);
  const Scalar across = a.level_t * b.up_t - a.up_t * b.level_t;
  const Scalar along = a.level_t * b.level_t + a.up_t * b.up_t;
  if (!(std::abs(norm_a_t - norm_b_t) < Scalar(settings.norm_tolerance) * norm_b_t)) return false;
  const Scalar scale = 1 / (norm_a_t * norm_b_t);
  const AngleError<Scalar> dip{scale * std::abs(across), scale * along};
  return dip.within(Scalar(settings.dip_tolerance_deg * geometry::radians_per_degree));
}

template <class Scalar>
void move_towards(FieldComponents<Scalar>& components, const FieldComponents<Scalar>& seen, Scalar share) {
  components.level_t += share * (seen.level_t - components.level_t);
  components.up_t += share * (seen.up_t - components.up_t);
}

/// Updates the candidate: a field that stays the same while the body turns belongs to the place, not to the
/// body.
template <class Scalar>
void update_candidate(const MagneticSettings& settings, MagneticState<Scalar>& state, Scalar rate_radps,
                      Scalar dt_s) {
  if (!are_alike(settings, state.mean, state.candidate)) {
    state.candidate = state.mean;
    state.candidate_age_s = 0;
    state.candidate_turned_s = 0;
    return;
  }
  // At first the mean of all, as the first of them lies between the old and the new field.
  const Scalar memory_s = state.candidate_age_s + dt_s;
  move_towards(state.candidate, state.mean, memory_s > 0 ? dt_s / memory_s : Scalar(1));
  state.candidate_age_s = std::min(memory_s, Scalar(settings.reference_s));
  const double needed_s = state.has_reference ? settings.new_field_s : settings.first_field_s;
  if (rate_radps >= Scalar(settings.new_field_rate_dps * geometry::radians_per_degree)) {
    state.candidate_turned_s = std::min(state.candidate_turned_s + dt_s, Scalar(needed_s));
  }
  if (state.disturbed && state.candidate_turned_s >= Scalar(needed_s)) {
    state.reference = state.candidate;
    state.has_reference = true;
    state.like_reference_s = Scalar(settings.undisturbed_s);
    state.disturbed = false;
  }
}

}  // namespace

template <class Scalar>
Scalar update(const MagneticSettings& settings, MagneticState<Scalar>& state,
              const Vector3<Scalar>& field_world_t, Scalar rate_radps, Scalar dt_s) {
  const FieldComponents<Scalar> seen{field_world_t.template head<2>().norm(), field_world_t.z()};
  const Scalar memory_s = state.mean_age_s + dt_s;
  move_towards(state.mean, seen, memory_s > 0 ? dt_s / memory_s : Scalar(1));
  state.mean_age_s = std::min(memory_s, Scalar(settings.smoothing_s));

  if (state.has_reference && are_alike(settings, state.mean, state.reference)) {
    const auto undisturbed_s = Scalar(settings.undisturbed_s);
    state.like_reference_s = std::min(state.like_reference_s + dt_s, undisturbed_s);
    state.disturbed = state.disturbed && state.like_reference_s < undisturbed_s;
    if (!state.disturbed) {
      move_towards(state.reference, state.mean, std::min(dt_s / Scalar(settings.reference_s), Scalar(1)));
    }
  } else {
    state.like_reference_s = 0;
    state.disturbed = true;
  }
  update_candidate(settings, state, rate_radps, dt_s);

  // Without a reference, the current field is the best that there is.
  if (!state.has_reference) return Scalar(settings.late_share);
  const auto max_rejection_s = Scalar(settings.longest_rejection_s);
  if (!state.disturbed) {
    state.rejected_s = std::max(state.rejected_s - 2 * dt_s, Scalar(0));
    return 1;
  }
  if (state.rejected_s >= max_rejection_s) return Scalar(settings.late_share);
  state.rejected_s += dt_s;
  return 0;
}

template float update(const MagneticSettings&, MagneticState<float>&, const Vector3<float>&, float, float);
template double update(const MagneticSettings&, MagneticState<double>&, const Vector3<double>&, double,
                       double);

}  // namespace sonopose::attitude::magnetic
