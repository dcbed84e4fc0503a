#pragma once
/// \file
/// Which field is the Earth's: a reference of its norm and dip is learned, and a field that differs from it
/// is not used for the heading.

#include <sonopose/attitude/filter.hpp>
#include <sonopose/attitude/settings.hpp>

namespace sonopose::attitude {

/// A field by its level and its vertical part, which a turn about the vertical leaves as they are.
template <class Scalar>
struct FieldShape {
  Scalar level_t = 0;
  Scalar up_t = 0;

  bool operator==(const FieldShape&) const = default;
};

template <class Scalar>
struct MagneticState {
  FieldShape<Scalar> mean;
  Scalar mean_age_s = 0;
  FieldShape<Scalar> reference;
  bool has_reference = false;
  FieldShape<Scalar> candidate;   ///< what may become the reference
  Scalar candidate_age_s = 0;     ///< how long it has stayed the same, up to reference_s
  Scalar candidate_turned_s = 0;  ///< of that, how long the body turned
  Scalar like_reference_s = 0;
  bool disturbed = true;
  Scalar rejected_s = 0;  ///< how long disturbed fields have not been used, less undisturbed time

  bool operator==(const MagneticState&) const = default;
};

namespace magnetic {

/// Adds one field in world axes; `rate_radps` is the angular rate of the body. Returns its weight for
/// the heading: 1 undisturbed, 0 disturbed, `late_share` if the disturbance lasts too long.
template <class Scalar>
Scalar weigh(const MagneticSettings& settings, MagneticState<Scalar>& state,
             const Vector3<Scalar>& field_world_t, Scalar rate_radps, Scalar dt_s);

}  // namespace magnetic
}  // namespace sonopose::attitude
